#include "path/emission_edges.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include <tbb/parallel_for.h>

#include "base/fpu.h"
#include "shading/material.h"

namespace gradus::path {

namespace {

// Contrast of an edge: part of the brighter side's emission by which the other side is darker.
constexpr float kContrast = 0.2f;
// Least slope of all light over emission at an edge, 1 − L/E. There the variance is 0.48 of that without further rays.
constexpr double kSlope = 0.6;

// A camera ray as far as edges need it.
struct Probe {
  uint32_t end = 0;  // equal for two rays if they end on the same surface, or both leave the scene, behind equal lights
  float emission = 0.0f;  // sum of the channels that the camera sees; set beside probes with another end
  float light = -1.0f;    // that of all light of a path; set beside probes with other emission
};

// Probes of a region and of a ring of two pixels around it.
struct Probes {
  explicit Probes(const Region& r)
      : region{r.x0 - 2, r.y0 - 2, r.x1 + 2, r.y1 + 2}, values(static_cast<size_t>(region.area())) {}
  Probe& at(int32_t x, int32_t y) { return values[region.index(x, y)]; }

  Region region;
  std::vector<Probe> values;
};

bool may_see_emitters(const PathContext& context) {
  const scene::SceneFeatures& features = context.scene.features;
  return features.has_lights_with_extent || !features.only_lights_emit ||
         (features.world_emits && context.settings.film_transparent == 0);
}

// Returns the sampler of a camera ray.
Sampler ray_sampler(const PathContext& context, StreamKind kind, int32_t x, int32_t y, uint32_t number) {
  const GradusSettings& settings = context.settings;
  const uint32_t stream = static_cast<uint32_t>(y) * settings.width + static_cast<uint32_t>(x);
  return Sampler({settings.seed, kind, stream, settings.frame, number}, settings.independent_sampler != 0);
}

// Finds the values of probes with the memory of one thread.
class Prober {
 public:
  explicit Prober(const PathContext& context)
      : context_(context),
        scratch_(std::make_unique<PathScratch>()),
        tracer_(context, scratch_.get(), nullptr, &counters_, &observer_) {}

  uint32_t end(int32_t x, int32_t y) {
    Ray ray = context_.camera.ray(camera_sample(context_, sampler(x, y), pixel_centre(x, y)));
    geometry::Hit hit;
    const bool meets = context_.scene.intersect(ray, GRADUS_VISIBLE_CAMERA, &hit);
    if (meets && context_.scene.materials[context_.scene.material_of(hit)]->may_be_transparent) return kUnknown;
    uint32_t end = meets ? hit.instance : kEscapes;
    if (context_.scene.features.has_lights_with_extent) {
      if (meets) ray.t_max = hit.t;
      light::intersect_lights(context_.scene, ray, &lights_);
      for (const light::LightHit& light : lights_) end = combine(end, light.point.index);
    }
    return end;
  }
  float emission(int32_t x, int32_t y) { return sum(tracer_.see({sampler(x, y), pixel_centre(x, y)})); }
  float light(int32_t x, int32_t y) { return sum(tracer_.li(sampler(x, y), pixel_centre(x, y))); }

  // End of a ray that may pass what it meets: it may differ from any other.
  static constexpr uint32_t kUnknown = UINT32_MAX, kEscapes = UINT32_MAX - 1;

 private:
  Sampler sampler(int32_t x, int32_t y) const { return ray_sampler(context_, StreamKind::EdgeProbe, x, y, 0); }
  float sum(const PathResult& result) const {
    float sum = 0.0f;
    for (int c = 0; c < context_.components.count(); ++c) sum += 3.0f * mean_component(Rgb(result.radiance[size_t(c)]));
    return sum;
  }

  const PathContext& context_;
  const std::unique_ptr<PathScratch> scratch_;
  film::Counters counters_;
  NoObserver observer_;
  PathTracer<NoObserver> tracer_;
  std::vector<light::LightHit> lights_;
};

// Calls function(probe) for those of 3×3 pixels.
template <class Function>
void for_around(Probes* probes, int32_t x, int32_t y, const Function& function) {
  const Region& r = probes->region;
  for (int32_t v = std::max(y - 1, r.y0); v < std::min(y + 2, r.y1); ++v) {
    for (int32_t u = std::max(x - 1, r.x0); u < std::min(x + 2, r.x1); ++u) function(probes->at(u, v));
  }
}

bool may_end_elsewhere(const Probe& a, const Probe& b) { return a.end != b.end || a.end == Prober::kUnknown; }

// Returns whether a ray beside a probe may end elsewhere.
bool is_beside_other_end(Probes* probes, int32_t x, int32_t y) {
  const Probe& own = probes->at(x, y);
  bool is_beside = false;
  for_around(probes, x, y, [&](const Probe& other) { is_beside |= may_end_elsewhere(own, other); });
  return is_beside;
}

// Returns whether a ray beside a probe ends elsewhere and sees other emission.
bool is_beside_other_emission(Probes* probes, int32_t x, int32_t y) {
  const Probe& own = probes->at(x, y);
  bool is_beside = false;
  for_around(probes, x, y, [&](const Probe& other) {
    const float difference = std::fabs(own.emission - other.emission);
    is_beside |= may_end_elsewhere(own, other) && difference > kContrast * std::max(own.emission, other.emission);
  });
  return is_beside;
}

// Returns whether light differs by nearly as much as emission does, by the slope of a regression over 3×3 pixels.
bool is_dim_beside_emission(Probes* probes, int32_t x, int32_t y) {
  double n = 0.0, e = 0.0, l = 0.0, ee = 0.0, el = 0.0;
  for_around(probes, x, y, [&](const Probe& probe) {
    if (probe.light < 0.0f) return;
    n += 1.0;
    e += probe.emission;
    l += probe.light;
    ee += double(probe.emission) * probe.emission;
    el += double(probe.emission) * probe.light;
  });
  return el - e * l / n > kSlope * (ee - e * e / n);
}

// Calls body(prober, x, y) for all pixels of the probes, with a prober for each task.
template <class Body>
void for_probes(const PathContext& context, const Region& all, const std::atomic<bool>& stop, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<int32_t>(all.y0, all.y1, 8), [&](const tbb::blocked_range<int32_t>& rows) {
    const FlushDenormals flush;
    Prober prober(context);
    for (int32_t y = rows.begin(); y < rows.end() && !stop.load(std::memory_order_relaxed); ++y) {
      for (int32_t x = all.x0; x < all.x1; ++x) body(&prober, x, y);
    }
  });
}

}  // namespace

std::vector<uint8_t> find_emission_edges(const PathContext& context, const Region& region,
                                         const std::atomic<bool>& stop) {
  // Shadow catchers, and glass that shows the film's background, take light and alpha from the path's own ray.
  if (!may_see_emitters(context) || context.scene.catchers || context.glass_limit >= 0.0f) return {};
  Probes probes(region);
  const Region& all = probes.region;
  for_probes(context, all, stop,
             [&](Prober* prober, int32_t x, int32_t y) { probes.at(x, y).end = prober->end(x, y); });
  for_probes(context, all, stop, [&](Prober* prober, int32_t x, int32_t y) {
    if (is_beside_other_end(&probes, x, y)) probes.at(x, y).emission = prober->emission(x, y);
  });
  for_probes(context, all, stop, [&](Prober* prober, int32_t x, int32_t y) {
    if (is_beside_other_emission(&probes, x, y)) probes.at(x, y).light = std::max(prober->light(x, y), 0.0f);
  });
  std::vector<uint8_t> edges(static_cast<size_t>(region.area()));
  for (int32_t y = region.y0; y < region.y1; ++y) {
    for (int32_t x = region.x0; x < region.x1; ++x) {
      const bool is_beside = probes.at(x, y).light >= 0.0f;  // other emission
      edges[region.index(x, y)] = is_beside && is_dim_beside_emission(&probes, x, y);
    }
  }
  return edges;
}

void make_edge_rays(const PathContext& context, int32_t x, int32_t y, uint32_t number,
                    std::span<CameraRay, kEdgeRays> rays) {
  for (uint32_t i = 0; i < kEdgeRays; ++i) {
    const uint32_t of_half = number / 2 * kEdgeRays + i;
    rays[i].sampler = ray_sampler(context, StreamKind::EdgeRay, x, y, 2 * of_half + number % 2);
    rays[i].film = pixel_centre(x, y) + context.filter.sample(rays[i].sampler.get2(dimension::kFilm));
  }
}

}  // namespace gradus::path
