#include "guide/guiding_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <span>

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

namespace gradus::guide {
namespace {

// A cell with more samples than this is divided.
constexpr size_t kMaxSamples = 4096;
// A cell with fewer is not guided.
constexpr size_t kMinSamples = 64;
// Differences of normals count as this share of the cell's diagonal.
constexpr float kNormalScale = 0.75f;
// Maximum distance of a place, in diagonals of the cell: behind that the place has no parallax.
constexpr float kFar = 1e3f;
// A cell is guided if the second moment of its samples becomes smaller than this times that without a guide.
constexpr double kMaxMoment = 0.95;
// Shares of guided directions among which a cell chooses for guided paths.
constexpr std::array<double, 4> kShares = {0.25, 0.5, 0.75, 1.0};
// Densities of the samples below this count as this.
constexpr float kMinPdf = 1e-3f;
// Rounds that balance the weights of lobes, the share of guided directions for which they are balanced, and what is
// added to each relative derivative, so that no lobe vanishes in a round.
constexpr int kRounds = 4;
constexpr double kBalancedShare = 0.5;
constexpr float kBalancePrior = 0.1f;
// The square of a sample's light counts as at most the sum of the others over this, so that no outlier decides alone.
constexpr double kOthers = 63.0;

float coordinate(const Vec3& position, const Vec3& normal, uint32_t axis) {
  return axis < 3 ? position[int(axis)] : normal[int(axis) - 3];
}
float coordinate(const TrainingSample& s, uint32_t axis) { return coordinate(s.position, s.normal, axis); }

using Samples = std::span<const TrainingSample>;

Vec3 mean_of(Samples samples, Vec3 TrainingSample::*member) {
  glm::dvec3 sum(0.0);
  for (const TrainingSample& s : samples) sum += glm::dvec3(s.*member);
  return Vec3(sum / double(samples.size()));
}

struct Bounds {
  Vec3 low = Vec3(kInfinity), high = Vec3(-kInfinity);
  Vec3 size() const { return high - low; }
};
Bounds bounds_of(Samples samples, Vec3 TrainingSample::*member) {
  Bounds b;
  for (const TrainingSample& s : samples) b.low = glm::min(b.low, s.*member), b.high = glm::max(b.high, s.*member);
  return b;
}

// Returns the light of a sample as a point sees it that may be elsewhere in the cell.
Observation observation_of(const TrainingSample& s, const Vec3& centre, float diagonal) {
  const Vec3 towards = s.position + s.direction * std::min(s.distance, kFar * diagonal) - centre;
  const float distance = std::max(glm::length(towards), 1e-3f * diagonal);
  const float cosine = std::max(glm::dot(s.normal, s.direction), 0.0f);
  return {towards / std::max(glm::length(towards), 1e-30f), distance, s.radiance * cosine / std::max(s.pdf, kMinPdf)};
}

// What a Lambert surface reflects of a sample's light.
struct Reflection {
  const TrainingSample* sample;
  double square;  // of the reflected light, over the density with which the direction was sampled
  double pdf;     // density of the direction without a guide
};

// Returns those of the samples that have light.
std::vector<Reflection> reflections_of(Samples samples) {
  std::vector<Reflection> found;
  for (const TrainingSample& s : samples) {
    const double cosine = glm::dot(s.normal, s.direction), light = s.radiance * cosine;
    if (cosine > 0.0 && light > 0.0) found.push_back({&s, light * light / std::max(s.pdf, kMinPdf), cosine * kInvPi});
  }
  return found;
}

// Changes the weights of the lobes towards the least second moment of what surfaces reflect, where kBalancedShare of
// the directions are guided. Fitted to light alone, they would neglect places whose light is rare and bright. The
// moment is a convex function of the weights. Each round multiplies a weight by the square root of the moment's
// derivative, by which the moment falls (Yu, "Monotonic convergence of a general algorithm for computing optimal
// designs", 2010).
void balance(Samples samples, LitPlaces* places) {
  std::vector<Reflection> reflections = reflections_of(samples);
  double sum = 0.0, largest = 0.0;
  for (const Reflection& r : reflections) sum += r.square, largest = std::max(largest, r.square);
  for (Reflection& r : reflections) r.square = std::min(r.square, (sum - largest) / kOthers);
  DirectionMixture mixture;
  for (int round = 0; round < kRounds; ++round) {
    LobeValues derivatives{};  // each times the weight
    for (const Reflection& r : reflections) {
      places->see_from(r.sample->position, r.sample->normal, &mixture);
      const LobeValues parts = mixture.parts(r.sample->direction);
      const double pdf = kBalancedShare * sum_of(parts) + (1.0 - kBalancedShare) * r.pdf;
      const auto scale = static_cast<float>(r.square / (pdf * pdf * sum));
      for (size_t i = 0; i < kRegisters; ++i) derivatives[i] += parts[i] * scale;
    }
    const float total = sum_of(derivatives);
    if (!(total > 0.0f)) return;
    const LobeValues shares = places->shares();
    LobeValues factors;
    for (size_t i = 0; i < kRegisters; ++i)
      factors[i] = square_root(derivatives[i] / (total * shares[i]) + kBalancePrior);
    places->reweight(factors);
  }
}

LitPlaces fit_places(Samples samples) {
  const Vec3 centre = mean_of(samples, &TrainingSample::position);
  const float diagonal = std::max(glm::length(bounds_of(samples, &TrainingSample::position).size()), 1e-6f);
  std::vector<Observation> observations;
  observations.reserve(samples.size());
  for (const TrainingSample& s : samples) observations.push_back(observation_of(s, centre, diagonal));
  LitPlaces places(centre, observations);
  balance(samples, &places);
  return places;
}

// Returns the share of guided directions that has the least second moment of what surfaces reflect, with kUnguidedPaths
// as at the first vertex of a path; 0 if no share reduces it enough. The samples are not those of the fit.
float best_share(const LitPlaces& places, Samples samples) {
  std::array<double, kShares.size()> moments{};
  double plain = 0.0;
  DirectionMixture mixture;
  for (const Reflection& r : reflections_of(samples)) {
    places.see_from(r.sample->position, r.sample->normal, &mixture);
    const double guided_pdf = mixture.pdf(r.sample->direction);
    plain += r.square / r.pdf;
    for (size_t k = 0; k < kShares.size(); ++k) {
      const double share = kShares[k] * (1.0 - kUnguidedPaths);
      moments[k] += r.square / (share * guided_pdf + (1.0 - share) * r.pdf);
    }
  }
  const auto best = std::min_element(moments.begin(), moments.end());
  return *best < kMaxMoment * plain ? float(kShares[size_t(best - moments.begin())]) : 0.0f;
}

// Returns the guide of a cell with these samples, if guiding pays there.
std::optional<Guide> fit_guide(Samples samples) {
  if (samples.size() < kMinSamples) return std::nullopt;
  std::vector<TrainingSample> fitted, tested;
  for (size_t i = 0; i < samples.size(); ++i) (i % 2 == 0 ? fitted : tested).push_back(samples[i]);
  const float share = best_share(fit_places(fitted), tested);
  if (share == 0.0f) return std::nullopt;
  return Guide{fit_places(samples), share};
}

bool is_set(const std::atomic<bool>* stop) { return stop != nullptr && stop->load(std::memory_order_relaxed); }

}  // namespace

// A part of the samples while the tree is built. An inner cell has `split` and `axis` of its node; a leaf has kLeaf.
struct GuidingField::Cell {
  explicit Cell(std::span<TrainingSample> all, const std::atomic<bool>* stop);

  float split = 0.0f;
  uint32_t axis = kLeaf;
  std::span<const TrainingSample> samples;
  std::unique_ptr<const Cell> below, above;
};

// Divides the samples, which it reorders.
GuidingField::Cell::Cell(std::span<TrainingSample> all, const std::atomic<bool>* stop) : samples(all) {
  if (all.size() <= kMaxSamples || is_set(stop)) return;
  const Vec3 size = bounds_of(all, &TrainingSample::position).size();
  const Vec3 normal_size = bounds_of(all, &TrainingSample::normal).size() * (kNormalScale * glm::length(size));
  const std::array<float, 6> extents{size.x, size.y, size.z, normal_size.x, normal_size.y, normal_size.z};
  const auto widest = uint32_t(std::max_element(extents.begin(), extents.end()) - extents.begin());
  split = coordinate(mean_of(all, &TrainingSample::position), mean_of(all, &TrainingSample::normal), widest);
  const auto second = std::stable_partition(all.begin(), all.end(),
                                            [&](const TrainingSample& s) { return coordinate(s, widest) < split; });
  const auto first = size_t(second - all.begin());
  if (first == 0 || first == all.size()) return;
  axis = widest;
  tbb::parallel_invoke([&] { below = std::make_unique<const Cell>(all.first(first), stop); },
                       [&] { above = std::make_unique<const Cell>(all.subspan(first), stop); });
}

GuidingField::GuidingField(std::vector<TrainingSample> samples, const std::atomic<bool>* stop) {
  nodes_.emplace_back();
  std::vector<Leaf> leaves;
  add_node(0, Cell(samples, stop), &leaves);
  std::vector<std::optional<Guide>> guides(leaves.size());
  tbb::parallel_for(size_t{0}, leaves.size(), [&](size_t i) {
    if (!is_set(stop)) guides[i] = fit_guide(leaves[i].samples);
  });
  if (is_set(stop)) return;
  size_t guided = 0;
  for (size_t i = 0; i < leaves.size(); ++i) {
    if (!guides[i]) continue;
    guided += leaves[i].samples.size();
    nodes_[leaves[i].node].index = uint32_t(guides_.size());
    guides_.push_back(*guides[i]);
  }
  guided_share_ = samples.empty() ? 0.0f : float(guided) / float(samples.size());
}

void GuidingField::add_node(uint32_t node, const Cell& cell, std::vector<Leaf>* leaves) {
  nodes_[node] = {cell.split, cell.axis, kNone};
  if (cell.axis == kLeaf) return leaves->push_back({node, cell.samples});
  const auto first = uint32_t(nodes_.size());
  nodes_.resize(nodes_.size() + 2);
  nodes_[node].index = first;
  add_node(first, *cell.below, leaves);
  add_node(first + 1, *cell.above, leaves);
}

const Guide* GuidingField::at(const Vec3& position, const Vec3& normal) const {
  // Without branches, which a processor could not predict.
  const std::array<float, kLeaf> coordinates{position.x, position.y, position.z, normal.x, normal.y, normal.z};
  const Node* node = nodes_.data();
  while (node->axis != kLeaf) node = &nodes_[node->index + uint32_t(!(coordinates[node->axis] < node->split))];
  return node->index == kNone ? nullptr : &guides_[node->index];
}

}  // namespace gradus::guide
