#include "film/splat_plane.h"

#include <utility>

#include "film/finite_check.h"

namespace gradus::film {

SplatPlane::SplatPlane(const Region& region)
    : region_(region), sums_(static_cast<size_t>(region.area()), Radiance(0.0f)) {}

void SplatPlane::merge(uint32_t unit, uint64_t paths, std::vector<Splat> splats, Counters* counters) {
  const std::lock_guard lock(mutex_);
  early_[unit] = {paths, std::move(splats)};
  for (auto i = early_.begin(); i != early_.end() && i->first == next_; i = early_.erase(i), ++next_) {
    add(i->second, counters);
  }
}

void SplatPlane::add(const Unit& unit, Counters* counters) {
  for (const Splat& splat : unit.splats) {
    if (region_.contains(splat.x, splat.y)) {
      const int64_t row = splat.y - region_.y0;
      add_radiance(splat.value, &sums_[static_cast<size_t>(row * region_.width() + splat.x - region_.x0)], counters);
    }
  }
  paths_ += unit.paths;
}

uint64_t SplatPlane::paths() const {
  const std::lock_guard lock(mutex_);
  return paths_;
}

std::vector<Radiance> SplatPlane::mean() const {
  const std::lock_guard lock(mutex_);
  std::vector<Radiance> image = sums_;
  for (Radiance& value : image) value /= paths_ > 0 ? static_cast<float>(paths_) : 1.0f;
  return image;
}

}  // namespace gradus::film
