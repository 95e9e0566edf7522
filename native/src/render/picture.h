// What can be seen of a render at any time, from any thread: the noisy image, tile by tile, and what stands in the
// place of Combined.
//
// Readers take the picture from here: they wait for no sampler, whose batch may take long, and see no half of one.
#pragma once

#include <cstddef>
#include <mutex>
#include <vector>

#include "film/film.h"

namespace gradus::render {

class Picture {
 public:
  explicit Picture(const Region& region) : region_(region) {}

  // Room for tiles: black, until they come.
  void expect_tiles();
  // What the tile has now becomes what is seen of it in the noisy image.
  void show_tile(const film::Film& film, const Region& tile);
  // RGBA of the region, and pass Error of it where that is asked for: Combined from now on.
  // components: RGB of each, or none.
  void show(std::vector<float> rgba, std::vector<float> error, std::vector<std::vector<float>> components = {});
  // In place of what was shown, by the thread that showed it. error: its squared error, over that of what was shown.
  void show_denoised(std::vector<float> rgba, float error);
  // From now on the frame tells what the noisy image is.
  void end_tiles();

  bool is_reconstructed() const;
  // For the thread that shows it, alone.
  const std::vector<float>& combined() const { return combined_; }
  // False: there is nothing of this pass.
  bool read(uint32_t pass, float* pixels) const;
  // Of a component; empty where there is none.
  std::vector<float> component(int number) const;
  size_t memory_bytes() const;

 private:
  const Region region_;
  mutable std::mutex mutex_;
  std::vector<float> noisy_, combined_;  // RGBA; empty where there is none
  std::vector<float> error_;
  std::vector<std::vector<float>> components_;
};

}  // namespace gradus::render
