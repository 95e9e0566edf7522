// The images of a running render that can be read at any time and from any thread: the noisy image, updated tile by
// tile, and the reconstruction that is shown as Combined.
//
// Readers do not wait for samplers, whose batch may take long, and never see a partially written image.
#pragma once

#include <cstddef>
#include <mutex>
#include <vector>

#include "film/film.h"

namespace gradus::render {

class Picture {
 public:
  explicit Picture(const Region& region) : region_(region) {}

  // Allocates the noisy image, black until tiles are shown.
  void expect_tiles();
  // Copies the current mean of the samples of `tile` into the noisy image.
  void show_tile(const film::Film& film, const Region& tile);
  // Sets Combined: RGBA of the region, pass Error (empty if it is not wanted), and RGB of each component (empty: none).
  void show(std::vector<float> rgba, std::vector<float> error, std::vector<std::vector<float>> components = {});
  // Replaces Combined by the denoised image. Must be called by the thread that called show(). `error` is the factor by
  // which the squared error changes.
  void show_denoised(std::vector<float> rgba, float error);
  // Releases the noisy image. From now on it is read from the film.
  void end_tiles();

  bool is_reconstructed() const;
  // Returns Combined. Only for the thread that calls show(), because it takes no lock.
  const std::vector<float>& combined() const { return combined_; }
  // Copies the image of a pass. Returns false if there is none.
  bool read(uint32_t pass, float* pixels) const;
  // Returns RGB of a component; empty if there is none.
  std::vector<float> component(int number) const;
  size_t memory_bytes() const;

 private:
  const Region region_;
  mutable std::mutex mutex_;
  std::vector<float> noisy_, combined_;  // RGBA; empty if there is no such image
  std::vector<float> error_;
  std::vector<std::vector<float>> components_;
};

}  // namespace gradus::render
