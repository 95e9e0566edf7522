#include "render/sequence/replay_plan.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "integrator/pixel_loop.h"
#include "temporal/pixel_links.h"

namespace gradus {

bool follows(const FrameBefore* before, const Snapshot& now, const GradusSettings& settings) {
  return before && before->settings.width == settings.width && before->settings.height == settings.height &&
         show_same_region(before->settings, settings) && !is_cut(before->snapshot->camera, now.camera);
}

SampleSources link_sources(const FrameBefore& before, const Snapshot& now, const GradusSettings& settings, const Region& region,
                           const CancelTest& cancel) {
  const auto view = [&](const Snapshot& snapshot) { return view_centres(snapshot, settings.width, settings.height, region, cancel); };
  const CentreView from = view(*before.snapshot), to = view(now);
  if (cancel()) return {};
  const Snapshot& scene = *before.snapshot;
  const bool shares = shares_jitter(Camera(scene.camera, settings.width, settings.height), scene);
  return {before.stream_frame, inverse_links(link_pixels(from, to)), scene.content_key, before.settings.seed, shares};
}

double mean_of(const std::vector<uint32_t>& counts) {
  return double(std::accumulate(counts.begin(), counts.end(), uint64_t{0})) / double(counts.size());
}

std::vector<uint32_t> replayed_counts(const SampleSources& sources, const FrameBefore* before, double mean) {
  std::vector<uint32_t> counts(sources.pixel.size(), uint32_t(std::max(1L, std::lround(mean))));
  if (!before || before->counts.empty()) return counts;
  for (size_t i = 0; i < counts.size(); ++i) {
    const int32_t source = sources.pixel[i];
    if (source != kNoLink) counts[i] = before->counts[size_t(source)];
  }
  return counts;
}

void limit_mean(double most, std::vector<uint32_t>* counts) {
  const double mean = mean_of(*counts);
  if (mean <= most) return;
  for (uint32_t& count : *counts) count = std::max(1u, uint32_t(std::lround(count * most / mean)));
}

}  // namespace gradus
