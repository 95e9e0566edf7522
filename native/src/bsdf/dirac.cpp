// Lobes of perfectly smooth interfaces: mirror, refraction, glass.
#include "bsdf/closures.h"
#include "bsdf/fresnel.h"
#include "bsdf/ggx.h"
#include "bsdf/lobe.h"
#include "bsdf/refract.h"

namespace gradus::bsdf {

bool dirac_direction(const Lobe& lobe, const Vec3& wo, bool transmitted, Vec3* wi, Rgb* coefficient) {
  if (!(wo.z > 0.0f)) {
    return false;
  }
  const FresnelSplit split = lobe_fresnel_split(lobe, std::min(1.0f, wo.z));
  *coefficient = lobe.weight * (transmitted ? split.transmitted : split.reflected);
  if (is_black(*coefficient)) {
    return false;
  }
  if (!transmitted) {
    *wi = Vec3(-wo.x, -wo.y, wo.z);
    return true;
  }
  if (lobe.ior == 1.0f) {
    *wi = -wo;
    return true;
  }
  return refract_direction(wo, Vec3(0.0f, 0.0f, 1.0f), lobe.ior, wi) && wi->z < 0.0f;
}

bool scatters_within(const Lobe& lobe, ScatterClass c) {
  if (c == ScatterClass::Transmission && sides_of(lobe.type) == kBothSides) {
    return lobe.scatter_class != ScatterClass::Diffuse;
  }
  return lobe.scatter_class == c;
}

int dirac_rank(const Closures& closures, ScatterClass c, int lobe) {
  int rank = 0;
  for (int i = 0; i < lobe; ++i) {
    rank += is_dirac(closures.lobe(i).type) && scatters_within(closures.lobe(i), c) ? 1 : 0;
  }
  return rank;
}

int dirac_lobe(const Closures& closures, ScatterClass c, int rank) {
  for (int i = 0; i < closures.count(); ++i) {
    if (is_dirac(closures.lobe(i).type) && scatters_within(closures.lobe(i), c) && rank-- == 0) {
      return i;
    }
  }
  return -1;
}

}  // namespace gradus::bsdf
