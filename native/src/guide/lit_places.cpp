#include "guide/lit_places.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace gradus::guide {
namespace {

// Steps of expectation maximisation.
constexpr int kSteps = 8;
// Concentration of all lobes at the start, and 1 minus the cosine of the minimum angle between them.
constexpr float kFirstConcentration = 10.0f, kApart = 0.5f / kFirstConcentration;
// Number of observations without a direction that every lobe has, so that few observations make no sharp lobe.
constexpr float kPrior = 0.3f;
constexpr float kWeightPrior = 0.01f;  // weight of each lobe before any observation
// An observation counts as at most the light of the others over this. Rare bright paths would attract all lobes.
constexpr size_t kMinObservations = 64;

// Returns the concentration of a lobe whose directions have this mean cosine (Banerjee et al., "Clustering on the unit
// hypersphere using von Mises-Fisher distributions", 2005, eq. 4.4).
float concentration_of(float mean_cosine) {
  const float r = std::clamp(mean_cosine, 0.0f, 0.9999f);
  return std::clamp(r * (3.0f - r * r) / (1.0f - r * r), DirectionMixture::kMinConcentration,
                    DirectionMixture::kMaxConcentration);
}

// Returns the observations of light with weights that sum to the effective number of observations.
std::vector<Observation> with_counts(std::span<const Observation> all) {
  std::vector<Observation> found;
  double total = 0.0;
  float largest = 0.0f;
  for (const Observation& o : all) {
    if (!(o.weight > 0.0f) || !is_finite(o.weight)) continue;
    found.push_back(o);
    total += o.weight;
    largest = std::max(largest, o.weight);
  }
  const size_t others = std::clamp<size_t>(found.size(), 2, kMinObservations) - 1;
  const auto limit = found.size() > 1 ? static_cast<float>((total - largest) / double(others)) : largest;
  double sum = 0.0, squares = 0.0;
  for (Observation& o : found) {
    o.weight = std::min(o.weight, limit);
    sum += o.weight;
    squares += double(o.weight) * o.weight;
  }
  for (Observation& o : found) o.weight *= static_cast<float>(sum / squares);
  return found;
}

// Sums over the observations, each shared among the lobes.
struct Moments {
  LobeValues x{}, y{}, z{};  // of the directions
  LobeValues count{}, inverse_distance{};
  Vec3 direction(size_t lobe) const { return {get(x, lobe), get(y, lobe), get(z, lobe)}; }
};

Moments moments_of(std::span<const Observation> observations, const DirectionMixture& mixture) {
  Moments m;
  for (const Observation& o : observations) {
    const LobeValues parts = mixture.parts(o.direction);
    const float sum = sum_of(parts);
    if (!(sum > 0.0f)) continue;
    const float scale = o.weight / sum, inverse = 1.0f / o.distance;
    for (size_t r = 0; r < kRegisters; ++r) {
      const FloatLanes share = parts[r] * scale;
      m.x[r] += share * o.direction.x;
      m.y[r] += share * o.direction.y;
      m.z[r] += share * o.direction.z;
      m.count[r] += share;
      m.inverse_distance[r] += share * inverse;
    }
  }
  return m;
}

// Starts lobes in directions that are far from each other and have much light.
void start_lobes(std::span<const Observation> observations, DirectionMixture* mixture) {
  std::vector<float> nearest(observations.size(), -1.0f);  // cosine to the nearest lobe
  size_t next = 0;
  for (size_t i = 0; i < observations.size(); ++i)
    if (observations[i].weight > observations[next].weight) next = i;
  for (size_t lobe = 0; lobe < kLobes; ++lobe) {
    const Vec3 axis = observations[next].direction;
    mixture->set_axis(lobe, axis);
    set(lobe, kFirstConcentration, &mixture->concentration);
    set(lobe, 1.0f, &mixture->weight);
    float best = -1.0f;
    for (size_t i = 0; i < observations.size(); ++i) {
      nearest[i] = std::max(nearest[i], glm::dot(observations[i].direction, axis));
      const float value = std::max(1.0f - nearest[i] - kApart, 0.0f) * observations[i].weight;
      if (value > best) best = value, next = i;
    }
  }
  mixture->finish();
}

}  // namespace

LitPlaces::LitPlaces(const Vec3& centre, std::span<const Observation> all) {
  const std::vector<Observation> observations = with_counts(all);
  if (observations.empty()) {
    for (size_t i = 0; i < kLobes; ++i) place(i, centre + Vec3(0, 0, 1), 0.0f, 1.0f, 1.0f / float(kLobes));
    return;
  }
  DirectionMixture mixture;
  start_lobes(observations, &mixture);
  Moments m;
  for (int step = 0; step < kSteps; ++step) {
    m = moments_of(observations, mixture);
    for (size_t i = 0; i < kLobes; ++i) {
      const float length = glm::length(m.direction(i)), count = get(m.count, i);
      set(i, count + kWeightPrior, &mixture.weight);
      if (!(length > 0.0f)) continue;
      mixture.set_axis(i, m.direction(i) / length);
      set(i, concentration_of(length / (count + kPrior)), &mixture.concentration);
    }
    mixture.finish();
  }
  for (size_t i = 0; i < kLobes; ++i) {
    const float inverse = get(m.inverse_distance, i);
    const float distance = inverse > 0.0f ? get(m.count, i) / inverse : observations[0].distance;
    place(i, centre + distance * mixture.axis(i), get(mixture.concentration, i), distance, get(mixture.weight, i));
  }
}

void LitPlaces::place(size_t lobe, const Vec3& position, float concentration, float distance, float weight) {
  set(lobe, position.x, &x_);
  set(lobe, position.y, &y_);
  set(lobe, position.z, &z_);
  set(lobe, concentration / (distance * distance), &sharpness_);
  set(lobe, weight, &weight_);
}

LobeValues LitPlaces::shares() const {
  const float inverse = 1.0f / sum_of(weight_);
  LobeValues shares;
  for (size_t r = 0; r < kRegisters; ++r) shares[r] = weight_[r] * inverse;
  return shares;
}

void LitPlaces::reweight(const LobeValues& factors) {
  for (size_t r = 0; r < kRegisters; ++r) weight_[r] *= factors[r];
}

void LitPlaces::see_from(const Vec3& p, const Vec3& normal, DirectionMixture* m) const {
  constexpr float kBelow = 0.01f;  // factor of the weight of a lobe far below the surface
  constexpr float kTiny = 1e-15f;
  const FloatLanes zero{};
  for (size_t r = 0; r < kRegisters; ++r) {
    // A place at the point itself lies in the direction of the normal.
    const FloatLanes dx = x_[r] - p.x + normal.x * kTiny, dy = y_[r] - p.y + normal.y * kTiny,
                     dz = z_[r] - p.z + normal.z * kTiny;
    const FloatLanes squared = dx * dx + dy * dy + dz * dz;
    const FloatLanes inverse = 1.0f / square_root(squared);
    m->x[r] = dx * inverse;
    m->y[r] = dy * inverse;
    m->z[r] = dz * inverse;
    const FloatLanes concentration =
        minimum(maximum(sharpness_[r] * squared, zero + DirectionMixture::kMinConcentration),
                zero + DirectionMixture::kMaxConcentration);
    m->concentration[r] = concentration;
    // Roughly the part of the lobe above the surface: its angle is 1/√κ.
    const FloatLanes cosine = m->x[r] * normal.x + m->y[r] * normal.y + m->z[r] * normal.z;
    const FloatLanes above = 0.5f + 0.5f * cosine * square_root(concentration);
    m->weight[r] = weight_[r] * minimum(maximum(above, zero + kBelow), zero + 1.0f);
  }
  m->finish();
}

}  // namespace gradus::guide
