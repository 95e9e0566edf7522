// The table of all emitters of a scene, and the choice among them.
#pragma once

#include <memory>
#include <vector>

#include "base/commit_monitor.h"
#include "light/analytic_light.h"
#include "light/environment.h"
#include "light/light_tree.h"

namespace gradus::light {

class LightScene;  // light/light_scene.h
struct WorldMap;   // light/world_map.h

// A triangle that is sampled as a light.
struct EmissiveTriangle {
  uint32_t instance = 0;
  uint32_t triangle = 0;
  float area = 0.0f;  // Area in m² at the middle of the shutter interval.
};

// Probabilities of the three groups of emitters for one receiver. They sum to one, or are all 0 if no group whose factor
// is above 0 reaches it, or their irradiance is not finite.
struct GroupChoice {
  double tree = 0.0, suns = 0.0, world = 0.0;
};

// Irradiance of the three groups at one receiver, as the mean of the channels.
struct GroupIrradiance {
  double tree = 0.0, suns = 0.0, world = 0.0;
};

// Factors on the irradiance of the groups, by which the choice among them is made. A uniform world with the factor 0 is
// left to BSDF sampling.
struct GroupFactors {
  double tree = 1.0, suns = 1.0, world = 1.0;
};

// The distribution over all emitters for one receiver.
struct LightChoice {
  bool known = false;  // True once the other fields are computed.
  Receiver receiver;
  LightTree::Cut cut;
  GroupChoice group;
};

// Returns the probabilities of the groups by their irradiance times their factors, in eighths: a digital net divides
// into eighths with exactly proportional numbers of points. A group with irradiance has at least one, because the
// estimates ignore occlusion.
GroupChoice choose_group(const GroupIrradiance& irradiance, const GroupFactors& factors);

struct LightTable {
  std::vector<AnalyticLight> analytic_lights;
  std::vector<EmissiveTriangle> triangles;  // Sorted by instance, then by triangle.
  std::vector<uint32_t> first_triangle;     // Offset of each instance in `triangles`, and the total.
  // Emissive instances whose triangles exceed the limit of the table. Only BSDF sampling finds them.
  std::vector<uint32_t> beyond_limit;
  LightTree tree;                     // Its lights are `tree_lights`, followed by `triangles`.
  std::vector<uint32_t> tree_lights;  // Indices of the analytic lights at finite distance.
  std::vector<uint32_t> suns;         // Indices of the analytic lights at infinity.
  std::vector<uint32_t> slot;         // Position of each analytic light in `tree_lights` or `suns`.
  std::vector<float> sun_irradiance;  // Irradiance of each sun on a plane facing it.
  Environment world;
  GroupFactors factors;
  std::shared_ptr<const LightScene> lights_with_extent;
  bool has_links = false;  // An emitter lights some light sets only, or is blocked by some shadow sets only.
  std::vector<uint32_t> linked_instances;  // Emissive instances in `triangles` that only some shadow sets block.

  // Returns whether there is exactly one emitter, so that no choice is needed.
  bool is_single_light() const { return tree.size() == 1 && suns.empty() && world.black(); }
  // Returns estimates of the irradiance of the groups at a receiver, without occlusion. `cut` is the cut through the
  // tree for that receiver.
  GroupIrradiance irradiance(const Receiver& receiver, const LightTree::Cut& cut) const;
  // Returns the choice for a receiver. The receiver's memo caches it; without a memo it is computed in `storage`. A
  // path vertex needs the choice several times: for its light sample, for the weight of the emitter that its BSDF
  // sample hits, and for the offset paths of neighbouring pixels.
  const LightChoice& choose(const Receiver& receiver, LightChoice* storage) const;
  // Returns the probability with which sample_sun() chooses the sun at index `sun` of `suns`.
  double sun_probability(size_t sun, const Receiver& receiver) const;
  // Returns the index in `analytic_lights` of the sun chosen by u in [0, 1), and writes the probability of that choice.
  uint32_t sample_sun(const Receiver& receiver, double u, double* probability) const;
  // Returns the index of a triangle in `triangles`, or UINT32_MAX if it is not sampled as a light.
  uint32_t find_triangle(uint32_t instance, uint32_t triangle) const;

 private:
  // Returns an upper bound of the irradiance of the sun at index `sun` of `suns`, without occlusion.
  float sun_importance(size_t sun, const Receiver& receiver) const;
  double irradiance_of_suns(const Receiver& receiver) const;
};

// Builds the table of a scene that is complete except for its light table. The caller sets `lights_with_extent`.
// `world` is the world map of the previous commit, which is updated. Throws Error CANCELLED.
std::shared_ptr<LightTable> build_light_table(const LitScene& scene, std::vector<AnalyticLight> analytic_lights,
                                              WorldMap* world, const CommitMonitor& monitor);

}  // namespace gradus::light
