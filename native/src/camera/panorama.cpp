#include "camera/panorama.h"

#include <algorithm>
#include <cmath>

namespace gradus::camera {

namespace {

// Returns the direction at a longitude (to the right of the view axis) and a latitude (above it).
Vec3 from_latitude(const Vec2& p) {
  const float across = std::cos(p.y);
  return {across * std::sin(p.x), std::sin(p.y), -across * std::cos(p.x)};
}

float longitude(const Vec3& d) { return std::atan2(d.x, -d.z); }
float across(const Vec3& d) { return std::sqrt(d.x * d.x + d.z * d.z); }

// Returns the direction at a longitude and a height on a cylinder of radius 1.
Vec3 from_cylinder(const Vec2& p) { return glm::normalize(Vec3(std::sin(p.x), p.y, -std::cos(p.x))); }

// Returns the direction for two angles, each of which rotates the view axis independently.
Vec3 from_cube_angles(const Vec2& p) { return glm::normalize(Vec3(std::tan(p.x), std::tan(p.y), -1.0f)); }

// Computes the direction that a mirror ball reflects to a distant viewer at its point p, in units of the radius.
bool from_mirror_ball(const Vec2& p, Vec3* d) {
  const float square = 1.0f - glm::dot(p, p);
  if (!(square >= 0.0f)) return false;
  *d = Vec3(2.0f * std::sqrt(square) * p, 1.0f - 2.0f * square);
  return true;
}

bool to_mirror_ball(const Vec3& d, Vec2* p) {
  const float depth = std::sqrt(std::max(0.5f * (1.0f - d.z), 0.0f));
  if (!(depth > 0.0f)) return false;  // The whole rim shows the direction straight behind the ball.
  *p = Vec2(d) / (2.0f * depth);
  return true;
}

// Returns a fisheye's direction at an angle from the view axis, towards p on the film.
Vec3 at_angle(float angle, const Vec2& p) {
  const float r = glm::length(p);
  const Vec2 towards = r > 0.0f ? p / r : Vec2(0.0f, 1.0f);
  return Vec3(towards * std::sin(angle), -std::cos(angle));
}

float angle_of(const Vec3& d) { return std::atan2(glm::length(Vec2(d)), -d.z); }

Vec2 at_radius(float radius, const Vec3& d) {
  const float sine = glm::length(Vec2(d));
  return sine > 0.0f ? Vec2(d) * (radius / sine) : Vec2(0.0f, radius);
}

bool from_equidistant(float fov, const Vec2& p, Vec3* d) {
  const float angle = glm::length(p);
  if (!(angle <= 0.5f * fov)) return false;
  *d = at_angle(angle, p);
  return true;
}

// Computes the direction of p, which is in units of twice the focal length.
bool from_equisolid(float fov, const Vec2& p, Vec3* d) {
  const float r = glm::length(p);
  if (!(r <= std::sin(0.25f * fov))) return false;
  *d = at_angle(2.0f * std::asin(r), p);
  return true;
}

float lens_angle(const float* k, float r) { return -(k[0] + r * (k[1] + r * (k[2] + r * (k[3] + r * k[4])))); }
float lens_slope(const float* k, float r) { return -(k[1] + r * (2.0f * k[2] + r * (3.0f * k[3] + r * 4.0f * k[4]))); }

bool from_lens_polynomial(const float* k, float fov, const Vec2& p, Vec3* d) {
  const float angle = lens_angle(k, glm::length(p));
  if (!(std::fabs(angle) <= 0.5f * fov)) return false;
  *d = at_angle(angle, p);
  return true;
}

// Inverts the lens polynomial by Newton's method, which starts from the radius of a lens without distortion.
bool to_lens_polynomial(const float* k, const Vec3& d, Vec2* p) {
  const float angle = angle_of(d);
  float r = -(angle + k[0]) / k[1];
  for (int i = 0; i < 20; ++i) {
    const float step = (angle - lens_angle(k, r)) / lens_slope(k, r);
    r += step;
    if (!(std::fabs(step) > 1e-6f * std::fabs(r))) break;
  }
  if (!(std::fabs(lens_angle(k, r) - angle) <= 1e-4f)) return false;
  *p = at_radius(r, d);
  return true;
}

}  // namespace

bool panorama_direction(const GradusCamera& camera, const Vec2& p, Vec3* d) {
  switch (camera.panorama) {
    case GRADUS_PANORAMA_EQUIRECTANGULAR:
      *d = from_latitude(p);
      return true;
    case GRADUS_PANORAMA_CUBE_FACE:
      *d = from_cube_angles(p);
      return true;
    case GRADUS_PANORAMA_MIRROR_BALL:
      return from_mirror_ball(p, d);
    case GRADUS_PANORAMA_FISHEYE_EQUIDISTANT:
      return from_equidistant(camera.fisheye_fov, p, d);
    case GRADUS_PANORAMA_FISHEYE_EQUISOLID:
      return from_equisolid(camera.fisheye_fov, p, d);
    case GRADUS_PANORAMA_FISHEYE_POLYNOMIAL:
      return from_lens_polynomial(camera.fisheye_polynomial, camera.fisheye_fov, p, d);
    case GRADUS_PANORAMA_CYLINDER:
      *d = from_cylinder(p);
      return true;
  }
  return false;
}

bool panorama_point(const GradusCamera& camera, const Vec3& d, Vec2* p) {
  switch (camera.panorama) {
    case GRADUS_PANORAMA_EQUIRECTANGULAR:
      *p = Vec2(longitude(d), std::atan2(d.y, across(d)));
      return true;
    case GRADUS_PANORAMA_CUBE_FACE:
      *p = Vec2(std::atan(d.x / -d.z), std::atan(d.y / -d.z));
      return d.z < 0.0f;
    case GRADUS_PANORAMA_MIRROR_BALL:
      return to_mirror_ball(d, p);
    case GRADUS_PANORAMA_FISHEYE_EQUIDISTANT:
      *p = at_radius(angle_of(d), d);
      return true;
    case GRADUS_PANORAMA_FISHEYE_EQUISOLID:
      *p = at_radius(std::sin(0.5f * angle_of(d)), d);
      return true;
    case GRADUS_PANORAMA_FISHEYE_POLYNOMIAL:
      return to_lens_polynomial(camera.fisheye_polynomial, d, p);
    case GRADUS_PANORAMA_CYLINDER:
      *p = Vec2(longitude(d), d.y / across(d));
      return across(d) > 0.0f;
  }
  return false;
}

bool panorama_wraps(const GradusCamera& camera) {
  return camera.panorama == GRADUS_PANORAMA_EQUIRECTANGULAR || camera.panorama == GRADUS_PANORAMA_CYLINDER;
}

// Cycles derives the lens axes from its x axis. This is the view axis, except for mirror balls, whose space is also
// mirrored.
void panorama_lens_axes(const GradusCamera& camera, const Vec3& d, Vec3* u, Vec3* v) {
  const bool ball = camera.panorama == GRADUS_PANORAMA_MIRROR_BALL;
  const Vec3 axis = ball ? Vec3(1, 0, 0) : Vec3(0, 0, -1);
  const Vec3 side = axis - glm::dot(axis, d) * d;
  const float length = glm::length(side);
  *u = length > 1e-6f ? side / length : Vec3(0, 1, 0);
  *v = ball ? glm::cross(*u, d) : glm::cross(d, *u);
}

}  // namespace gradus::camera
