#include "render/sequence/replay_plan.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "integrator/pixel_loop.h"
#include "render/component_replay.h"
#include "temporal/component_links.h"
#include "temporal/component_ways.h"
#include "temporal/pixel_links.h"

namespace gradus {

bool follows(const FrameBefore* before, const Snapshot& now, const GradusSettings& settings) {
  return before && before->settings.width == settings.width && before->settings.height == settings.height &&
         show_same_region(before->settings, settings) && !is_cut(before->snapshot->camera, now.camera);
}

namespace {

using Sources = std::vector<PixelLinks>;

// What is left for Residual is mostly seen in mirrors of mirrors: it goes with what goes its own way there.
PixelLinks sources_of_residual(const PixelLinks& surface, const Sources& others) {
  PixelLinks sources = surface;
  for (const PixelLinks& own : others) {
    for (size_t i = 0; i < own.pixel.size(); ++i) {
      if (own.pixel[i] == kNoLink || own.pixel[i] == surface.pixel[i] || sources.pixel[i] != surface.pixel[i]) continue;
      sources.pixel[i] = own.pixel[i];
      sources.off_centre[i] = own.off_centre[i];
    }
  }
  return sources;
}

Sources sources_of_components(const CentreView& from, const CentreView& to, const GradusSettings& settings, const ComponentSet& components,
                              const PixelLinks& links, const PixelLinks& surface, const CancelTest& cancel) {
  if (components.count() == 1 || settings.component_replays == 0) return {};
  Sources sources(static_cast<size_t>(components.count()));
  const ChainTracer tracer{*to.snapshot, to.camera, settings};
  const std::vector<ChainMotion> ways = follow_components(from, tracer, components, components.all() & ~components.residual(), cancel);
  bool any = false;
  for (size_t c = 0; c < ways.size(); ++c) {
    if (!shows_through(ways[c])) continue;
    sources[c] = inverse_links(link_component(links, from.region, ways[c]));
    any = true;
  }
  if (!any) return {};
  if (components.residual() != 0) sources.back() = sources_of_residual(surface, sources);
  return sources;
}

}  // namespace

SampleSources link_sources(const FrameBefore& before, const Snapshot& now, const GradusSettings& settings, const ComponentSet& components,
                           const Region& region, const CancelTest& cancel) {
  const auto view = [&](const Snapshot& snapshot) { return view_centres(snapshot, settings.width, settings.height, region, cancel); };
  const CentreView from = view(*before.snapshot), to = view(now);
  if (cancel()) return {};
  const Snapshot& scene = *before.snapshot;
  const bool shares = shares_jitter(Camera(scene.camera, settings.width, settings.height), scene);
  const PixelLinks links = link_pixels(from, to);
  SampleSources sources{before.stream_frame, inverse_links(links), scene.content_key, before.settings.seed, shares};
  sources.of_component = sources_of_components(from, to, settings, components, links, sources.links, cancel);
  limit_own_ways(&sources);
  return sources;
}

double mean_of(const std::vector<uint32_t>& counts) {
  return double(std::accumulate(counts.begin(), counts.end(), uint64_t{0})) / double(counts.size());
}

std::vector<uint32_t> replayed_counts(const SampleSources& sources, const FrameBefore* before, double mean) {
  std::vector<uint32_t> counts(sources.links.pixel.size(), uint32_t(std::max(1L, std::lround(mean))));
  if (!before || before->counts.empty()) return counts;
  for (size_t i = 0; i < counts.size(); ++i) {
    const int32_t source = sources.links.pixel[i];
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
