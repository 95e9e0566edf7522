// All emitters of a scene, and the choice among them.
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

struct EmissiveTriangle {
  uint32_t instance = 0;
  uint32_t triangle = 0;
  float area = 0.0f;
};

// Probabilities of the three kinds of emitters for one receiver; they sum to one, or are all 0: nothing reaches it.
struct GroupChoice {
  double tree = 0.0, suns = 0.0, world = 0.0;
};

// The choice among all emitters as one receiver sees it.
struct LightChoice {
  bool known = false;
  Receiver receiver;
  LightTree::Cut cut;
  GroupChoice group;
};

struct LightTable {
  std::vector<AnalyticLight> analytic_lights;
  std::vector<EmissiveTriangle> triangles;  // instance after instance, ascending
  std::vector<uint32_t> first_triangle;     // of each instance, in `triangles`; one more at the end
  std::vector<uint32_t> beyond_limit;  // instances with more triangles than there was room for: found by rays alone
  LightTree tree;                      // lights: those of tree_lights, then the triangles
  std::vector<uint32_t> tree_lights;   // lights that are not at infinity
  std::vector<uint32_t> suns;          // lights that are
  std::vector<uint32_t> slot;          // of each light, in tree_lights or suns
  std::vector<float> sun_irradiance;   // of each sun
  Environment world;
  std::shared_ptr<const LightScene> lights_with_extent;

  // There is nothing to choose.
  bool is_single_light() const { return tree.size() == 1 && suns.empty() && world.black(); }
  // The choice for a receiver, from its memo if that has it; room: where else to work it out. A vertex is asked by its
  // own light sample, for the weight of what its ray finds, and by the offsets of its pixel's neighbours.
  const LightChoice& choose(const Receiver& receiver, LightChoice* room) const;
  // Of one sun among the suns.
  double sun_probability(size_t sun, const Receiver& receiver) const;
  // Index in `lights` of the sun that is chosen by u in [0, 1), with that probability.
  uint32_t sample_sun(const Receiver& receiver, double u, double* probability) const;
  // Index in `triangles`, UINT32_MAX if it is not sampled as a light.
  uint32_t find_triangle(uint32_t instance, uint32_t triangle) const;

 private:
  // cut: through the tree, for this receiver.
  GroupChoice choose_group(const Receiver& receiver, const LightTree::Cut& cut) const;
  double irradiance_of_suns(const Receiver& receiver) const;
};

// The scene is complete but for its emitters. lights_with_extent is left to the caller. world: what the commit before
// left, which this one brings up to date. Throws Error CANCELLED.
std::shared_ptr<LightTable> build_light_table(const LitScene& scene, std::vector<AnalyticLight> analytic_lights,
                                              WorldMap* world, const CommitMonitor& monitor);

}  // namespace gradus::light
