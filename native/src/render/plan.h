// The planner: chooses what a render of this scene with these settings does and what it skips, each with its reason.
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

using Reasons = std::vector<std::pair<std::string, std::string>>;  // pairs of a choice and its reason

// The denoiser that the setting `denoiser` selects on this machine.
struct HostDenoiser {
  std::string name;     // name and version; empty: there is none
  std::string why_not;  // the reason why there is none
};

struct Plan {
  uint32_t integrator = GRADUS_INTEGRATOR_PATH;          // never AUTO
  uint32_t reconstruction = GRADUS_RECONSTRUCTION_NONE;  // never AUTO
  bool gradients = false;
  bool pilot = false;                // whether a pilot finds where gradients are used
  bool solves = false;               // whether Combined is reconstructed
  bool denoises = false;             // whether Combined is denoised by the host's denoiser
  bool denoises_if_it_pays = false;  // whether that is decided after sampling, by denoises_after()
  std::string denoiser;              // name of the denoiser
  bool unbiased = true;              // whether the samples are unbiased; see delivers_unbiased()
  bool adaptive = false;             // whether blocks get samples by their noise and may stop early
  int channels = 3;
  lpe::ComponentSet components;  // the components that are sampled
  // whether components that a pilot finds small everywhere are merged into the remainder
  bool merges_components = false;
  bool component_motion = false;                  // whether motion passes of components are requested
  bool non_specular_vertices = false;             // whether passes of first non-specular vertices are requested
  bool non_specular_details = false;              // whether details of these vertices are requested
  std::vector<film::ChannelInfo> scene_channels;  // channels that the scene asks for beside passes
  uint64_t passes = 0;       // bits of the passes in the film: requested, or read by the reconstruction
  uint32_t first_check = 0;  // samples before a block may stop
  Region delivered;
  Region sampled;  // `delivered` with the guard ring
  Reasons chosen, skipped;
};

// Width in pixels of the ring around a region that is sampled, too, so that the border of the region hardly changes its
// reconstruction: the response of L2 decays by 0.82 per pixel at alpha 0.2.
inline constexpr int kGuardRing = 35;

// Returns the plan of a render. Throws `invalid_argument` or `unsupported` for settings that cannot be followed: a
// setting is never replaced silently. `joins_frames`: whether samples of other frames of an animation are joined, so
// that only denoises_after() knows how many the denoiser reads.
Plan make_plan(const GradusSettings& settings, const scene::Snapshot& snapshot,
               const HostDenoiser& denoiser = {"", "denoiser is none"}, bool joins_frames = false);

// Returns whether a setting of the option `integrator` can sample differences between pixels. AUTO chooses an
// integrator that does where they are needed.
bool can_sample_gradients(uint32_t integrator);

// Returns whether a render with these settings, which hold the samples of the whole frame, distributes its samples by
// noise.
bool is_adaptive(const GradusSettings& settings);

// Returns whether the samples of a render with these settings are unbiased: not clamped and not distributed by noise.
bool takes_unbiased_samples(const GradusSettings& settings);

// Returns the reconstruction if no gradients are sampled, because the integrator has none or the pilot found no
// benefit.
uint32_t without_gradients(const Plan& plan);

// Returns whether the denoiser runs after `samples` samples per pixel, those of joined frames included. Where the plan
// left that open, adds the decision and its reason to `chosen` or `skipped`.
bool denoises_after(const Plan& plan, double samples, Reasons* chosen, Reasons* skipped);

// Returns the setting `denoiser` of a film that is sampled after this plan: AUTO where it is decided later.
uint32_t stored_denoiser(const Plan& plan);

// Returns whether the delivered image is unbiased. `reconstruction` and `denoises` are what the render does in the end,
// which may be the reconstruction without gradients.
bool delivers_unbiased(const Plan& plan, uint32_t reconstruction, bool denoises);

// Returns whether the reconstruction or the denoiser reads denoising features (schema/pass_table.h).
bool features_wanted(const Plan& plan);

}  // namespace gradus::render
