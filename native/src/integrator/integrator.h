// An integrator turns a unit of work into samples of a frame: a pure function of (scene, plan, unit).
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

// A unit of work (contract 1.3): pixels of a tile, sample numbers [first, first + count) of each. count_map: samples
// per pixel of the frame's region, 0 allowed, replaces `count`; the same map tells the counts of neighbours for the
// pair weights (contract 1.5). first_map: each pixel's first sample number, the same within a cell of the lattice,
// replaces `first_sample`. pixel_map: 0 for pixels of the frame's region that are passed over, though their counts are
// those of the others. sources: whose random numbers the pixels take, where the unit replays another frame; nullptr:
// their own. gradient_map: 0 for pixels of the region whose paths have no offsets; pairs with such a pixel are absent.
// components: bits of those that are sampled, component_map: of each pixel; others keep what they have, and paths that
// lead to them alone end. again: the unit adds components to samples that were counted before, and whose data passes
// are there.
struct WorkUnit {
  Region tile;
  uint32_t first_sample = 0;
  uint32_t count = 0;
  const std::vector<uint32_t>* count_map = nullptr;
  const std::vector<uint32_t>* first_map = nullptr;
  const std::vector<uint8_t>* pixel_map = nullptr;
  const std::vector<uint8_t>* gradient_map = nullptr;
  const film::ReplayMap* replay_map = nullptr;
  uint32_t components = lpe::kEveryComponent;
  const std::vector<uint32_t>* component_map = nullptr;
  bool adds_components = false;
};

class Integrator {
 public:
  virtual ~Integrator() = default;
  // Samples the unit into the frame: only pixels of the tile are written. `stop` is polled at least once per sample of
  // a pixel; what is half done then is left out as a whole sample. Thread-safe for disjoint tiles.
  virtual void sample(const WorkUnit& unit, film::Film* film, film::Counters* counters,
                      const std::atomic<bool>& stop) const = 0;
};

// What an integrator is made for; all lives as long as it.
struct IntegratorContext {
  std::shared_ptr<const scene::Snapshot> snapshot;
  camera::Camera camera;
  GradusSettings settings;
  lpe::ComponentSet components = {};  // planes of the frames that are sampled
};

std::unique_ptr<Integrator> make_path_integrator(const IntegratorContext& context);

}  // namespace gradus::integrator
