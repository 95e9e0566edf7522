#include "motion/flow_frame.h"

#include "motion/for_each_pixel.h"
#include "motion/silhouettes.h"

namespace gradus::motion {

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
