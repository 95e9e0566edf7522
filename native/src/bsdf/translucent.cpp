// The translucent lobe: a Lambert lobe on the far side of the surface.
#include "bsdf/lobe.h"
#include "bsdf/warp.h"

namespace gradus::bsdf {

BsdfEval evaluate_translucent(const Lobe& lobe, const Vec3&, const Vec3& wi, uint8_t) {
  if (!(wi.z < 0.0f)) {
    return {};
  }
  const float pdf = -wi.z * kInvPi;
  return {lobe.weight * pdf, pdf};
}

bool sample_translucent(const Lobe&, const Vec3&, float, const Vec2& u, uint8_t, Vec3* wi) {
  *wi = sample_cosine_hemisphere(u);
  wi->z = -wi->z;
  return true;
}

}  // namespace gradus::bsdf
