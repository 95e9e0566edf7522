// The pictures of a running render that can be read at any time and from any thread: the noisy image, updated tile by
// tile, and the developed film or its preview.
//
// Readers do not wait for samplers, whose batch may take long, and never see a partially written image.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

#include "output/developed_film.h"

namespace gradus::render {

class Picture {
 public:
  // `threads` is the number of threads that read passes of the film.
  Picture(const Region& region, uint32_t threads);

  // Allocates the noisy image, black until tiles are shown.
  void expect_tiles();
  // Copies the current mean of the samples of `tile` into the noisy image.
  void show_tile(const film::Film& film, const Region& tile);
  // Releases the noisy image. From now on all that is not yet developed is read from the film, which no longer changes.
  // It is nullptr if the render ended before it had one.
  void end_tiles(std::shared_ptr<const film::Film> film);
  // Shows a developed film. While samples are taken, it is a preview without a film.
  void show(output::DevelopedFilm developed);

  bool is_reconstructed() const;
  // Returns what is shown. It has no film until end_tiles().
  output::DevelopedFilm shown() const;
  // Writes a pass. Until end_tiles(), the noisy image serves as Combined if no preview is shown, and passes that are
  // not known are 0.
  void read(uint32_t pass, float* pixels) const;
  size_t memory_bytes() const;  // of the images

 private:
  mutable std::mutex mutex_;
  std::vector<float> tiles_;  // RGBA of the noisy image; empty if it is read from the film
  output::DevelopedFilm shown_;
};

}  // namespace gradus::render
