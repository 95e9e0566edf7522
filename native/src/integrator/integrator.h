// Interface of integrators. An integrator samples pixels into a film, as a pure function of scene, settings and work
// unit.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "camera/camera.h"
#include "film/film.h"
#include "film/replay_map.h"
#include "lpe/components.h"
#include "scene/snapshot.h"

namespace gradus::integrator {

// Pixels of a tile, and the samples to take of each. All maps have one element for each pixel of the film's region.
struct WorkUnit {
  Region tile;
  // Sample numbers [first_sample, first_sample + count) of each pixel.
  uint32_t first_sample = 0;
  uint32_t count = 0;
  // Number of samples of each pixel, which may be 0; replaces `count`. The weights of gradient pairs take the counts of
  // neighbours from it.
  const std::vector<uint32_t>* count_map = nullptr;
  // First sample number of each pixel, equal within a pixel block; replaces `first_sample`.
  const std::vector<uint32_t>* first_map = nullptr;
  // 0 for pixels that this unit skips, although another unit samples them.
  const std::vector<uint8_t>* pixel_map = nullptr;
  // 0 for pixels whose paths have no offset paths. Pairs with such a pixel are absent.
  const std::vector<uint8_t>* gradient_map = nullptr;
  // 1 for pixels whose samples take further camera rays, for the edges of emitters that the camera sees
  // (path/emission_edges.h). Null if none do. Gradients ignore it.
  const std::vector<uint8_t>* edge_map = nullptr;
  // Pixels of another frame whose random numbers the pixels replay; null if they use their own.
  const film::ReplayMap* replay_map = nullptr;
  // Components to sample, as bits, of all pixels and of each. The planes of others do not change, and paths that can
  // reach only others end.
  uint32_t components = lpe::kEveryComponent;
  const std::vector<uint32_t>* component_map = nullptr;
  // The unit adds components to samples that were taken before. Their counts and data passes are not added again.
  bool adds_components = false;
};

class Integrator {
 public:
  virtual ~Integrator() = default;
  // Returns the pixels of a region whose samples take further camera rays, as WorkUnit::edge_map; empty if none do.
  // Returns early on `stop`.
  virtual std::vector<uint8_t> find_edges(const Region& region, const std::atomic<bool>& stop) const {
    (void)region, (void)stop;
    return {};
  }
  // Samples the unit into the film and writes only pixels of the tile. Thread-safe for disjoint tiles. Polls `stop` at
  // least once for each sample of a pixel; a sample that is stopped leaves no trace in the film.
  virtual void sample(const WorkUnit& unit, film::Film* film, film::Counters* counters,
                      const std::atomic<bool>& stop) const = 0;
};

// Arguments of all integrators, which copy them.
struct IntegratorContext {
  std::shared_ptr<const scene::Snapshot> snapshot;
  camera::Camera camera;
  GradusSettings settings;
  lpe::ComponentSet components = {};  // components of the films that are sampled
};

// Returns a new integrator for plain path tracing.
std::unique_ptr<Integrator> make_path_integrator(const IntegratorContext& context);

}  // namespace gradus::integrator
