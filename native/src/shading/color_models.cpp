#include "shading/color_models.h"

#include "shading/scalar.h"

namespace gradus::shading {
namespace {

float smallest(const Vec3& c) { return std::min(c.x, std::min(c.y, c.z)); }

// Returns the hue, in 0…1, of a colour that is not grey. `upper` is the largest component, `delta` the range.
float hue(const Vec3& c, float upper, float delta) {
  float h;
  if (c.x == upper)
    h = (c.y - c.z) / delta;
  else if (c.y == upper)
    h = 2.0f + (c.z - c.x) / delta;
  else
    h = 4.0f + (c.x - c.y) / delta;
  h *= 1.0f / 6.0f;
  return h < 0.0f ? h + 1.0f : h;
}

}  // namespace

Vec3 rgb_to_hsv(const Vec3& c) {
  const float upper = max_component(c), delta = upper - smallest(c);
  const float s = upper != 0.0f ? delta / upper : 0.0f;
  return Vec3(s != 0.0f ? hue(c, upper, delta) : 0.0f, s, upper);
}

Vec3 hsv_to_rgb(const Vec3& hsv) {
  const float s = hsv.y, v = hsv.z;
  if (s == 0.0f) return Vec3(v);
  const float h = (hsv.x == 1.0f ? 0.0f : hsv.x) * 6.0f;
  const float sector = std::floor(h), f = h - sector;
  const float p = v * (1.0f - s), q = v * (1.0f - s * f), t = v * (1.0f - s * (1.0f - f));
  switch (to_int(sector)) {
    case 0:
      return Vec3(v, t, p);
    case 1:
      return Vec3(q, v, p);
    case 2:
      return Vec3(p, v, t);
    case 3:
      return Vec3(p, q, v);
    case 4:
      return Vec3(t, p, v);
    default:
      return Vec3(v, p, q);
  }
}

Vec3 rgb_to_hsl(const Vec3& c) {
  const float upper = max_component(c), lower = smallest(c), delta = upper - lower;
  const float l = std::min(1.0f, 0.5f * (upper + lower));
  if (delta == 0.0f) return Vec3(0.0f, 0.0f, l);
  const float s = l > 0.5f ? delta / (2.0f - upper - lower) : delta / (upper + lower);
  return Vec3(hue(c, upper, delta), s, l);
}

Vec3 hsl_to_rgb(const Vec3& hsl) {
  const float h = hsl.x * 6.0f;
  const Vec3 base(std::fabs(h - 3.0f) - 1.0f, 2.0f - std::fabs(h - 2.0f), 2.0f - std::fabs(h - 4.0f));
  const float chroma = (1.0f - std::fabs(2.0f * hsl.z - 1.0f)) * hsl.y;
  return (glm::clamp(base, 0.0f, 1.0f) - 0.5f) * chroma + Vec3(hsl.z);
}

}  // namespace gradus::shading
