// Representative paths (Zimmer et al. 2015, section 4.1): from the camera through smooth surfaces to the first thing
// that they show.
//
// A sharp lobe counts as perfectly smooth about its shading normal. Surfaces of which more goes straight through than
// stays are passed.
#pragma once

#include "camera/camera.h"
#include "lpe/components.h"
#include "motion/change.h"
#include "path/segment.h"
#include "scene/snapshot.h"

namespace gradus::motion {

// Smooth vertices of a chain.
inline constexpr int kMaxChainLength = 8;

enum class ChainEnd : uint8_t { None, Surface, Sky };

// The way through the smooth surfaces: how it scatters, and on which objects.
struct SpecularSignature {
  uint8_t length = 0;
  uint16_t events = 0;    // ScatterClass of each vertex, two bits each
  uint64_t surfaces = 0;  // hash of the instances' ids: the same in every frame

  bsdf::ScatterClass event(int vertex) const { return bsdf::ScatterClass(events >> (2 * vertex) & 3); }
  void add(bsdf::ScatterClass event, uint64_t instance_id);
  bool operator==(const SpecularSignature&) const = default;
};

struct SpecularChain {
  SpecularSignature signature;
  bool is_static = false;  // nothing of it changes, and nothing that moves may come between
  ChainEnd end = ChainEnd::None;
  geometry::Hit first;      // its first smooth vertex; not valid where there is none
  geometry::Hit last;       // what it shows, if that is a surface
  Vec3 shown = Vec3(0.0f);  // and where that is
  float length = 0.0f;      // of the way to it
  path::PathRay ray;        // the last
};

class ChainTracer {
 public:
  // camera: at rest, without a lens (CentreView's). What is referred to lives as long as the tracer.
  ChainTracer(const scene::Snapshot& snapshot, const camera::Camera& camera, const GradusSettings& settings);

  // Chains at a place of the film: bits of the components of `wanted` that have one, which is put at their place in
  // `chains`. Where surfaces both reflect and transmit, the stronger way that leads to the component; it ends on the
  // first surface that is rough or shines as the component asks, or in the sky. known: what the camera ray meets.
  // change: nullptr where it is not known; then no chain rests.
  uint32_t find(const Vec2& film, const geometry::Hit& known, const lpe::ComponentSet& components, uint32_t wanted,
                const Change* change, std::array<SpecularChain, lpe::kMaxComponents>* chains) const;
  // Goes a way from another place of the film, up to its last ray, which is not traced. False: the way breaks.
  bool follow(const Vec2& film, const SpecularSignature& signature, SpecularChain* chain) const;
  // Whether its last ray may meet something within about that distance, transparent or not: cheaper than to ask what.
  bool meets(const SpecularChain& chain, float distance) const;
  // What its last ray meets; t: from where that ray begins. False: it ends in the sky.
  bool finish(const SpecularChain& chain, geometry::Hit* hit) const;

  const scene::Snapshot& snapshot() const { return snapshot_; }
  const camera::Camera& camera() const { return camera_; }
  const GradusSettings& settings() const { return settings_; }

 private:
  struct Search;
  struct Arrival;
  struct Branch {
    bsdf::ScatterClass event;
    float strength;
    path::PathRay ray;
  };
  enum class Shades : uint8_t { All, Transparency };
  path::PathRay camera_ray(const Vec2& film) const;
  bool advance(Shades shades, const geometry::Hit* known, path::PathRay* ray, Arrival* arrival) const;
  float scatter(const path::Vertex& vertex, bsdf::ScatterClass event, path::PathRay* ray) const;
  std::array<Branch, 2> branches(const Search& search, const path::Vertex& vertex, const path::PathRay& ray,
                                 lpe::LpeState lpe_state) const;
  bool extend(Search* search, path::PathRay ray, lpe::LpeState lpe_state, SpecularChain* chain) const;
  bool continue_chain(Search* search, const Arrival& arrival, const path::PathRay& ray, lpe::LpeState lpe_state,
                      SpecularChain* chain) const;
  bool is_seen(const Search& search, lpe::LpeState lpe_state, SpecularChain* chain) const;

  const scene::Snapshot& snapshot_;
  const camera::Camera& camera_;
  const GradusSettings& settings_;
  float time_;
};

}  // namespace gradus::motion
