// Representative paths (Zimmer et al. 2015, section 4.1), called specular chains here: from the camera through smooth
// surfaces to the first non-specular vertex, emitter or the sky.
//
// A sharp lobe counts as perfectly smooth about its shading normal. A chain passes straight through surfaces that are
// more than half transparent.
#pragma once

#include "camera/camera.h"
#include "lpe/components.h"
#include "motion/change.h"
#include "path/segment.h"
#include "scene/snapshot.h"

namespace gradus::motion {

// Maximum number of smooth vertices of a chain.
inline constexpr int kMaxChainLength = 8;

enum class ChainEnd : uint8_t { None, Surface, Sky };

// Identifies a sequence of smooth vertices: how each one scatters, and on which objects they lie. It is the same in
// every frame, so that chains of two frames can be compared.
struct SpecularSignature {
  uint8_t length = 0;
  uint16_t events = 0;    // ScatterClass of each vertex, two bits each
  uint64_t surfaces = 0;  // hash of the ids of the instances

  bsdf::ScatterClass event(int vertex) const { return bsdf::ScatterClass(events >> (2 * vertex) & 3); }
  void add(bsdf::ScatterClass event, uint64_t instance_id);
  bool operator==(const SpecularSignature&) const = default;
};

struct SpecularChain {
  SpecularSignature signature;
  bool is_static = false;  // whether no vertex changes between the frames, and nothing that moves can occlude the chain
  ChainEnd end = ChainEnd::None;
  geometry::Hit first;      // first smooth vertex; not valid if there is none
  geometry::Hit last;       // what the chain shows, if that is a surface
  Vec3 shown = Vec3(0.0f);  // position of `last`
  float length = 0.0f;      // length of the path to `last`
  path::PathRay ray;        // last ray
};

class ChainTracer {
 public:
  // camera: static and without a lens, as that of a CentreView. All arguments must outlive the tracer.
  ChainTracer(const scene::Snapshot& snapshot, const camera::Camera& camera, const GradusSettings& settings);

  // Finds chains at a film position for the components whose bits are set in `wanted`. Returns the bits of those that
  // have one, and stores it at the index of the component in `chains`. Where a surface both reflects and transmits, the
  // chain follows the stronger event that leads to the component. It ends on the first surface that is non-specular or
  // emits light of the component, or in the sky. known: what the camera ray hits. change: nullptr if not known; then no
  // chain is static. non_specular_above: probability of class D above which a surface counts as non-specular.
  uint32_t find(const Vec2& film, const geometry::Hit& known, const lpe::ComponentSet& components, uint32_t wanted,
                const Change* change, float non_specular_above,
                std::array<SpecularChain, lpe::kMaxComponents>* chains) const;
  // Traces the chain with a given signature from a film position, up to its last ray, which is not traced. Returns
  // false if there is no such chain.
  bool follow(const Vec2& film, const SpecularSignature& signature, SpecularChain* chain) const;
  // Whether the last ray may hit something, transparent or not, within about `distance`. It is cheaper than finish().
  bool meets(const SpecularChain& chain, float distance) const;
  // Traces the last ray. hit->t is the distance from its origin. Returns false if it leaves the scene.
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
