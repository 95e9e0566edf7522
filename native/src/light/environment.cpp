#include "light/environment.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include <tbb/parallel_for.h>

#include "base/trigonometry.h"
#include "bsdf/warp.h"
#include "light/eighths.h"
#include "light/light_sampling.h"

namespace gradus::light {

namespace {

constexpr uint32_t kMinWidth = 16, kMaxWidth = 4096;
// Blocks of so many cells, in both directions, of wider maps are measured where their maximum is above so many times
// their mean at half the resolution.
constexpr uint32_t kBlock = 8;
constexpr float kContrast = 1.5f;
// Maximum fraction of the samples that go to suns. Points in shadow use only the remaining samples for the sky, but
// most of their noise comes from surfaces in the sun. Measured for a block on a floor, sun at 35°: the variance in the
// shadow is 1.34 at a fraction of 1/2, 0.88 at 3/4, 0.73 at 7/8, 0.70 at 15/16.
constexpr double kMaxSunShare = 0.875;
// A sun whose irradiance is below this fraction of the map's (pi times the mean radiance) is left to the map.
constexpr float kFaintSun = 1e-4f;

// Returns the direction at a position on the map.
Vec3 to_direction(const Vec2& p) {
  const SineCosine longitude = sine_cosine(2.0f * kPi * p.x), colatitude = sine_cosine(kPi * p.y);
  return {colatitude.sine * longitude.cosine, colatitude.sine * longitude.sine, colatitude.cosine};
}

// Returns the position of a direction on the map.
Vec2 to_map(const Vec3& d) {
  const float sine2 = d.x * d.x + d.y * d.y;
  if (!(sine2 > 0.0f)) return {0.0f, d.z > 0.0f ? 0.0f : 1.0f};
  const auto phi = float(angle_of(d.x, d.y)), theta = float(angle_of(d.z, std::sqrt(sine2)));
  return {(phi < 0.0f ? phi + 2.0f * kPi : phi) * (0.5f * kInvPi), theta * kInvPi};
}

// Returns the mean channel of the radiance at a position on the map. Negative and non-finite radiance counts as zero.
float measure_at(const Environment::Radiance& radiance, const Vec2& p) {
  const float value = mean_component(glm::max(radiance(to_direction(p)), Rgb(0.0f)));
  return is_finite(value) ? std::min(value, 1e15f) : 0.0f;
}

// Calls body(row) for each row below `count`. Returns false if cancelled.
template <class Body>
bool for_rows(uint32_t count, const CancelCheck& cancel, const Body& body) {
  std::atomic<bool> stopped{false};
  tbb::parallel_for(0u, count, [&](uint32_t row) {
    if (stopped || cancel())
      stopped = true;
    else
      body(row);
  });
  return !stopped;
}

// Returns the mean channel of the radiance in a cell of a map, at points² positions.
float measure_cell(const Environment::Radiance& radiance, uint32_t x, uint32_t y, uint32_t width, uint32_t points) {
  const float step = 1.0f / float(points);
  float sum = 0.0f;
  for (uint32_t k = 0; k < points * points; ++k) {
    const Vec2 within = step * (Vec2(float(k % points), float(k / points)) + 0.5f);
    sum += measure_at(radiance, (Vec2(float(x), float(y)) + within) / Vec2(float(width), float(width / 2)));
  }
  return step * step * sum;
}

// Writes the radiance of each cell to `out`. Returns false if cancelled.
bool measure(const Environment::Radiance& radiance, uint32_t width, uint32_t points, const CancelCheck& cancel,
             std::vector<float>* out) {
  out->resize(size_t(width) * (width / 2));
  return for_rows(width / 2, cancel, [&](uint32_t y) {
    for (uint32_t x = 0; x < width; ++x) (*out)[size_t(y) * width + x] = measure_cell(radiance, x, y, width, points);
  });
}

// Writes the radiance of each cell of a wide map to `out`: that of a map of half the resolution, and in blocks with
// high contrast, such as those around a sun, that of the cell. Returns false if cancelled.
bool measure_wide(const Environment::Radiance& radiance, uint32_t width, uint32_t points, const CancelCheck& cancel,
                  std::vector<float>* out) {
  const uint32_t height = width / 2, half_width = width / 2;
  std::vector<float> half;
  if (!measure(radiance, half_width, points, cancel, &half)) return false;
  out->resize(size_t(width) * height);
  const auto at_half = [&](uint32_t x, uint32_t y) { return half[size_t(y / 2) * half_width + x / 2]; };
  return for_rows((height + kBlock - 1) / kBlock, cancel, [&](uint32_t row) {
    const uint32_t y0 = row * kBlock, y1 = std::min(y0 + kBlock, height);
    for (uint32_t x0 = 0; x0 < width; x0 += kBlock) {
      const uint32_t x1 = std::min(x0 + kBlock, width);
      float sum = 0.0f, maximum = 0.0f;
      for (uint32_t y = y0; y < y1; ++y)
        for (uint32_t x = x0; x < x1; ++x) {
          sum += at_half(x, y);
          maximum = std::max(maximum, at_half(x, y));
        }
      const bool is_flat = maximum * float((x1 - x0) * (y1 - y0)) <= kContrast * sum;
      for (uint32_t y = y0; y < y1; ++y)
        for (uint32_t x = x0; x < x1; ++x)
          (*out)[size_t(y) * width + x] = is_flat ? at_half(x, y) : measure_cell(radiance, x, y, width, points);
    }
  });
}

// Returns the sine of the colatitude at the centre of a row.
float row_sine(uint32_t y, uint32_t height) { return std::sin(kPi * (float(y) + 0.5f) / float(height)); }

float mean_over_sphere(const std::vector<float>& values, uint32_t width) {
  const uint32_t height = width / 2;
  double sum = 0.0, weight = 0.0;
  for (uint32_t y = 0; y < height; ++y) {
    const float sine = row_sine(y, height);
    for (uint32_t x = 0; x < width; ++x) {
      sum += double(values[size_t(y) * width + x]) * sine;
      weight += sine;
    }
  }
  return float(sum / weight);
}

// Returns the sampling weight of each cell: the maximum of its value and a quarter of its neighbours', because the
// density is constant within a cell while the radiance is interpolated. A small constant is added, so that light that
// the measured positions missed can still be sampled.
std::vector<float> weights(const std::vector<float>& values, uint32_t width, float mean) {
  const uint32_t height = width / 2;
  std::vector<float> out(values.size());
  for (uint32_t y = 0; y < height; ++y) {
    const float sine = row_sine(y, height);
    for (uint32_t x = 0; x < width; ++x) {
      const auto at = [&](uint32_t cx, uint32_t cy) { return values[size_t(cy) * width + cx]; };
      float around = std::max(at((x + 1) % width, y), at((x + width - 1) % width, y));
      if (y > 0) around = std::max(around, at(x, y - 1));
      if (y + 1 < height) around = std::max(around, at(x, y + 1));
      const float here = at(x, y);
      out[size_t(y) * width + x] = (std::max(here, 0.25f * around) + 0.01f * mean) * sine;
    }
  }
  return out;
}

// Maps x in [0, length) to [0, 1).
float stretched(double x, double length) { return std::clamp(float(x / length), 0.0f, 0x1.fffffep-1f); }

// Returns the direction itself, or, if it lies within a sun, a direction just outside that sun.
Vec3 beside_suns(const std::vector<Cone>& suns, const Vec3& direction) {
  for (const Cone& sun : suns) {
    if (!sun.contains(direction)) continue;
    Vec3 x, y;
    orthonormal_basis(sun.axis, &x, &y);
    const Vec3 aside = direction - sun.axis * glm::dot(direction, sun.axis);
    const float length = glm::length(aside);
    const float angle = 1.02f * std::asin(std::min(sun.sine(), 1.0f));
    return std::cos(angle) * sun.axis + std::sin(angle) * (length > 0.0f ? aside / length : x);
  }
  return direction;
}

// Returns the irradiance that a sun adds to the background's on a plane facing the sun (mean channel).
float measure_sun(const Environment::Radiance& radiance, const Cone& sun) {
  constexpr int kSide = 8;
  float sum = 0.0f;
  for (int k = 0; k < kSide * kSide; ++k) {
    const int column = k % kSide, row = k / kSide;
    const Vec3 direction = sun.sample((Vec2(float(column), float(row)) + 0.5f) / float(kSide));
    const float difference = mean_component(glm::max(radiance(direction), Rgb(0.0f)) -
                                            glm::max(radiance(beside_suns({sun}, direction)), Rgb(0.0f)));
    if (is_finite(difference)) sum += std::clamp(difference, 0.0f, 1e15f);
  }
  return sum / float(kSide * kSide) * sun.solid_angle();
}

// Returns whether the receiver receives light in proportion to the cosine at its normal.
bool has_cosine(const Receiver& receiver) { return !receiver.transmits && receiver.normal != Vec3(0.0f); }

// Returns a direction that is uniform on the sphere.
Vec3 sample_sphere(const Vec2& u) {
  const float z = 1.0f - 2.0f * u.x, r = std::sqrt(std::max(0.0f, 1.0f - z * z));
  return {r * std::cos(2.0f * kPi * u.y), r * std::sin(2.0f * kPi * u.y), z};
}

bool is_constant(const std::vector<float>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return *high - *low <= 1e-4f * *high;
}

}  // namespace

Environment Environment::uniform(float mean) {
  Environment world;
  world.mean_ = is_finite(mean) ? std::max(mean, 0.0f) : 0.0f;
  return world;
}

void Environment::build(const Radiance& radiance, const std::vector<Cone>& suns, const Resolution& resolution,
                        const CancelCheck& cancel) {
  *this = Environment();
  std::vector<Cone> cones;
  for (const Cone& cone : suns) {
    const float irradiance = measure_sun(radiance, cone);
    if (irradiance > 0.0f) suns_.push_back({cone, irradiance});
    if (irradiance > 0.0f) cones.push_back(cone);
  }
  const auto without_suns = [&](const Vec3& direction) { return radiance(beside_suns(cones, direction)); };
  const uint32_t width = std::clamp(resolution.width, kMinWidth, kMaxWidth) & ~3u;
  std::vector<float> values;
  const auto measure_map = width > Resolution::kWidestMeasured ? measure_wide : measure;
  if (!measure_map(without_suns, width, std::max(resolution.points, 1u), cancel, &values)) return;
  mean_ = mean_over_sphere(values, width);
  std::erase_if(suns_, [&](const Sun& sun) { return sun.irradiance < kFaintSun * kPi * mean_; });
  if (mean_ > 0.0f && !is_constant(values))
    map_ = std::make_shared<Distribution2D>(width, width / 2, weights(values, width, mean_));
}

float Environment::sun_weight(const Sun& sun, const Receiver& receiver) const {
  return sun.irradiance * sun.cone.highest_cosine(receiver.normal, receiver.transmits);
}

double Environment::share_of_suns(const Receiver& receiver, double* sum) const {
  *sum = 0.0;
  for (const Sun& sun : suns_) *sum += sun_weight(sun, receiver);
  if (!(*sum > 0.0)) return 0.0;
  const double part = std::min(*sum / (*sum + mean_ * kPi), kMaxSunShare);
  return part > 0.5 * kEighth ? in_eighths(part) : part;
}

float Environment::irradiance(const Receiver& receiver) const {
  float sum = std::max(mean_, 0.0f) * kPi;
  for (const Sun& sun : suns_) sum += sun_weight(sun, receiver);
  return sum;
}

Vec3 Environment::sample(const Receiver& receiver, const Vec2& u, Vec2* place) const {
  double sum;
  const double part = share_of_suns(receiver, &sum);
  double x = u.x;
  if (x >= part) return sample_background(receiver, Vec2(stretched(x - part, 1.0 - part), u.y), place);
  // The interval [0, part) is rescaled to the sum of the suns' weights.
  x *= sum / part;
  size_t sun = 0;
  double weight = sun_weight(suns_[0], receiver);
  for (; sun + 1 < suns_.size() && x >= weight; weight = sun_weight(suns_[++sun], receiver)) x -= weight;
  const Vec3 direction = suns_[sun].cone.sample(Vec2(stretched(x, weight), u.y));
  *place = place_of(direction);
  return direction;
}

float Environment::density(const Vec3& direction, const Vec2& place, const Receiver& receiver) const {
  double sum;
  const double part = share_of_suns(receiver, &sum);
  double in_suns = 0.0;
  for (const Sun& sun : suns_)
    if (sun.cone.contains(direction)) in_suns += sun_weight(sun, receiver) / sun.cone.solid_angle();
  return float((1.0 - part) * background_density(direction, place, receiver) +
               (part > 0.0 ? part / sum * in_suns : 0.0));
}

Vec3 Environment::sample_background(const Receiver& receiver, const Vec2& u, Vec2* place) const {
  *place = u;
  if (map_) return to_direction(*place = map_->sample(u));
  return has_cosine(receiver) ? bsdf::sample_cosine_around(receiver.normal, u) : sample_sphere(u);
}

Vec2 Environment::place_of(const Vec3& direction) const { return map_ ? to_map(direction) : Vec2(0.0f); }

float Environment::background_density(const Vec3& direction, const Vec2& place, const Receiver& receiver) const {
  if (black()) return 0.0f;
  if (!map_)
    return has_cosine(receiver) ? std::max(0.0f, glm::dot(direction, receiver.normal)) * kInvPi : 0.25f * kInvPi;
  const float sine = std::sqrt(std::max(0.0f, 1.0f - direction.z * direction.z));
  if (sine <= 0.0f) return 0.0f;
  return map_->density(place) / (2.0f * kPi * kPi * sine);
}

}  // namespace gradus::light
