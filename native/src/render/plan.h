// The planner: what this scene and these settings need, and what they do not, each with its reason.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "film/film.h"
#include "gradus/gradus.h"
#include "lpe/components.h"
#include "scene/snapshot.h"

namespace gradus::render {

using Reasons = std::vector<std::pair<std::string, std::string>>;  // what, why

// What the setting `denoiser` comes to here.
struct HostDenoiser {
  std::string name;     // empty: none
  std::string why_not;  // that there is none
};

struct Plan {
  uint32_t integrator = GRADUS_INTEGRATOR_PATH;          // never AUTO
  uint32_t reconstruction = GRADUS_RECONSTRUCTION_NONE;  // never AUTO
  bool gradients = false;
  bool pilot = false;                // a few samples tell where gradients pay
  bool solves = false;               // Combined comes from a solver
  bool denoises = false;             // … and then from the host's denoiser
  bool denoises_if_it_pays = false;  // which is seen when sampling has ended: denoises_after()
  std::string denoiser;              // its name
  bool unbiased = true;              // what is sampled; see delivers_unbiased()
  bool adaptive = false;             // tiles take samples by their noise, and may stop early
  int channels = 3;
  lpe::ComponentSet components;        // that are sampled
  bool merges_components = false;      // those that a pilot finds small everywhere belong to Residual
  bool component_motion = false;       // of which passes tell where they were, and go
  bool non_specular_vertices = false;  // of which passes look at where paths become rough
  bool non_specular_details = false;   // and more closely
  uint64_t passes = 0;                 // that the frame keeps: those asked for, and what the reconstruction reads
  uint32_t first_check = 0;            // samples before a tile may stop
  Region delivered;
  Region sampled;  // with the guard ring
  Reasons chosen, skipped;
};

// Pixels around a region that are sampled, too, so that the reconstruction of the region does not feel its border: L2's
// response decays by 0.82 per pixel at alpha 0.2 (contract 2.1).
inline constexpr int kGuardRing = 35;

// Throws invalid_argument or unsupported for what cannot be obeyed: settings are obeyed or refused, never replaced
// (contract 5.1).
Plan make_plan(const GradusSettings& settings, const scene::Snapshot& snapshot,
               const HostDenoiser& denoiser = {"", "denoiser is none"});

// Of REGULARIZED, in pixels: all others are parts of it (reconstruct/feature_regression.cpp).
constexpr int kMaxRegressionBlock = 16;

// The reconstruction where no gradients are sampled, because the integrator has none or the pilot found that they pay
// nowhere.
uint32_t without_gradients(const Plan& plan);

// Whether the denoiser takes more off the error of so many samples per pixel than those that its time would buy.
bool denoiser_pays(double samples);

// Whether the denoiser runs after so many samples per pixel. Where the plan left that open it says what was decided,
// and why.
bool denoises_after(const Plan& plan, double samples, Reasons* chosen, Reasons* skipped);

// Contract 2.2. reconstruction, denoises: what is done in the end, which may be that without gradients.
bool delivers_unbiased(const Plan& plan, uint32_t reconstruction, bool denoises);

// What the reconstruction reads besides the image: features (schema/pass_table.h).
bool features_wanted(const Plan& plan);

}  // namespace gradus::render
