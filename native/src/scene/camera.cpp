#include "scene/camera.h"

#include <algorithm>
#include <cmath>

#include <glm/gtc/type_ptr.hpp>

#include "scene/panorama.h"
#include "scene/spherical_stereo.h"

namespace gradus {

namespace {

// Area-preserving map of the square to the disk (Shirley and Chiu 1997).
Vec2 concentric_disk(const Vec2& u) {
  const Vec2 p = 2.0f * u - 1.0f;
  if (p == Vec2(0.0f)) return p;
  const bool wide = std::fabs(p.x) > std::fabs(p.y);
  const float r = wide ? p.x : p.y;
  const float phi = wide ? kPi / 4 * (p.y / p.x) : kPi / 2 - kPi / 4 * (p.x / p.y);
  return r * Vec2(std::cos(phi), std::sin(phi));
}

// Uniform in a regular polygon with circumradius 1: first the sector, then a point of its triangle. The middle of a side lies at
// `rotation`.
Vec2 regular_polygon(uint32_t corners, float rotation, const Vec2& u) {
  const float scaled = u.x * float(corners);
  const auto sector = std::min(uint32_t(scaled), corners - 1);
  const float half_angle = kPi / float(corners);
  const float root = std::sqrt(scaled - float(sector));
  const Vec2 p(root * std::cos(half_angle), root * (2.0f * u.y - 1.0f) * std::sin(half_angle));
  const float angle = rotation + 2.0f * half_angle * float(sector);
  const float c = std::cos(angle), s = std::sin(angle);
  return {c * p.x - s * p.y, s * p.x + c * p.y};
}

}  // namespace

Camera::Pose Camera::make_pose(const float* matrix, const float* window) {
  Pose pose;
  const Mat4 m = glm::make_mat4(matrix);
  const glm::dmat3 axes{glm::mat3(m)};
  const double volume = std::fabs(glm::determinant(axes));
  if (volume > 0.0 && volume < 1e30 && is_finite(Vec3(m[3]))) {
    pose.axes = Mat3(m);
    pose.inverse = Mat3(glm::inverse(axes));
    pose.position = Vec3(m[3]);
  }
  std::copy(window, window + 4, pose.window.begin());
  return pose;
}

Camera::Camera(const GradusCamera& desc, uint32_t width, uint32_t height) : desc_(desc), width_(width), height_(height) {
  poses_[int(Shutter::Now)] = make_pose(desc.matrix, desc.window);
  poses_[int(Shutter::Previous)] = make_pose(desc.matrix_previous, desc.window_previous);
  poses_[int(Shutter::Next)] = make_pose(desc.matrix_next, desc.window_next);
}

Vec2 Camera::lens_point(const Vec2& u) const {
  if (!has_lens()) return Vec2(0.0f);
  Vec2 p = desc_.blades < 3 ? concentric_disk(u) : regular_polygon(desc_.blades, desc_.blade_rotation, u);
  if (desc_.aperture_ratio > 0.0f) p.x /= desc_.aperture_ratio;
  return p * desc_.aperture_radius;
}

Ray Camera::ray(const Vec2& film, const Vec2& lens) const {
  const Pose& now = pose(Shutter::Now);
  const float x = now.window[0] + (now.window[1] - now.window[0]) * (film.x / float(width_));
  const float y = now.window[2] + (now.window[3] - now.window[2]) * (film.y / float(height_));
  if (is_panorama()) return panorama_ray(now, Vec2(x, y), lens);
  const bool orthographic = desc_.type == GRADUS_CAMERA_ORTHOGRAPHIC;
  Vec3 origin = orthographic ? Vec3(x, y, 0.0f) : Vec3(0.0f);
  Vec3 direction = orthographic ? Vec3(0, 0, -1) : Vec3(x, y, -1.0f);
  if (has_lens()) {
    const Vec3 offset(lens_point(lens), 0.0f);
    // All rays of a film point meet on the plane of focus.
    const float focus = std::max(desc_.focus_distance, 1e-5f);
    direction = direction * focus - offset;
    origin += offset;
  }
  const float slant = glm::length(direction) / -direction.z;  // distance along the ray for one unit of depth
  if (has_eye() && !orthographic) {
    direction = glm::normalize(direction);
    move_to_eye(desc_, stereo_axis(now), &origin, &direction);
  }
  Ray ray;
  ray.origin = now.position + now.axes * origin;
  ray.direction = glm::normalize(now.axes * direction);
  ray.t_min = std::max(0.0f, desc_.clip_start * slant);
  ray.t_max = desc_.clip_end * slant;
  return ray;
}

// The lens lies across the direction of each film point, and all its rays meet at the distance of focus.
Ray Camera::panorama_ray(const Pose& pose, const Vec2& point, const Vec2& lens) const {
  Vec3 origin(0.0f), direction;
  if (!panorama_direction(desc_, point, &direction)) return kNoRay;
  if (has_lens()) {
    Vec3 u, v;
    panorama_lens_axes(desc_, direction, &u, &v);
    const Vec2 offset = lens_point(lens);
    origin = u * offset.x + v * offset.y;
    direction = glm::normalize(direction * std::max(desc_.focus_distance, 1e-5f) - origin);
  }
  if (has_eye()) move_to_eye(desc_, stereo_axis(pose), &origin, &direction);
  Ray ray;
  ray.origin = pose.position + pose.axes * origin;
  ray.direction = glm::normalize(pose.axes * direction);
  ray.t_min = std::max(0.0f, desc_.clip_start);
  ray.t_max = desc_.clip_end;
  return ray;
}

// The eyes stay level in the world, or with the panorama. Cycles' space of mirror balls is mirrored, so that left is right.
Vec3 Camera::stereo_axis(const Pose& pose) const {
  if (!is_panorama()) return glm::normalize(glm::transpose(pose.axes) * Vec3(0, 0, 1));
  return Vec3(0.0f, desc_.panorama == GRADUS_PANORAMA_MIRROR_BALL ? -1.0f : 1.0f, 0.0f);
}

// Of the longitudes of a direction, the one next to the middle of the window.
bool Camera::panorama_plane(const Pose& pose, const Vec3& local, Vec2* point) const {
  if (!panorama_point(desc_, glm::normalize(local), point)) return false;
  if (panorama_wraps(desc_)) {
    const float middle = 0.5f * (pose.window[0] + pose.window[1]);
    point->x += 2.0f * kPi * std::round((middle - point->x) / (2.0f * kPi));
  }
  return true;
}

Vec2 Camera::way(const Vec2& from, const Vec2& to) const {
  Vec2 step = to - from;
  if (is_panorama() && panorama_wraps(desc_)) {
    const auto& w = pose(Shutter::Now).window;
    const float turn = 2.0f * kPi / (w[1] - w[0]) * float(width_);
    step.x -= turn * std::round(step.x / turn);
  }
  return step;
}

bool Camera::to_film(const Pose& pose, Vec3 local, bool at_infinity, Vec2* film) const {
  const bool orthographic = desc_.type == GRADUS_CAMERA_ORTHOGRAPHIC;
  if (has_eye() && !orthographic && !direction_from_centre(desc_, stereo_axis(pose), local, at_infinity, &local)) return false;
  Vec2 p;
  if (is_panorama()) {
    if (!panorama_plane(pose, local, &p)) return false;
  } else {
    const float depth = -local.z;
    if (!(depth > 0.0f)) return false;
    p = orthographic ? Vec2(local) : Vec2(local) / depth;
  }
  const auto& w = pose.window;
  *film = Vec2((p.x - w[0]) / (w[1] - w[0]) * float(width_), (p.y - w[2]) / (w[3] - w[2]) * float(height_));
  return true;
}

bool Camera::project(const Vec3& world, Shutter when, Vec2* film) const {
  const Pose& p = pose(when);
  return to_film(p, p.inverse * (world - p.position), false, film);
}

bool Camera::project_direction(const Vec3& direction, Shutter when, Vec2* film) const {
  // An orthographic camera sees no point at infinity but the one along its axis, everywhere.
  if (desc_.type == GRADUS_CAMERA_ORTHOGRAPHIC) return false;
  const Pose& p = pose(when);
  return to_film(p, p.inverse * direction, true, film);
}

float Camera::depth(const Vec3& world) const {
  const Pose& now = pose(Shutter::Now);
  return is_panorama() ? glm::length(world - now.position) : -(now.inverse * (world - now.position)).z;
}

Vec3 Camera::position() const { return pose(Shutter::Now).position; }

Vec3 Camera::forward() const { return glm::normalize(pose(Shutter::Now).axes * Vec3(0, 0, -1)); }

}  // namespace gradus
