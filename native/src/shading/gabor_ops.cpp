// The Gabor Texture node: sums of Gabor kernels around random points (Lagae et al., "Procedural Noise using Sparse
// Gabor Convolution", 2009; Tavernier et al., "Making Gabor Noise Fast and Normalized", 2019), as complex numbers
// (Tricard et al., "Procedural Phasor Noise", 2019), with the constants of Blender.
#include <bit>
#include <cmath>

#include "shading/lattice_hash.h"
#include "shading/op_functions.h"
#include "shading/scalar.h"

namespace gradus::shading {
namespace {

// The waves of all kernels. Their direction turns at random by up to `isotropy` of half a turn.
struct GaborWaves {
  float frequency = 1.0f;
  float isotropy = 0.0f;
  float azimuth = 0.0f;
  float inclination = 0.0f;  // from the z axis; in two dimensions it is not used
  Vec3 direction = Vec3(1.0f, 0.0f, 0.0f);
};

// Each cell has eight kernels, one in each lane. Three seeds of each give its direction, its centre and its sign.
static_assert(kLanes == 8);
constexpr FloatLanes kDirectionSeed = kLaneNumber * 3.0f, kCenterSeed = kDirectionSeed + 1.0f,
                     kSignSeed = kDirectionSeed + 2.0f;

// The hashes of a cell in two and in three dimensions.
struct GaborCell2 {
  FloatLanes x, y;
  explicit GaborCell2(const Vec3& cell) : x(FloatLanes{} + cell.x), y(FloatLanes{} + cell.y) {}

  void centers(FloatLanes (&out)[3]) const {
    out[0] = float_hash(x, y, kCenterSeed);
    out[1] = float_hash(kCenterSeed, x, y);
    out[2] = FloatLanes{};
  }
  FloatLanes signs() const { return float_hash(x, y, kSignSeed); }
  Vec3 direction(const GaborWaves& waves, int kernel) const {
    if (waves.isotropy == 0.0f) return waves.direction;
    const float turn = (float_hash(x[0], y[0], kDirectionSeed[kernel]) - 0.5f) * kPi;
    const float azimuth = waves.azimuth + turn * waves.isotropy;
    return Vec3(std::cos(azimuth), std::sin(azimuth), 0.0f);
  }
};
struct GaborCell3 {
  FloatLanes x, y, z;
  explicit GaborCell3(const Vec3& cell)
      : x(FloatLanes{} + cell.x), y(FloatLanes{} + cell.y), z(FloatLanes{} + cell.z) {}

  void centers(FloatLanes (&out)[3]) const {
    out[0] = float_hash(x, y, z, kCenterSeed);
    out[1] = float_hash(z, x, kCenterSeed, y);
    out[2] = float_hash(kCenterSeed, z, y, x);
  }
  FloatLanes signs() const { return float_hash(x, y, z, kSignSeed); }
  Vec3 direction(const GaborWaves& waves, int kernel) const {
    if (waves.isotropy == 0.0f) return waves.direction;
    const float seed = kDirectionSeed[kernel], turn = kPi * waves.isotropy;
    const float inclination = waves.inclination + float_hash(x[0], y[0], z[0], seed) * turn;
    const float azimuth = waves.azimuth + float_hash(z[0], x[0], seed, y[0]) * turn;
    return Vec3(std::sin(inclination) * std::cos(azimuth), std::sin(inclination) * std::sin(azimuth),
                std::cos(inclination));
  }
};

// Returns a Gabor kernel of unit size: a Gauss bell that ends smoothly at the distance 1, times a wave.
Vec2 gabor_kernel(const Vec3& p, const Vec3& direction, float frequency) {
  const float squared = glm::dot(p, p);
  const float window = 0.5f + 0.5f * std::cos(kPi * squared);
  const float envelope = std::exp(-kPi * squared) * window;
  const float angle = 2.0f * kPi * glm::dot(p, direction * frequency);
  return envelope * Vec2(std::cos(angle), std::sin(angle));
}

// Returns the sum of the kernels of a cell. `p` is relative to the cell.
template <class GaborCell>
Vec2 cell_kernels(const GaborCell& cell, const Vec3& p, const GaborWaves& waves) {
  FloatLanes at[3];
  cell.centers(at);
  for (int axis = 0; axis < 3; axis++) at[axis] = p[axis] - at[axis];
  uint32_t reached = mask_of(at[0] * at[0] + at[1] * at[1] + at[2] * at[2] < 1.0f);
  Vec2 sum(0.0f);
  if (reached == 0) return sum;
  const FloatLanes signs = cell.signs();
  for (; reached != 0; reached &= reached - 1) {
    const int k = std::countr_zero(reached);
    const Vec2 wave = gabor_kernel(Vec3(at[0][k], at[1][k], at[2][k]), cell.direction(waves, k), waves.frequency);
    sum += signs[k] < 0.5f ? -wave : wave;
  }
  return sum;
}

Vec2 gabor_noise2(const Vec3& p, const GaborWaves& waves) {
  const Vec3 first = glm::floor(p);
  Vec2 sum(0.0f);
  for (int j = -1; j <= 1; j++)
    for (int i = -1; i <= 1; i++) {
      const Vec3 offset(i, j, 0);
      sum += cell_kernels(GaborCell2(first + offset), p - first - offset, waves);
    }
  return sum;
}

Vec2 gabor_noise3(const Vec3& p, const GaborWaves& waves) {
  const Vec3 first = glm::floor(p);
  Vec2 sum(0.0f);
  for (int k = -1; k <= 1; k++)
    for (int j = -1; j <= 1; j++)
      for (int i = -1; i <= 1; i++) {
        const Vec3 offset(i, j, k);
        sum += cell_kernels(GaborCell3(first + offset), p - first - offset, waves);
      }
  return sum;
}

}  // namespace

void gabor_op(const OpArgs& args, Vec4* out) {
  const bool is_flat = args.mode == 2;
  GaborWaves waves;
  waves.frequency = std::max(args.f(2), 0.001f);
  waves.isotropy = 1.0f - saturate(args.f(3));
  Vec3 p = args.v(0) * args.f(1);
  if (is_flat) {
    p.z = 0.0f;
    waves.azimuth = args.f(4);
    waves.direction = Vec3(std::cos(waves.azimuth), std::sin(waves.azimuth), 0.0f);
  } else {
    waves.direction = safe_normalize(args.v(5));
    waves.inclination = std::acos(std::clamp(waves.direction.z, -1.0f, 1.0f));
    waves.azimuth = std::atan2(waves.direction.y, waves.direction.x);
  }
  const Vec2 sum = is_flat ? gabor_noise2(p, waves) : gabor_noise3(p, waves);
  // Six standard deviations of the sum of eight kernels a cell, half of them negative. The limit of the kernel's
  // squared integral for high frequencies is 1/4, and 1/(4 √2) in three dimensions.
  const float range = 6.0f * std::sqrt(8.0f * 0.5f * (is_flat ? 0.25f : 0.17677670f));
  out[0] = splat(sum.y / range * 0.5f + 0.5f);
  out[1] = splat((std::atan2(sum.y, sum.x) + kPi) / (2.0f * kPi));
  out[2] = splat(glm::length(sum) / range);
}

}  // namespace gradus::shading
