#include "motion/flow_frame.h"

#include <algorithm>
#include <cmath>

#include "base/types.h"

namespace gradus::motion {
namespace {

// Maximum second difference of 1/depth over a continuous surface, relative to 1/depth, which is linear over a plane in
// perspective. A larger one is a step between surfaces.
constexpr float kStep = 0.05f;

float nearness(float depth) { return is_finite(depth) && depth > 0.0f ? 1.0f / depth : 0.0f; }

// Returns whether there is a step between three pixels in a line. At a mere bend, the differences on both sides are
// similar.
bool steps(float before, float here, float after) {
  const float one = std::abs(here - before), other = std::abs(after - here);
  return std::abs(before - 2.0f * here + after) > kStep * std::max(here, std::max(before, after)) &&
         std::max(one, other) > 2.0f * std::min(one, other);
}

}  // namespace

std::vector<uint8_t> silhouettes(int width, int height, std::span<const int32_t> object, std::span<const float> depth) {
  std::vector<uint8_t> result(size_t(width) * size_t(height), 0);
  const auto index = [&](int x, int y) {
    return size_t(std::clamp(y, 0, height - 1)) * size_t(width) + size_t(std::clamp(x, 0, width - 1));
  };
  const auto shows_other = [&](int x, int y) {
    for (int j = y - 1; j <= y + 1; ++j) {
      for (int i = x - 1; i <= x + 1; ++i) {
        if (object[index(i, j)] != object[index(x, y)]) return true;
      }
    }
    return false;
  };
  const auto near_at = [&](int x, int y) { return nearness(depth[index(x, y)]); };
  const auto shows_step = [&](int x, int y) {
    const float here = near_at(x, y);
    const bool across = x > 0 && x + 1 < width && steps(near_at(x - 1, y), here, near_at(x + 1, y));
    return across || (y > 0 && y + 1 < height && steps(near_at(x, y - 1), here, near_at(x, y + 1)));
  };
  each_pixel(width, height, [&](int x, int y, size_t p) {
    result[p] = (!object.empty() && shows_other(x, y)) || (!depth.empty() && shows_step(x, y));
  });
  return result;
}

FlowFrame::FlowFrame(const GreyImage& image, const ComponentFrame& frame)
    : image_(image),
      surface_(frame.surface.size()),
      tracked_(frame.tracked),
      object_(frame.object.begin(), frame.object.end()),
      edges_(silhouettes(image.width, image.height, frame.object, frame.depth)) {
  each_pixel(width(), height(),
             [&](int, int, size_t p) { surface_[p] = bounded(frame.surface[p], width(), height()); });
  object_.resize(count(), 0);
}

size_t FlowFrame::nearest(const Vec2& place) const {
  const Vec2 p = glm::floor(clamped_to(place, width(), height()) + 0.5f);
  return size_t(p.y) * size_t(width()) + size_t(p.x);
}

bool FlowFrame::holds(const Vec2& p) const {
  return p.x >= -0.5f && p.y >= -0.5f && p.x <= float(width()) - 0.5f && p.y <= float(height()) - 0.5f;
}

}  // namespace gradus::motion
