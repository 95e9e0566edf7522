#include "motion/flow_frame.h"

#include "motion/silhouettes.h"

namespace gradus {

FlowFrame::FlowFrame(const GreyImage& image, const ComponentFrame& frame)
    : image_(image),
      tracked_(frame.tracked),
      object_(frame.object.begin(), frame.object.end()),
      edges_(silhouettes(image.width, image.height, frame.object, frame.depth)) {
  for (const Vec2& vector : frame.surface) surface_.push_back(bounded(vector));
  object_.resize(count(), 0);
}

size_t FlowFrame::nearest(const Vec2& place) const {
  const Vec2 p = glm::floor(clamped_to(place, width(), height()) + 0.5f);
  return size_t(p.y) * size_t(width()) + size_t(p.x);
}

bool FlowFrame::holds(const Vec2& p) const {
  return p.x >= -0.5f && p.y >= -0.5f && p.x <= float(width()) - 0.5f && p.y <= float(height()) - 0.5f;
}

Vec2 FlowFrame::bounded(const Vec2& vector) const {
  const Vec2 most = {float(width()), float(height())};
  return is_finite(vector.x) && is_finite(vector.y) ? glm::clamp(vector, -most, most) : Vec2(0.0f);
}

}  // namespace gradus
