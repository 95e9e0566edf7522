// The Image Texture and Environment Texture nodes.
#include "base/trigonometry.h"
#include "image/image_store.h"
#include "shading/context_ops.h"
#include "shading/image_mode.h"
#include "shading/scalar.h"
#include "shading/texture_extent.h"

namespace gradus::shading {
namespace {

const Vec4 kMissing(1.0f, 0.0f, 1.0f, 1.0f);

struct Sampler {
  const image::ImageStore* images;
  uint32_t index;
  image::Interpolation interpolation;
  image::Extension extension;
  bool unassociate;
  float extent;
  Vec4 at(const Vec2& uv) const { return images->lookup(index, uv, interpolation, extension, unassociate, extent); }
};

Sampler sampler_of(const ResourceArgs& args, const ShadeContext& c) {
  return {c.images,
          args.resource,
          interpolation_of(args.mode),
          extension_of(args.mode),
          (args.mode >> 6 & 1) != 0,
          args.texture_map ? texture_extent(*args.texture_map, c) : 0.0f};
}

// Spherical projection of a point to UV coordinates.
Vec2 sphere(const Vec3& p) {
  const float length = glm::length(p);
  if (!(length > 0.0f)) return Vec2(0.0f);
  const float u = p.x == 0.0f && p.y == 0.0f ? 0.0f : (1.0f - std::atan2(p.x, p.y) * kInvPi) * 0.5f;
  return Vec2(u, 1.0f - std::acos(std::clamp(p.z / length, -1.0f, 1.0f)) * kInvPi);
}

// Cylindrical projection of a point to UV coordinates.
Vec2 tube(const Vec3& p) {
  const float length = std::sqrt(p.x * p.x + p.y * p.y);
  if (!(length > 0.0f)) return Vec2(0.0f);
  return Vec2((1.0f - std::atan2(p.x, p.y) * kInvPi) * 0.5f, (p.z + 1.0f) * 0.5f);
}

// Returns the weight of side `a` near the edge between two sides with the normal components a and b.
float edge_weight(float a, float b, float blend) { return saturate((a / (a + b) - 0.5f * (1.0f - blend)) / blend); }

// Returns the weights of the projections along x, y and z. It is 1 for the side that the normal faces, except in bands
// of the width `blend` at edges and corners.
Vec3 box_weights(Vec3 n, float blend) {
  n = glm::abs(n);
  n /= n.x + n.y + n.z;
  const float limit = 0.5f * (1.0f + blend);
  if (n.x > limit * (n.x + n.y) && n.x > limit * (n.x + n.z)) return Vec3(1, 0, 0);
  if (n.y > limit * (n.x + n.y) && n.y > limit * (n.y + n.z)) return Vec3(0, 1, 0);
  if (n.z > limit * (n.x + n.z) && n.z > limit * (n.y + n.z)) return Vec3(0, 0, 1);
  if (!(blend > 0.0f)) return Vec3(1, 0, 0);
  if (n.z < (1.0f - limit) * (n.y + n.x)) {
    const float w = edge_weight(n.x, n.y, blend);
    return Vec3(w, 1.0f - w, 0.0f);
  }
  if (n.x < (1.0f - limit) * (n.y + n.z)) {
    const float w = edge_weight(n.y, n.z, blend);
    return Vec3(0.0f, w, 1.0f - w);
  }
  if (n.y < (1.0f - limit) * (n.x + n.z)) {
    const float w = edge_weight(n.x, n.z, blend);
    return Vec3(w, 0.0f, 1.0f - w);
  }
  return ((2.0f - limit) * n + (limit - 1.0f)) / (2.0f * limit - 1.0f);
}

Vec4 box(const Sampler& sampler, const Vec3& p, const Vec3& n, float blend) {
  const Vec3 weights = box_weights(n, blend);
  Vec4 sum(0.0f);
  // The image is mirrored on the opposite sides, so that text is readable on all sides.
  if (weights.x > 0.0f) sum += weights.x * sampler.at(Vec2(n.x < 0.0f ? 1.0f - p.y : p.y, p.z));
  if (weights.y > 0.0f) sum += weights.y * sampler.at(Vec2(n.y > 0.0f ? 1.0f - p.x : p.x, p.z));
  if (weights.z > 0.0f) sum += weights.z * sampler.at(Vec2(n.z > 0.0f ? 1.0f - p.y : p.y, p.x));
  return sum;
}

// Equirectangular projection with +X in the middle of the image.
Vec2 latitude_longitude(const Vec3& d) {
  const float horizontal2 = d.x * d.x + d.y * d.y;
  if (!(horizontal2 > 0.0f)) return Vec2(0.5f, d.z > 0.0f ? 1.0f : d.z < 0.0f ? 0.0f : 0.5f);
  const auto longitude = static_cast<float>(angle_of(d.x, d.y)),
             latitude = static_cast<float>(angle_of(std::sqrt(horizontal2), d.z));
  return Vec2(0.5f - longitude * (0.5f * kInvPi), latitude * kInvPi + 0.5f);
}

// Projection of a mirror ball that is seen along +Y.
Vec2 mirror_ball(Vec3 d) {
  d.y -= 1.0f;
  const float scale = 2.0f * std::sqrt(std::max(-0.5f * d.y, 0.0f));
  if (scale > 0.0f) d /= scale;
  return Vec2(0.5f * (d.x + 1.0f), 0.5f * (d.z + 1.0f));
}

bool unusable(const ResourceArgs& args, const ShadeContext& c) {
  return !c.images || args.resource >= c.images->size();
}

}  // namespace

void image_op(const ResourceArgs& args, const ShadeContext& c, Vec4* out) {
  Vec4 color = kMissing;
  if (!unusable(args, c)) {
    const Sampler sampler = sampler_of(args, c);
    const Vec3 p = args.v(0), remapped = (p - 0.5f) * 2.0f;
    const uint32_t projection = args.mode & 3;
    if (c.mean_textures)
      color = Vec4(c.images->mean(args.resource), 1.0f);
    else if (projection == GRADUS_PROJECTION_BOX)
      color = box(sampler, p, normal_to_local(c, c.normal), args.float_count > 0 ? args.floats[0] : 0.0f);
    else
      color = sampler.at(projection == GRADUS_PROJECTION_SPHERE ? sphere(remapped)
                         : projection == GRADUS_PROJECTION_TUBE ? tube(remapped)
                                                                : Vec2(p));
  }
  out[0] = Vec4(Vec3(color), 1.0f);
  out[1] = splat(color.w);
}

void environment_op(const ResourceArgs& args, const ShadeContext& c, Vec4* out) {
  out[0] = kMissing;
  if (unusable(args, c)) return;
  if (c.mean_textures) {
    out[0] = Vec4(c.images->mean(args.resource), 1.0f);
    return;
  }
  const Vec3 direction = safe_normalize(args.v(0));
  const Vec2 uv = args.mode & 3 ? mirror_ball(direction) : latitude_longitude(direction);
  out[0] = Vec4(Vec3(sampler_of(args, c).at(uv)), 1.0f);
}

}  // namespace gradus::shading
