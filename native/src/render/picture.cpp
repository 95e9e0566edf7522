#include "render/picture.h"

#include <algorithm>

#include "film/pixel_blocks.h"
#include "output/combine.h"
#include "output/pass_read.h"

namespace gradus::render {

void Picture::expect_tiles() {
  std::vector<float> black(4 * size_t(region_.area()), 0.0f);
  const std::lock_guard lock(mutex_);
  noisy_ = std::move(black);
}

void Picture::show_tile(const film::Film& film, const Region& tile) {
  const Region part = film::intersection(tile, region_);
  if (part.width() <= 0 || part.height() <= 0) return;
  std::vector<float> rgba(4 * size_t(part.area()));
  output::read_film_pass(film, GRADUS_PASS_NOISY_IMAGE, part, rgba.data());
  const size_t row = 4 * size_t(part.width());
  const std::lock_guard lock(mutex_);
  for (int32_t y = part.y0; y < part.y1; ++y) {
    const size_t to = 4 * (size_t(y - region_.y0) * size_t(region_.width()) + size_t(part.x0 - region_.x0));
    std::copy_n(rgba.data() + size_t(y - part.y0) * row, row, noisy_.data() + to);
  }
}

void Picture::show(std::vector<float> rgba, std::vector<float> error, std::vector<std::vector<float>> components) {
  const std::lock_guard lock(mutex_);
  combined_ = std::move(rgba);
  error_ = std::move(error);
  components_ = std::move(components);
}

void Picture::show_denoised(std::vector<float> rgba, float error) {
  std::vector<std::vector<float>> components = components_;  // copied so that readers wait only for the exchange below
  output::follow_picture(combined_, rgba, &components);
  const std::lock_guard lock(mutex_);
  components_ = std::move(components);
  combined_ = std::move(rgba);
  for (float& value : error_) value *= error;
}

void Picture::end_tiles() {
  const std::lock_guard lock(mutex_);
  noisy_ = {};
}

bool Picture::is_reconstructed() const {
  const std::lock_guard lock(mutex_);
  return !combined_.empty();
}

bool Picture::read(uint32_t pass, float* pixels) const {
  const std::lock_guard lock(mutex_);
  const std::vector<float>* from = nullptr;
  if (pass == GRADUS_PASS_COMBINED) from = combined_.empty() ? &noisy_ : &combined_;
  if (pass == GRADUS_PASS_NOISY_IMAGE) from = &noisy_;
  if (pass == GRADUS_PASS_ERROR) from = &error_;
  if (from == nullptr || from->empty()) return false;
  std::copy(from->begin(), from->end(), pixels);
  return true;
}

std::vector<float> Picture::component(int number) const {
  const std::lock_guard lock(mutex_);
  return size_t(number) < components_.size() ? components_[size_t(number)] : std::vector<float>();
}

size_t Picture::memory_bytes() const {
  const std::lock_guard lock(mutex_);
  size_t values = noisy_.size() + combined_.size() + error_.size();
  for (const std::vector<float>& component : components_) values += component.size();
  return values * sizeof(float);
}

}  // namespace gradus::render
