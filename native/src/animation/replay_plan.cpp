#include "animation/replay_plan.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "animation/fresh_replayed_shares.h"
#include "base/fault.h"
#include "bsdf/ggx.h"
#include "integrator/pixel_loop.h"
#include "motion/component_tracking.h"
#include "motion/parting_edges.h"
#include "motion/pixel_matching.h"
#include "render/component_replay.h"

namespace gradus::animation {

bool follows(const PreviousFrame* before, const scene::Snapshot& now, const GradusSettings& settings) {
  return before && before->settings.width == settings.width && before->settings.height == settings.height &&
         show_same_region(before->settings, settings) &&
         (GRADUS_FAULT(shot_change_not_detected) || !motion::is_shot_change(before->snapshot->camera, now.camera));
}

namespace {

// Smallest roughness α at which samples follow a surface itself and not what it reflects.
constexpr float kSharpAlpha = 0.02f;

using Correspondences = std::vector<film::PixelCorrespondence>;

// Returns the pixel correspondence of Residual. Its light is mostly seen in mirrors of mirrors, so it follows a
// component whose motion differs from that of the surface, where there is one.
film::PixelCorrespondence correspondence_of_residual(const film::PixelCorrespondence& surface,
                                                     const Correspondences& others) {
  film::PixelCorrespondence residual = surface;
  for (const film::PixelCorrespondence& own : others) {
    for (size_t i = 0; i < own.pixel.size(); ++i) {
      if (own.pixel[i] == film::kNoCorrespondence || own.pixel[i] == surface.pixel[i] ||
          residual.pixel[i] != surface.pixel[i])
        continue;
      residual.pixel[i] = own.pixel[i];
      residual.off_centre[i] = own.off_centre[i];
    }
  }
  return residual;
}

// Returns the pixel correspondence of each component that is seen through smooth surfaces; empty if there is none.
Correspondences correspondences_of_components(const motion::CentreView& from, const motion::CentreView& to,
                                              const GradusSettings& settings, const lpe::ComponentSet& components,
                                              const film::PixelCorrespondence& correspondence,
                                              const film::PixelCorrespondence& surface, const CancelCheck& cancel) {
  if (components.count() == 1 || settings.component_replays == 0 || !takes_replays(settings)) return {};
  Correspondences of_component(static_cast<size_t>(components.count()));
  const motion::ChainTracer tracer{*to.snapshot, to.camera, settings};
  const std::vector<motion::ChainMotion> motion =
      motion::track_components(from, tracer, components, components.all() & ~components.residual(), cancel);
  bool any = false;
  for (size_t c = 0; c < motion.size(); ++c) {
    if (!motion::is_seen_through_smooth(motion[c])) continue;
    of_component[c] = motion::inverse_correspondence(motion::match_component(correspondence, from.region, motion[c]));
    any = true;
  }
  if (!any) return {};
  if (components.residual() != 0) of_component.back() = correspondence_of_residual(surface, of_component);
  return of_component;
}

// Returns the pixel correspondence of what each pixel mainly shows. `surface`: that of the surfaces, which is followed
// unless they are mirrors or clear glass.
film::PixelCorrespondence correspondence_of_dominant(const motion::CentreView& from, const motion::CentreView& to,
                                                     const GradusSettings& settings, film::PixelCorrespondence surface,
                                                     const CancelCheck& cancel) {
  GradusSettings settings_of_mirrors = settings;
  const float sharp = std::max(settings.roughness_threshold, bsdf::kSmallestAlpha);
  settings_of_mirrors.roughness_threshold = std::min(sharp, kSharpAlpha);
  const bool all_are_blurred = from.snapshot->features.min_alpha >= settings_of_mirrors.roughness_threshold;
  if (all_are_blurred || GRADUS_FAULT(joined_light_follows_surfaces)) return surface;
  const motion::ChainTracer tracer{*to.snapshot, to.camera, settings_of_mirrors};
  motion::ChainMotion motion = motion::track_dominant(from, tracer, cancel);
  if (cancel()) return {};
  motion::lose_strayed_chains(from, to, &motion);
  return motion::is_seen_through_smooth(motion) ? motion::match_dominant(std::move(surface), from.region, motion)
                                                : surface;
}

}  // namespace

film::ReplayMap make_replay_map(const PreviousFrame& before, const motion::CentreView& now,
                                const GradusSettings& settings, const lpe::ComponentSet& components,
                                const film::FilmHeader& fresh, const CancelCheck& cancel) {
  motion::CentreView traced;
  const bool is_known = before.centres && before.centres->region == now.region;
  if (!is_known) traced = motion::view_centres(*before.snapshot, settings.width, settings.height, now.region, cancel);
  if (cancel()) return {};
  const motion::CentreView& from = is_known ? *before.centres : traced;
  const scene::Snapshot& scene = *before.snapshot;
  const bool shares =
      integrator::shares_jitter(camera::Camera(scene.camera, settings.width, settings.height), scene, fresh.gradients);
  film::PixelCorrespondence correspondence = motion::match_pixels(from, now);
  if (!takes_replays(settings)) {
    correspondence = correspondence_of_dominant(from, now, settings, std::move(correspondence), cancel);
    if (!cancel()) motion::leave_out_parting_edges(from, now, &correspondence);
  }
  film::ReplayMap replay_map{before.stream_frame,
                             motion::inverse_correspondence(correspondence),
                             scene.content_key,
                             before.settings.seed,
                             shares,
                             before.net_samples};
  replay_map.of_component =
      correspondences_of_components(from, now, settings, components, correspondence, replay_map.correspondence, cancel);
  render::limit_component_replays(&replay_map);
  return replay_map;
}

double mean_of(const std::vector<uint32_t>& counts) {
  return double(std::accumulate(counts.begin(), counts.end(), uint64_t{0})) / double(counts.size());
}

std::vector<uint32_t> replayed_counts(const film::ReplayMap& replay_map, const PreviousFrame* before, double mean) {
  std::vector<uint32_t> counts(replay_map.correspondence.pixel.size(), uint32_t(std::max(1L, std::lround(mean))));
  if (!before || before->counts.empty()) return counts;
  for (size_t i = 0; i < counts.size(); ++i) {
    const int32_t replayed = replay_map.correspondence.pixel[i];
    if (replayed != film::kNoCorrespondence && !GRADUS_FAULT(replay_takes_mean_count))
      counts[i] = before->counts[size_t(replayed)];
  }
  return counts;
}

void limit_mean(double maximum, std::vector<uint32_t>* counts) {
  const double mean = mean_of(*counts);
  if (mean <= maximum) return;
  for (uint32_t& count : *counts) count = std::max(1u, uint32_t(std::lround(count * maximum / mean)));
}

}  // namespace gradus::animation
