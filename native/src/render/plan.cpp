#include "render/plan.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/error.h"
#include "base/text_list.h"
#include "bsdf/ggx.h"
#include "film/catcher_channels.h"
#include "film/scene_channels.h"
#include "output/options.h"
#include "reconstruct/regression/feature_regression.h"
#include "schema/automatic.h"
#include "schema/options.h"
#include "schema/pass_table.h"

namespace gradus::render {
namespace {

// Minimum samples of a pixel before its block may stop: with fewer, the variance estimated from two half-buffers is too
// uncertain.
constexpr uint32_t kFirstCheck = 16;

std::string choice_of(const char* option, uint32_t value) {
  return schema::choice_name(*schema::find_option(option), value);
}

bool needs_gradients(uint32_t reconstruction) {
  return reconstruction == GRADUS_RECONSTRUCTION_L2 || reconstruction == GRADUS_RECONSTRUCTION_L1;
}

// Blocks that stop by their noise have enough samples to denoise.
static_assert(schema::kDenoiserMinimumSamples <= kFirstCheck);

std::string too_few_to_denoise() {
  return "below " + std::to_string(schema::kDenoiserMinimumSamples) +
         " samples, more samples reduce the error more than the denoiser";
}

void choose_automatically(const GradusSettings& settings, Plan* plan) {
  const bool wants_differences = schema::has_bit(settings.passes, GRADUS_PASS_GRADIENT_X) ||
                                 schema::has_bit(settings.passes, GRADUS_PASS_GRADIENT_Y);
  // plain paths gave the smaller error at equal time on all of 13 scenes
  if (!needs_gradients(settings.reconstruction) && !wants_differences) {
    plan->integrator = GRADUS_INTEGRATOR_PATH;
    const bool none = settings.reconstruction == GRADUS_RECONSTRUCTION_NONE;
    plan->chosen.emplace_back("integrator path",
                              none ? "automatic: no reconstruction reads gradients"
                                   : "automatic: plain path tracing with feature-guided reconstruction "
                                     "has the smaller error at equal time");
    return;
  }
  plan->integrator = GRADUS_INTEGRATOR_GRADIENT;
  plan->pilot = !wants_differences;
  plan->chosen.emplace_back("integrator gradient", plan->pilot
                                                       ? "automatic: where gradients reduce the error at equal time"
                                                       : "automatic: passes of gradients are requested");
}

void choose_integrator(const GradusSettings& settings, Plan* plan) {
  switch (settings.integrator) {
    case GRADUS_INTEGRATOR_AUTO:
      choose_automatically(settings, plan);
      break;
    default:
      plan->integrator = settings.integrator;
      plan->chosen.emplace_back("integrator " + choice_of("integrator", plan->integrator), "set by the user");
      break;
  }
  plan->gradients = can_sample_gradients(plan->integrator);
  if (!plan->gradients)
    plan->skipped.emplace_back("gradients", "the integrator is " + choice_of("integrator", plan->integrator));
}

// Returns the options with which the film will be developed. A film of the integrators AUTO and GRADIENT is sampled
// with features if its reconstruction reads them; a user who chose plain samples expects the noisy image.
output::Options planned_options(const GradusSettings& settings, const HostDenoiser& denoiser, bool joins_frames) {
  output::FilmFacts facts;
  facts.has_features =
      settings.integrator == GRADUS_INTEGRATOR_AUTO || settings.integrator == GRADUS_INTEGRATOR_GRADIENT;
  facts.samples = joins_frames ? HUGE_VAL : settings.samples;
  facts.has_denoiser = !denoiser.name.empty();
  return output::resolve_auto(output::options_of(settings), facts);
}

void choose_reconstruction(const GradusSettings& settings, const output::Options& options, Plan* plan) {
  const uint32_t requested = settings.reconstruction;
  if (needs_gradients(requested) && !plan->gradients) {
    throw invalid_argument("reconstruction " + choice_of("reconstruction", requested) +
                           " needs gradients, but the integrator is " + choice_of("integrator", plan->integrator) +
                           ": use integrator gradient or reconstruction none");
  }
  plan->reconstruction = options.reconstruction;
  plan->solves = plan->reconstruction != GRADUS_RECONSTRUCTION_NONE;
  const char* why = requested != GRADUS_RECONSTRUCTION_AUTO
                        ? "set by the user"
                        : "automatic: reads the features of surfaces and all samples, weighted by their noise";
  if (plan->solves) {
    plan->chosen.emplace_back("reconstruction " + choice_of("reconstruction", plan->reconstruction), why);
  } else {
    const std::string reason = requested == GRADUS_RECONSTRUCTION_AUTO
                                   ? "the integrator is " + choice_of("integrator", plan->integrator)
                                   : "reconstruction is none";
    plan->skipped.emplace_back("reconstruction", reason + ": the noisy image is delivered");
  }
}

void choose_denoiser(const GradusSettings& settings, const output::Options& options, const HostDenoiser& denoiser,
                     bool joins_frames, Plan* plan) {
  const bool automatic = settings.denoiser == GRADUS_DENOISER_AUTO;
  if (denoiser.name.empty()) {
    plan->skipped.emplace_back("denoiser", denoiser.why_not);
  } else if (automatic && options.denoiser == GRADUS_DENOISER_NONE) {
    plan->skipped.emplace_back(
        "denoiser",
        "automatic: " + (output::is_denoised_by_default(options.reconstruction)
                             ? too_few_to_denoise()
                             : "the reconstruction is " + choice_of("reconstruction", options.reconstruction)));
  } else {
    plan->denoises = true;
    plan->denoiser = denoiser.name;
    plan->denoises_if_it_pays = automatic && (settings.time_limit > 0.0f || joins_frames);
    if (plan->denoises_if_it_pays) return;
    plan->chosen.emplace_back("denoiser " + denoiser.name,
                              automatic ? "automatic: a denoiser is available" : "set by the user");
  }
}

void choose_region(const GradusSettings& settings, Plan* plan) {
  const Region full{0, 0, int32_t(settings.width), int32_t(settings.height)};
  const uint32_t* r = settings.region;
  const bool whole = r[0] == 0 && r[1] == 0 && r[2] == 0 && r[3] == 0;
  if (!whole && (r[0] >= r[2] || r[1] >= r[3] || r[2] > settings.width || r[3] > settings.height)) {
    throw invalid_argument("the region is empty or reaches beyond the frame");
  }
  plan->delivered = whole ? full : Region{int32_t(r[0]), int32_t(r[1]), int32_t(r[2]), int32_t(r[3])};
  plan->sampled = plan->delivered;
  if (plan->solves || plan->denoises) {
    plan->sampled.x0 = std::max(full.x0, plan->delivered.x0 - kGuardRing);
    plan->sampled.y0 = std::max(full.y0, plan->delivered.y0 - kGuardRing);
    // The windows and blocks of REGULARIZED begin at the same pixels as those of the full frame.
    if (plan->reconstruction == GRADUS_RECONSTRUCTION_REGULARIZED) {
      plan->sampled.x0 -= plan->sampled.x0 % reconstruct::kRegressionGrid;
      plan->sampled.y0 -= plan->sampled.y0 % reconstruct::kRegressionGrid;
    }
    plan->sampled.x1 = std::min(full.x1, plan->delivered.x1 + kGuardRing);
    plan->sampled.y1 = std::min(full.y1, plan->delivered.y1 + kGuardRing);
  }
  if (plan->sampled.area() > plan->delivered.area()) {
    std::string ring = "guard ring of ";
    ring.append(std::to_string(kGuardRing)).append(" pixels");
    plan->chosen.emplace_back(ring,
                              "the region is smaller than the frame, and its border should hardly change the image");
  }
}

void list_scene(const GradusSettings& settings, const scene::Snapshot& snapshot, Plan* plan) {
  if (!(snapshot.camera.aperture_radius > 0.0f)) plan->skipped.emplace_back("lens samples", "the camera is a pinhole");
  if (!snapshot.features.has_transparent_shadows)
    plan->skipped.emplace_back("transparent shadows", "no material is transparent");
  if (snapshot.features.min_alpha >= std::max(settings.roughness_threshold, bsdf::kSmallestAlpha))
    plan->skipped.emplace_back("half-vector shifts", "no material is sharper than the roughness threshold");
  if (!snapshot.features.has_lights) plan->skipped.emplace_back("light sampling", "the scene has no emitters");
  if (snapshot.features.only_lights_emit)
    plan->skipped.emplace_back("emission of surfaces", "no material emits light or is transparent");
  if (plan->channels == 3)
    plan->skipped.emplace_back("alpha channel", "the film is opaque, and no surface is held out");
}

// Returns the bits of the scatter classes that some surface of the scene has.
uint32_t events_of(const GradusSettings& settings, const scene::SceneFeatures& features) {
  const float sharp = std::max(settings.roughness_threshold, bsdf::kSmallestAlpha);
  const auto bit = [](bsdf::ScatterClass c) { return 1u << uint32_t(c); };
  return bit(bsdf::ScatterClass::Diffuse) | (features.min_alpha < sharp ? bit(bsdf::ScatterClass::Reflection) : 0) |
         (features.min_refracting_alpha < sharp ? bit(bsdf::ScatterClass::Transmission) : 0);
}

// Returns whether the camera may see light directly.
bool shows_light(const scene::SceneFeatures& features) {
  return features.world_emits || features.has_lights_with_extent || !features.only_lights_emit;
}

void choose_components(const GradusSettings& settings, const scene::SceneFeatures& features, Plan* plan) {
  if (settings.use_decomposition == 0) return;
  const std::string text = schema::get_text(settings, *schema::find_option("components"));
  const lpe::ComponentSet all = lpe::ComponentSet::parse(text);
  const uint32_t seen = shows_light(features) ? 1u << all.component(lpe::LpeState{0}) : 0;
  plan->non_specular_vertices = schema::any_wanted(settings.component_passes, schema::is_of_non_specular_vertices);
  plan->non_specular_details = schema::any_wanted(settings.component_passes, schema::is_of_non_specular_details);
  plan->component_motion = schema::any_wanted(settings.component_passes, schema::is_motion);
  const uint32_t kept = all.reached(events_of(settings, features)) | seen;
  plan->components = all.without_empty(kept);
  // Components are not merged if passes of surface data are requested, which may be wanted for a component without
  // light.
  plan->merges_components =
      text.empty() && !plan->non_specular_vertices && !plan->non_specular_details && !plan->component_motion;
  std::string names, absent;
  for (int i = 0; i < all.count(); ++i)
    add_item(plan->components.find(all[i].name) >= 0 ? &names : &absent, all[i].name);
  plan->chosen.emplace_back("components " + names, text.empty() ? "automatic: the default set" : "set by the user");
  if (!absent.empty())
    plan->skipped.emplace_back("components " + absent, "no path of this scene can match their expressions");
}

void choose_passes(const GradusSettings& settings, Plan* plan) {
  plan->passes = settings.passes;
  if (!features_wanted(*plan)) return;
  plan->passes |= schema::feature_passes();
  plan->chosen.emplace_back("denoising features",
                            plan->denoises ? "the denoiser is guided by them" : "the reconstruction is guided by them");
}

void list_passes(Plan* plan) {
  std::string names;
  for (uint32_t pass = GRADUS_PASS_NOISY_IMAGE; pass < GRADUS_PASS_COUNT; ++pass) {
    if (!schema::has_bit(plan->passes, pass)) add_item(&names, schema::pass_info(pass).name);
  }
  if (!names.empty()) plan->skipped.emplace_back("passes " + names, "not requested");
}

// Returns the number of samples before a block may stop. If `min_samples` is 0, it follows from the threshold. Along a
// straight edge all pixels of a block, which share their jitter, have the same error of coverage, and both half-buffers
// agree on it in two of three cases. n samples leave an error of about 0.2/n of the block, so the minimum number of
// samples is one that leaves about the threshold.
uint32_t first_check(const GradusSettings& settings) {
  const double minimum = 0.16 / std::max(1e-6, double(settings.noise_threshold));
  return std::max(kFirstCheck, settings.min_samples > 0 ? settings.min_samples : uint32_t(std::lround(minimum)));
}

}  // namespace

Plan make_plan(const GradusSettings& settings, const scene::Snapshot& snapshot, const HostDenoiser& denoiser,
               bool joins_frames) {
  schema::check_settings(settings);
  Plan plan;
  const output::Options options = planned_options(settings, denoiser, joins_frames);
  choose_denoiser(settings, options, denoiser, joins_frames, &plan);
  choose_integrator(settings, &plan);
  choose_reconstruction(settings, options, &plan);
  choose_region(settings, &plan);
  plan.channels = settings.film_transparent || snapshot.features.has_holdouts ? 4 : 3;
  plan.first_check = first_check(settings);
  plan.adaptive = is_adaptive(settings) && snapshot.catchers == nullptr;
  if (plan.adaptive) {
    plan.chosen.emplace_back(
        "adaptive sampling",
        "Noise Threshold is set: pixel blocks below it stop, the others share samples by their noise");
  } else {
    plan.skipped.emplace_back("adaptive sampling",
                              !is_adaptive(settings) && settings.noise_threshold > 0.0f ? "16 samples or fewer"
                              : settings.noise_threshold > 0.0f ? "the noise of shadows on shadow catchers is unknown"
                                                                : "Noise Threshold is 0");
  }
  plan.unbiased = takes_unbiased_samples(settings);
  list_scene(settings, snapshot, &plan);
  choose_components(settings, snapshot.features, &plan);
  choose_passes(settings, &plan);
  plan.scene_channels = film::describe(snapshot.channels);
  if (snapshot.catchers != nullptr) film::add_catcher_channels(&plan.scene_channels);
  list_passes(&plan);
  return plan;
}

bool is_adaptive(const GradusSettings& settings) {
  return settings.noise_threshold > 0.0f && settings.samples > kFirstCheck;
}

bool takes_unbiased_samples(const GradusSettings& settings) {
  const bool clamps = settings.clamp_direct > 0.0f || settings.clamp_indirect > 0.0f;
  return !is_adaptive(settings) && !clamps;
}

bool features_wanted(const Plan& plan) {
  return plan.reconstruction == GRADUS_RECONSTRUCTION_REGULARIZED || plan.denoises;
}

bool can_sample_gradients(uint32_t integrator) {
  return integrator == GRADUS_INTEGRATOR_AUTO || integrator == GRADUS_INTEGRATOR_GRADIENT;
}

uint32_t without_gradients(const Plan& plan) {
  return needs_gradients(plan.reconstruction) ? uint32_t{GRADUS_RECONSTRUCTION_NONE} : plan.reconstruction;
}

bool denoises_after(const Plan& plan, double samples, Reasons* chosen, Reasons* skipped) {
  if (!plan.denoises_if_it_pays) return plan.denoises;
  char taken[80];
  std::snprintf(taken, sizeof(taken), "automatic: a pixel has %.1f samples", samples);
  if (!output::denoiser_pays(samples)) {
    skipped->emplace_back("denoiser", taken + std::string(": ") + too_few_to_denoise());
    return false;
  }
  chosen->emplace_back("denoiser " + plan.denoiser, taken);
  return true;
}

uint32_t stored_denoiser(const Plan& plan) {
  if (plan.denoises_if_it_pays) return GRADUS_DENOISER_AUTO;
  return plan.denoises ? GRADUS_DENOISER_OIDN : GRADUS_DENOISER_NONE;
}

bool delivers_unbiased(const Plan& plan, uint32_t reconstruction, bool denoises) {
  return plan.unbiased && !denoises &&
         (reconstruction == GRADUS_RECONSTRUCTION_L2 || reconstruction == GRADUS_RECONSTRUCTION_NONE);
}

}  // namespace gradus::render
