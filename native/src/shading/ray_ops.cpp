// The Light Path, Layer Weight, Fresnel and Light Falloff nodes.
#include <cfloat>

#include "shading/context_ops.h"
#include "shading/scalar.h"

namespace gradus::shading {
namespace {

// Returns a normal of any length, as Cycles takes it, or that of the surface if the input has no link.
Vec3 normal_or_own(const Vec3& n, const ShadeContext& c) { return n == Vec3(0.0f) ? c.normal : n; }

float flag(const ShadeContext& c, uint32_t bit) { return c.ray.flags & bit ? 1.0f : 0.0f; }

float property(uint32_t mode, const ShadeContext& c) {
  switch (mode) {
    case GRADUS_LIGHT_PATH_CAMERA:
      return flag(c, kRayCamera);
    case GRADUS_LIGHT_PATH_SHADOW:
      return flag(c, kRayShadow);
    case GRADUS_LIGHT_PATH_DIFFUSE:
      return flag(c, kRayDiffuse);
    case GRADUS_LIGHT_PATH_GLOSSY:
      return flag(c, kRayGlossy);
    case GRADUS_LIGHT_PATH_SINGULAR:
      return flag(c, kRaySingular);
    case GRADUS_LIGHT_PATH_REFLECTION:
      return flag(c, kRayReflection);
    case GRADUS_LIGHT_PATH_TRANSMISSION:
      return flag(c, kRayTransmission);
    case GRADUS_LIGHT_PATH_LENGTH:
      return std::min(c.ray.length, FLT_MAX);
    case GRADUS_LIGHT_PATH_DEPTH:
      return c.ray.depth;
    case GRADUS_LIGHT_PATH_DIFFUSE_DEPTH:
      return c.ray.diffuse_depth;
    case GRADUS_LIGHT_PATH_GLOSSY_DEPTH:
      return c.ray.glossy_depth;
    case GRADUS_LIGHT_PATH_PORTAL_DEPTH:
      return c.ray.portal_depth;
    case GRADUS_LIGHT_PATH_TRANSPARENT_DEPTH:
      return c.ray.transparent_depth;
    default:
      return c.ray.transmission_depth;
  }
}

}  // namespace

void light_path_op(const ResourceArgs& args, const ShadeContext& c, Vec4* out) {
  out[0] = splat(property(args.mode, c));
}

void layer_weight_op(const ResourceArgs& args, const ShadeContext& c, Vec4* out) {
  const float cosine = glm::dot(c.wo, normal_or_own(args.v(1), c));
  float blend = args.f(0);
  const float eta = std::max(1.0f - blend, 1e-5f);
  out[0] = splat(dielectric_reflectance(cosine, c.backfacing ? eta : 1.0f / eta));
  float facing = std::fabs(cosine);
  if (blend != 0.5f) {
    blend = std::clamp(blend, 0.0f, 1.0f - 1e-5f);
    facing = std::pow(facing, blend < 0.5f ? 2.0f * blend : 0.5f / (1.0f - blend));
  }
  out[1] = splat(1.0f - facing);
}

void fresnel_op(const ResourceArgs& args, const ShadeContext& c, Vec4* out) {
  const float eta = std::max(args.f(0), 1e-5f);
  const float cosine = glm::dot(c.wo, normal_or_own(args.v(1), c));
  out[0] = splat(dielectric_reflectance(cosine, c.backfacing ? 1.0f / eta : eta));
}

// Changes the inverse square law of a light: the strength is multiplied by the ray's length for a linear falloff, or by
// its square for none.
void light_falloff_op(const ResourceArgs& args, const ShadeContext& c, Vec4* out) {
  const float length = std::min(c.ray.length, 1e18f);
  float strength = args.f(0);
  if (args.mode == 1) strength *= length;
  if (args.mode == 2) strength *= length * length;
  const float smooth = args.f(1), square = length * length;
  if (smooth > 0.0f) strength *= square / (smooth + square);
  out[0] = splat(strength);
}

}  // namespace gradus::shading
