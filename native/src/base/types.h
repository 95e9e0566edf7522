// Value types of all folders: vectors and matrices from GLM, scene-linear RGB colours, rays, moments of time.
#pragma once

#include <cstdint>
#include <limits>

#include <glm/glm.hpp>

namespace gradus {

using Vec2 = glm::vec2;
using Vec3 = glm::vec3;
using Vec4 = glm::vec4;
using Mat3 = glm::mat3;
using Mat4 = glm::mat4;
using Rgb = glm::vec3;

inline constexpr float kInfinity = std::numeric_limits<float>::infinity();
inline constexpr float kMaxFloat = std::numeric_limits<float>::max();
inline constexpr float kPi = 3.14159265358979323846f;
inline constexpr float kInvPi = 1.0f / kPi;

inline float luminance(const Rgb& c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }
inline float max_component(const Rgb& c) { return c.x > c.y ? (c.x > c.z ? c.x : c.z) : (c.y > c.z ? c.y : c.z); }
inline float mean_component(const Rgb& c) { return (c.x + c.y + c.z) * (1.0f / 3.0f); }
inline bool is_black(const Rgb& c) { return c.x == 0.0f && c.y == 0.0f && c.z == 0.0f; }

// Returns whether `x` is neither infinite nor NaN. The expression works with -ffinite-math-only, too.
inline bool is_finite(float x) { return x - x == 0.0f; }
inline bool is_finite(const Vec3& v) { return is_finite(v.x) && is_finite(v.y) && is_finite(v.z); }

// A ray segment. The direction has unit length. All fields are finite, but t_max may be infinite.
struct Ray {
  Vec3 origin;
  float t_min = 0.0f;
  Vec3 direction;
  float t_max = kInfinity;
  float time = 0.0f;  // time of the shutter: 0 at its opening, 1 at its closing
};

// The value that stands for "no ray"; is_none() recognises it.
constexpr Ray kNoRay{Vec3(0.0f), 1.0f, Vec3(0.0f), 0.0f};
inline bool is_none(const Ray& ray) { return ray.direction == Vec3(0.0f); }

// A frame of an animation relative to the rendered frame: the frame itself, the one before or the one after it.
enum class Moment { Now, Previous, Next };

}  // namespace gradus
