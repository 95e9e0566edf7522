#include "path/burley_disk.h"

#include <algorithm>
#include <cmath>

#include "base/trigonometry.h"
#include "bsdf/shading_frame.h"

namespace gradus::path {

namespace {

// Integral of the profile up to kDiskReach without the cut.
constexpr float kDiskShare = 0.9963790093708328f;
// A ray meets at most this number of surfaces.
constexpr int kMaxHits = 16;

// The axis of a disk, with its probability, and the axes of the other two disks with theirs.
struct DiskFrame {
  Vec3 axis[3];  // the first is that of the chosen disk
  float probability[3];
};

// Chooses the axis of the disk: the normal for one half. Scales u.y to [0, 1) for the next use.
DiskFrame choose_frame(const Vec3& normal, Vec2* u) {
  const Vec3 tangent = bsdf::perpendicular(normal), bitangent = glm::cross(normal, tangent);
  if (u->y < 0.5f) {
    u->y *= 2.0f;
    return {{normal, tangent, bitangent}, {0.5f, 0.25f, 0.25f}};
  }
  u->y = 4.0f * u->y - 2.0f;
  if (u->y < 1.0f) return {{tangent, normal, bitangent}, {0.25f, 0.5f, 0.25f}};
  u->y -= 1.0f;
  return {{bitangent, tangent, normal}, {0.25f, 0.25f, 0.5f}};
}

float count_channels(const Rgb& d) { return float((d.x > 0.0f) + (d.y > 0.0f) + (d.z > 0.0f)); }

// Chooses one of the channels that scatter, and scales u to [0, 1) for the next use.
float choose_scale(const Rgb& d, float* u) {
  float left = *u * count_channels(d);
  float chosen = 0.0f;
  for (int i = 0; i < 3; ++i) {
    if (!(d[i] > 0.0f)) continue;
    chosen = d[i];
    if (left < 1.0f) break;
    left -= 1.0f;
  }
  *u = std::min(left, 0.99999994f);
  return chosen;
}

Rgb profiles(const Rgb& d, float r) {
  return Rgb(burley_profile(d.x, r), burley_profile(d.y, r), burley_profile(d.z, r));
}

}  // namespace

float burley_profile(float d, float r) {
  if (!(r > 0.0f) || !(r < kDiskReach * d)) return 0.0f;
  const float third = std::exp(-r / (3.0f * d));
  return (third * third * third + third) / (4.0f * d * kDiskShare);
}

// The integral of the profile is 1 − e^(−r)/4 − 3 e^(−r/3)/4. With y = e^(−r/3) it is a cubic equation, y³ + 3y = 4(1 −
// u), whose real root Cardano's formula gives.
float sample_burley(float u) {
  const float half = 2.0f * (1.0f - u * kDiskShare);
  const float root = std::cbrt(half + std::sqrt(half * half + 1.0f));
  const float y = root - 1.0f / root;
  return std::clamp(-3.0f * std::log(std::max(y, 1e-10f)), 0.0f, kDiskReach);
}

bool probe_disk(const PathContext& context, const Sampler& sampler, const VertexSample& u, int depth,
                const Vertex& entry, const bsdf::Lobe& lobe, WalkEnd* end, Rgb* weight) {
  const Rgb d = bsdf::free_paths(lobe);
  const Vec3 normal = entry.facing_normal();
  Vec2 v = u.bsdf;
  const DiskFrame frame = choose_frame(normal, &v);
  const float scale = choose_scale(d, &v.x);
  const float radius = sample_burley(v.x) * scale;
  const float reach = kDiskReach * scale, height = std::sqrt(std::max(0.0f, reach * reach - radius * radius));
  const float density = 3.0f * mean_component(profiles(d, radius)) / count_channels(d);
  if (!(density > 0.0f)) return false;
  const SineCosine phi = sine_cosine(2.0f * kPi * v.y);
  const Vec3 offset = radius * (phi.cosine * frame.axis[1] + phi.sine * frame.axis[2]);
  const bool is_behind = glm::dot(entry.point.geometric_normal, entry.wo) < 0.0f;
  Ray ray{entry.point.position + offset + frame.axis[0] * height, 0.0f, -frame.axis[0], 2.0f * height,
          entry.point.hit.time};
  // One of the surfaces is chosen by its weight while the ray passes them. The draw is reused for each.
  float draw = sampler.walk_step(depth, 0).distance.x;
  float sum = 0.0f;
  Rgb chosen(0.0f);
  geometry::Hit hit;
  for (int i = 0; i < kMaxHits && context.scene.intersect_instance(ray, entry.point.hit.instance, &hit); ++i) {
    const geometry::SurfacePoint point = context.scene.surface_point(hit);
    const Vec3 out = is_behind ? -point.geometric_normal : point.geometric_normal;
    // The power heuristic over the three axes.
    float squares = 0.0f, first = 0.0f;
    for (int k = 0; k < 3; ++k) {
      const float p = frame.probability[k] * std::fabs(glm::dot(frame.axis[k], out));
      squares += p * p;
      if (k == 0) first = p;
    }
    const Rgb value = profiles(d, glm::length(point.position - entry.point.position)) * (first / (squares * density));
    const float share = mean_component(value);
    geometry::pass_surface(point, &ray);
    if (!(share > 0.0f) || !is_finite(share)) continue;
    sum += share;
    const float probability = share / sum;
    if (draw < probability) {
      draw /= probability;
      chosen = value / share;
      end->hit = hit;
      end->direction = out;
    } else {
      draw = (draw - probability) / (1.0f - probability);
    }
  }
  *weight *= chosen * sum;
  return sum > 0.0f;
}

}  // namespace gradus::path
