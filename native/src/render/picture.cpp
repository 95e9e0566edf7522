#include "render/picture.h"

#include <algorithm>

#include "film/pixel_blocks.h"
#include "output/pass_read.h"

namespace gradus::render {

Picture::Picture(const Region& region, uint32_t threads) : shown_{nullptr, region, threads} {}

void Picture::expect_tiles() {
  std::vector<float> black(4 * size_t(shown_.region.area()), 0.0f);
  const std::lock_guard lock(mutex_);
  tiles_ = std::move(black);
}

void Picture::show_tile(const film::Film& film, const Region& tile) {
  const Region& region = shown_.region;
  const Region part = film::intersection(tile, region);
  if (part.width() <= 0 || part.height() <= 0) return;
  std::vector<float> rgba(4 * size_t(part.area()));
  output::read_film_pass(film, GRADUS_PASS_NOISY_IMAGE, part, rgba.data());
  const size_t row = 4 * size_t(part.width());
  const std::lock_guard lock(mutex_);
  for (int32_t y = part.y0; y < part.y1; ++y) {
    const size_t to = 4 * region.index(part.x0, y);
    std::copy_n(rgba.data() + size_t(y - part.y0) * row, row, tiles_.data() + to);
  }
}

void Picture::end_tiles(std::shared_ptr<const film::Film> film) {
  const std::lock_guard lock(mutex_);
  tiles_ = {};
  shown_.film = std::move(film);
}

void Picture::show(output::DevelopedFilm developed) {
  const std::lock_guard lock(mutex_);
  shown_ = std::move(developed);
}

bool Picture::is_reconstructed() const {
  const std::lock_guard lock(mutex_);
  return shown_.find(GRADUS_PASS_COMBINED) != nullptr;
}

output::DevelopedFilm Picture::shown() const {
  const std::lock_guard lock(mutex_);
  return shown_;
}

void Picture::read(uint32_t pass, float* pixels) const {
  output::DevelopedFilm now;
  {
    const std::lock_guard lock(mutex_);
    const bool shows_noise = pass == GRADUS_PASS_NOISY_IMAGE || pass == GRADUS_PASS_COMBINED;
    if (shows_noise && !tiles_.empty() && !shown_.find(pass))
      return static_cast<void>(std::copy(tiles_.begin(), tiles_.end(), pixels));
    now = shown_;
  }
  now.read_pass(pass, pixels);
}

size_t Picture::memory_bytes() const {
  const std::lock_guard lock(mutex_);
  return tiles_.size() * sizeof(float) + shown_.memory_bytes();
}

}  // namespace gradus::render
