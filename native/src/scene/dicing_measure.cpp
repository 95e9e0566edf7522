#include "scene/dicing_measure.h"

#include <algorithm>
#include <cmath>

#include "geometry/mesh.h"

namespace gradus::scene {

namespace {

// Longest edge of the triangles that make a square, by the side of the square. Cycles dices into such squares.
const float kDiagonal = std::sqrt(2.0f);

// Maximum number of instances by which an edge is measured. Of more the nearest ones decide.
constexpr size_t kMaxInstances = 32;

Mat4 inverse_of(const GradusCamera& camera) {
  Mat4 m;
  std::copy_n(camera.matrix, 16, &m[0][0]);
  return glm::inverse(m);
}

// Returns the smallest and the largest change of lengths along the axes of a matrix.
std::array<float, 2> stretch_of(const Mat4& m) {
  const Vec3 axes(glm::length(Vec3(m[0])), glm::length(Vec3(m[1])), glm::length(Vec3(m[2])));
  return {std::min({axes.x, axes.y, axes.z}), std::max({axes.x, axes.y, axes.z})};
}

// An instance, and the maximum length that an edge of length 1 can have in the picture.
struct Candidate {
  float maximum = 0.0f;
  size_t index = 0;
};

}  // namespace

PictureScale::PictureScale(const GradusCamera& camera) : camera_(camera), to_camera_(inverse_of(camera)) {
  const float* w = camera.window;
  per_metre_ = camera.type == GRADUS_CAMERA_PANORAMA ? 2.0f * kPi : std::max(w[1] - w[0], 1e-6f);
  const auto border = [](const Vec3& outwards, const Vec3& along) {
    return Border{glm::normalize(outwards), glm::normalize(along)};
  };
  borders_ = {border({-1, 0, -w[0]}, {w[0], 0, -1}), border({1, 0, w[1]}, {w[1], 0, -1}),
              border({0, -1, -w[2]}, {0, w[2], -1}), border({0, 1, w[3]}, {0, w[3], -1})};
}

// Returns the distance of a point in the camera's space from what the camera sees.
float PictureScale::distance_outside(const Vec3& p) const {
  if (camera_.type == GRADUS_CAMERA_PANORAMA) return 0.0f;
  if (camera_.type == GRADUS_CAMERA_ORTHOGRAPHIC) {
    const float* w = camera_.window;
    const Vec3 seen(glm::clamp(p.x, w[0], w[1]), glm::clamp(p.y, w[2], w[3]), std::min(p.z, 0.0f));
    return glm::distance(p, seen);
  }
  float distance = 0.0f;
  for (const Border& border : borders_) {
    const float across = glm::dot(p, border.outwards);
    if (across > 0.0f) distance = std::max(distance, glm::dot(p, border.along) >= 0.0f ? across : glm::length(p));
  }
  return distance;
}

float PictureScale::width_at(const Vec3& point, float offscreen_scale) const {
  const Vec3 p(to_camera_ * Vec4(point, 1.0f));
  const float outside = (offscreen_scale - 1.0f) * distance_outside(p);
  if (camera_.type == GRADUS_CAMERA_ORTHOGRAPHIC) return per_metre_ + outside;
  return per_metre_ * (std::max({glm::length(p), camera_.clip_start, 1e-6f}) + outside);
}

float PictureScale::slope(float offscreen_scale) const {
  if (camera_.type == GRADUS_CAMERA_ORTHOGRAPHIC) return offscreen_scale - 1.0f;
  return per_metre_ * offscreen_scale;
}

EdgeMeasure::EdgeMeasure(const PictureScale& scale, const geometry::MeshData& mesh,
                         const std::vector<const geometry::InstanceData*>& instances)
    : scale_(scale),
      rate_(mesh.dicing_rate),
      length_(mesh.dicing_length),
      offscreen_scale_(mesh.offscreen_dicing_scale) {
  if (!(rate_ > 0.0f)) return;
  // The lengths of edges in the picture have bounds that follow from its width over the instance. An instance whose
  // maximum is below another's minimum decides nowhere.
  const Vec3 centre = (mesh.lower + mesh.upper) * 0.5f;
  const float radius = glm::distance(mesh.lower, mesh.upper) * 0.5f;
  std::vector<Candidate> candidates;
  float minimum = 0.0f;
  for (size_t i = 0; i < instances.size(); ++i) {
    const Mat4& to_world = instances[i]->to_world;
    const auto [smallest, largest] = stretch_of(to_world);
    const float middle = scale.width_at(Vec3(to_world * Vec4(centre, 1.0f)), offscreen_scale_);
    const float change = scale.slope(offscreen_scale_) * largest * radius;
    candidates.push_back({change < middle ? largest / (middle - change) : kInfinity, i});
    minimum = std::max(minimum, smallest / (middle + change));
  }
  std::erase_if(candidates, [&](const Candidate& c) { return c.maximum < minimum; });
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.maximum > b.maximum; });
  if (candidates.size() > kMaxInstances) candidates.resize(kMaxInstances);
  for (const Candidate& c : candidates) to_world_.push_back(instances[c.index]->to_world);
}

float EdgeMeasure::excess(const Vec3& a, const Vec3& b) const {
  if (length_ > 0.0f && !(rate_ > 0.0f)) return glm::distance(a, b) / (kDiagonal * length_);
  float excess = 0.0f;
  for (const Mat4& to_world : to_world_) {
    const Vec3 p(to_world * Vec4(a, 1.0f)), q(to_world * Vec4(b, 1.0f));
    excess = std::max(excess, glm::distance(p, q) / scale_.width_at((p + q) * 0.5f, offscreen_scale_));
  }
  return excess / (kDiagonal * rate_);
}

}  // namespace gradus::scene
