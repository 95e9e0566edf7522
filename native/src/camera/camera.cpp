#include "camera/camera.h"

#include <algorithm>
#include <cmath>

#include <glm/gtc/type_ptr.hpp>

#include "base/fault.h"
#include "camera/panorama.h"
#include "camera/spherical_stereo.h"

namespace gradus::camera {

namespace {

// Maps the unit square to the unit disk and preserves relative area (Shirley and Chiu 1997).
Vec2 concentric_disk(const Vec2& u) {
  const Vec2 p = 2.0f * u - 1.0f;
  if (p == Vec2(0.0f)) return p;
  const bool wide = std::fabs(p.x) > std::fabs(p.y);
  const float r = wide ? p.x : p.y;
  const float phi = wide ? kPi / 4 * (p.y / p.x) : kPi / 2 - kPi / 4 * (p.x / p.y);
  return r * Vec2(std::cos(phi), std::sin(phi));
}

// Returns a uniform point in a regular polygon with circumradius 1. It chooses a sector first, then a point of its
// triangle. The middle of one side lies at the angle `rotation`.
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

Camera::Camera(const GradusCamera& desc, uint32_t width, uint32_t height)
    : desc_(desc), width_(width), height_(height) {
  poses_[int(Moment::Now)] = make_pose(desc.matrix, desc.window);
  poses_[int(Moment::Previous)] = make_pose(desc.matrix_previous, desc.window_previous);
  poses_[int(Moment::Next)] = make_pose(desc.matrix_next, desc.window_next);
  if (desc.shutter_key_count >= 2 && desc.shutter_matrices != nullptr) add_keys();
}

void Camera::add_keys() {
  geometry::check_shutter_key_count("camera", desc_.shutter_key_count);
  std::vector<glm::dmat4> keys;
  for (uint32_t i = 0; i < desc_.shutter_key_count; ++i) {
    const float* window = desc_.shutter_windows != nullptr ? desc_.shutter_windows + size_t{4} * i : desc_.window;
    const Pose pose = make_pose(desc_.shutter_matrices + size_t{16} * i, window);
    keys.emplace_back(Mat4(pose.axes));
    keys.back()[3] = glm::dvec4(glm::dvec3(pose.position), 1.0);
    windows_.push_back(pose.window);
  }
  keys_ = geometry::MatrixKeys(keys);
}

const Camera::Pose& Camera::pose_at(float time, Pose* storage) const {
  if (!moves()) return pose(Moment::Now);
  const Mat4 m = keys_.at(GRADUS_FAULT(camera_does_not_move) ? 0.0f : time);
  storage->axes = Mat3(m);
  storage->inverse = glm::inverse(storage->axes);
  storage->position = Vec3(m[3]);
  const geometry::KeyPlace place =
      geometry::key_place(GRADUS_FAULT(camera_does_not_zoom) ? 0.0f : time, windows_.size());
  const std::array<float, 4>&a = windows_[place.before], &b = windows_[place.before + 1];
  for (size_t i = 0; i < 4; ++i) storage->window[i] = a[i] * (1.0f - place.share) + b[i] * place.share;
  return *storage;
}

Camera Camera::without_lens() const {
  Camera pinhole = *this;
  pinhole.desc_.aperture_radius = 0.0f;
  return pinhole;
}

Camera Camera::frozen_at(float time) const {
  Camera frozen = *this;
  if (!moves()) return frozen;
  Pose& now = frozen.poses_[int(Moment::Now)];
  pose_at(time, &now);
  now.inverse = Mat3(glm::inverse(glm::dmat3(now.axes)));  // Uses double precision, as for every static camera.
  frozen.keys_ = {};
  frozen.windows_.clear();
  return frozen;
}

Vec2 Camera::lens_point(const Vec2& u) const {
  if (!has_lens()) return Vec2(0.0f);
  Vec2 p = desc_.blades < 3 ? concentric_disk(u) : regular_polygon(desc_.blades, desc_.blade_rotation, u);
  if (desc_.aperture_ratio > 0.0f) p.x /= desc_.aperture_ratio;
  return p * desc_.aperture_radius;
}

Ray Camera::ray(const CameraSample& sample) const {
  const Vec2& film = sample.film;
  Pose storage;
  const Pose& now = pose_at(sample.time, &storage);
  const float x = now.window[0] + (now.window[1] - now.window[0]) * (film.x / float(width_));
  const float y = now.window[2] + (now.window[3] - now.window[2]) * (film.y / float(height_));
  if (is_panorama()) return panorama_ray(now, Vec2(x, y), sample);
  const bool orthographic = desc_.type == GRADUS_CAMERA_ORTHOGRAPHIC;
  Vec3 origin = orthographic ? Vec3(x, y, 0.0f) : Vec3(0.0f);
  Vec3 direction = orthographic ? Vec3(0, 0, -1) : Vec3(x, y, -1.0f);
  if (has_lens()) {
    const Vec3 offset(lens_point(sample.lens), 0.0f);
    // All rays of a film point meet on the focus plane.
    const float focus = std::max(desc_.focus_distance, 1e-5f);
    direction = direction * focus - offset;
    origin += offset;
  }
  const float slant = glm::length(direction) / -direction.z;  // Distance along the ray per unit of depth.
  if (has_eye() && !orthographic) {
    direction = glm::normalize(direction);
    move_to_eye(desc_, stereo_axis(now), &origin, &direction);
  }
  Ray ray;
  ray.origin = now.position + now.axes * origin;
  ray.direction = glm::normalize(now.axes * direction);
  ray.t_min = std::max(0.0f, desc_.clip_start * slant);
  ray.t_max = desc_.clip_end * slant;
  ray.time = sample.time;
  return ray;
}

// The lens is perpendicular to the direction of each film point, and all rays of that point meet at the focus distance.
Ray Camera::panorama_ray(const Pose& pose, const Vec2& point, const CameraSample& sample) const {
  Vec3 origin(0.0f), direction;
  if (!panorama_direction(desc_, point, &direction)) return kNoRay;
  if (has_lens()) {
    Vec3 u, v;
    panorama_lens_axes(desc_, GRADUS_FAULT(panorama_lens_faces_camera_axis) ? Vec3(0, 0, -1) : direction, &u, &v);
    const Vec2 offset = lens_point(sample.lens);
    origin = u * offset.x + v * offset.y;
    direction = glm::normalize(direction * std::max(desc_.focus_distance, 1e-5f) - origin);
  }
  if (has_eye()) move_to_eye(desc_, stereo_axis(pose), &origin, &direction);
  Ray ray;
  ray.origin = pose.position + pose.axes * origin;
  ray.direction = glm::normalize(pose.axes * direction);
  ray.t_min = std::max(0.0f, desc_.clip_start);
  ray.t_max = desc_.clip_end;
  ray.time = sample.time;
  return ray;
}

// The axis is the world's up axis for a perspective camera and the camera's for a panorama. The space of mirror balls
// is mirrored in Cycles, which exchanges left and right.
Vec3 Camera::stereo_axis(const Pose& pose) const {
  if (!is_panorama()) return glm::normalize(glm::transpose(pose.axes) * Vec3(0, 0, 1));
  return Vec3(0.0f, desc_.panorama == GRADUS_PANORAMA_MIRROR_BALL ? -1.0f : 1.0f, 0.0f);
}

// Projects a direction to the panorama's plane. Of its equivalent longitudes, it takes the one nearest to the window's
// middle.
bool Camera::panorama_plane(const Pose& pose, const Vec3& local, Vec2* point) const {
  if (!panorama_point(desc_, glm::normalize(local), point)) return false;
  if (panorama_wraps(desc_)) {
    const float middle = 0.5f * (pose.window[0] + pose.window[1]);
    point->x += 2.0f * kPi * std::round((middle - point->x) / (2.0f * kPi));
  }
  return true;
}

Vec2 Camera::film_displacement(const Vec2& from, const Vec2& to) const {
  Vec2 step = to - from;
  if (is_panorama() && panorama_wraps(desc_)) {
    const auto& w = pose(Moment::Now).window;
    const float turn = 2.0f * kPi / (w[1] - w[0]) * float(width_);
    step.x -= turn * std::round(step.x / turn);
  }
  return step;
}

bool Camera::to_film(const Pose& pose, Vec3 local, bool at_infinity, Vec2* film) const {
  const bool orthographic = desc_.type == GRADUS_CAMERA_ORTHOGRAPHIC;
  if (has_eye() && !orthographic && !direction_from_centre(desc_, stereo_axis(pose), local, at_infinity, &local))
    return false;
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

bool Camera::project(const Vec3& world, Moment when, Vec2* film) const {
  const Pose& p = pose(when);
  return to_film(p, p.inverse * (world - p.position), false, film);
}

bool Camera::project_direction(const Vec3& direction, Moment when, Vec2* film) const {
  // An orthographic camera sees only one point at infinity, that along its axis, and it appears at every film position.
  if (desc_.type == GRADUS_CAMERA_ORTHOGRAPHIC) return false;
  const Pose& p = pose(when);
  return to_film(p, p.inverse * direction, true, film);
}

Mat3 Camera::view_rotation() const {
  const Mat3& axes = pose(Moment::Now).axes;
  return glm::transpose(Mat3(glm::normalize(axes[0]), glm::normalize(axes[1]), -glm::normalize(axes[2])));
}

float Camera::depth(const Vec3& world, float time) const {
  Pose storage;
  const Pose& now = pose_at(time, &storage);
  return is_panorama() ? glm::length(world - now.position) : -(now.inverse * (world - now.position)).z;
}

Vec3 Camera::position(float time) const {
  Pose storage;
  return pose_at(time, &storage).position;
}

}  // namespace gradus::camera
