#include "integrator/guide_training.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <tbb/parallel_for.h>

#include "base/clock.h"
#include "base/fpu.h"
#include "path/trace.h"

namespace gradus::integrator {
namespace {

// Random numbers of the training. Seeds of users are below 2³¹.
constexpr uint32_t kSeed = 0xf0677569u;
// The paths are traced in rounds through the same positions on the film. The first half of the rounds is not guided,
// the rest is guided by what they have found. The paths of its two rounds show whether that pays.
constexpr uint32_t kRounds = 4;
// Guided paths are traced if guiding pays for this share of the samples.
constexpr float kMinShare = 0.1f;
// Time of a ray with a guide over that without.
constexpr double kTimeOfGuide = 1.2;
// Number of positions on an edge of a square, to whose mean light noise is relative.
constexpr uint32_t kLevelEdge = 8;
// The mean of the whole film times this is added, so that dark squares do not count for most.
constexpr double kMinLevel = 0.1;
// This share of the positions, where guided paths differ most, does not count. A few fireflies would hide the others.
constexpr double kOutliers = 1.0 / 4096.0;

using Samples = std::vector<guide::TrainingSample>;

// What a path has found: the sum of its contributions, and an estimate of the square of that sum without a guide. With
// contributions c by prefixes of the path whose densities are R times those without a guide, that is the sum over all
// pairs of contributions of c·c' times the R of the shorter prefix. Weights of light sampling are taken as equal.
struct FoundLight {
  double light = 0.0, unguided_square = 0.0;
};

// Records the directions in which a path leaves rough surfaces, and the light that it finds behind them.
class TrainingObserver : public path::NoObserver {
 public:
  explicit TrainingObserver(Samples* samples) : samples_(*samples) {}

  void on_path_start(const path::Sampler&, const camera::CameraSample&) {
    first_ = samples_.size();
    throughputs_.clear();
    found_ = {};
    unguided_light_ = 0.0;
  }
  const FoundLight& found() const { return found_; }

  void on_segment(const path::RaySource& source, const path::PathState& state, const path::Segment& segment,
                  const path::Vertex& end) {
    ratio_ = state.ray.state.guided_ratio;
    if (source.vertex == nullptr || !is_rough(*source.event)) return;
    const Vec3& position = source.vertex->point.position;
    const bool is_surface = segment.end == path::SegmentEnd::Surface;
    samples_.push_back({position, source.vertex->facing_normal(), source.event->sample.wi,
                        is_surface ? glm::length(end.point.position - position) : kInfinity, source.event->sample.pdf,
                        0.0f});
    throughputs_.push_back(state.throughput);
  }
  void on_light_crossing(const path::RaySource&, const path::Contribution& c, const path::LightCrossing&) { add(c); }
  void on_world(const path::RaySource&, const path::Contribution& c) { add(c); }
  void on_emission(const path::RaySource&, const path::Contribution& c, const path::Vertex&) { add(c); }
  void on_light_sample(const path::Vertex&, const path::LightSample&, bsdf::ScatterClass, const path::Contribution& c) {
    add(c);
  }

 private:
  static bool is_rough(const path::ScatterEvent& event) {
    return event.scatter_class == bsdf::ScatterClass::Diffuse && !event.is_exit;
  }

  // Adds a contribution to the light of the path, and to the radiance that arrives at each of its surfaces.
  void add(const path::Contribution& c) {
    const double light = mean_component(c.clamped);
    if (std::isfinite(light)) {
      found_.light += light;
      found_.unguided_square += light * (ratio_ * light + 2.0 * unguided_light_);
      unguided_light_ += ratio_ * light;
    }
    for (size_t i = 0; i < throughputs_.size(); ++i) {
      Rgb radiance(0.0f);
      for (int k = 0; k < 3; ++k)
        if (throughputs_[i][k] > 0.0f) radiance[k] = c.clamped[k] / throughputs_[i][k];
      const float mean = mean_component(radiance);
      if (is_finite(mean)) samples_[first_ + i].radiance += mean;
    }
  }

  Samples& samples_;
  size_t first_ = 0;              // sample of the path's first rough surface
  std::vector<Rgb> throughputs_;  // behind each of them
  FoundLight found_;
  double ratio_ = 1.0;           // density of the directions so far over that without a guide
  double unguided_light_ = 0.0;  // sum of the contributions, each times the ratio at its end
};

// Positions on the film, row by row.
struct Grid {
  uint32_t columns = 0, rows = 0;
  size_t size() const { return size_t(columns) * rows; }
};

Grid grid_of(const GradusSettings& settings, double positions) {
  const double step = std::sqrt(double(settings.width) * settings.height / positions);
  return {std::max(uint32_t(settings.width / step), 1u), std::max(uint32_t(settings.height / step), 1u)};
}

struct Round {
  std::vector<FoundLight> found;  // by each path
  uint64_t rays = 0;
};

// Traces a path through each position, and appends their samples.
Round trace_round(const IntegratorContext& context, const Grid& grid, uint32_t number, const std::atomic<bool>& stop,
                  std::atomic<uint64_t>* cpu, Samples* samples) {
  const path::PathContext path(*context.snapshot, context.camera, context.settings, context.components);
  const Vec2 step(float(context.settings.width) / float(grid.columns),
                  float(context.settings.height) / float(grid.rows));
  Round round;
  round.found.resize(grid.size());
  std::vector<Samples> of_row(grid.rows);
  std::vector<film::Counters> counters(grid.rows);
  tbb::parallel_for(0u, grid.rows, [&](uint32_t y) {
    if (stop.load(std::memory_order_relaxed)) return;
    const FlushDenormals flush;
    const ScopedThreadTimer timer(cpu);
    TrainingObserver observer(&of_row[y]);
    const auto scratch = std::make_unique<path::PathScratch>();
    path::PathTracer<TrainingObserver> tracer(path, scratch.get(), nullptr, &counters[y], &observer);
    for (uint32_t x = 0; x < grid.columns; ++x) {
      path::SampleKey key{kSeed, path::StreamKind::Pilot, y * grid.columns + x};
      const Vec2 jitter = path::Sampler(key).get2(path::dimension::kFilm);
      key.index = number;
      tracer.li(path::Sampler(key), (Vec2(float(x), float(y)) + jitter) * step);
      round.found[size_t(y) * grid.columns + x] = observer.found();
    }
  });
  for (Samples& row : of_row) {
    samples->insert(samples->end(), row.begin(), row.end());
    row = {};
  }
  for (const film::Counters& c : counters) round.rays += c.rays_primary + c.rays_bounce + c.rays_shadow;
  return round;
}

// Returns the squared level of light to which noise is relative, for each position.
std::vector<double> squared_levels(const std::array<Round, kRounds>& rounds, const Grid& grid) {
  const auto edges = [](uint32_t n) { return (n + kLevelEdge - 1) / kLevelEdge; };
  const uint32_t columns = edges(grid.columns);
  std::vector<double> sums(size_t(columns) * edges(grid.rows)), counts(sums.size());
  const auto square_of = [&](size_t i) {
    return i / grid.columns / kLevelEdge * columns + i % grid.columns / kLevelEdge;
  };
  double sum = 0.0;
  for (size_t i = 0; i < grid.size(); ++i) {
    for (const Round& round : rounds) sums[square_of(i)] += round.found[i].light, sum += round.found[i].light;
    counts[square_of(i)] += kRounds;
  }
  const double least = kMinLevel * sum / double(grid.size() * kRounds);
  std::vector<double> levels(grid.size());
  for (size_t i = 0; i < levels.size(); ++i)
    levels[i] = std::pow(sums[square_of(i)] / counts[square_of(i)], 2) + least * least;
  return levels;
}

// Returns the variance of a guided path over that without a guide, both estimated by the paths of two guided rounds.
// The two paths through a position have the same mean, so that they differ by their noise alone.
double noise_ratio(const Round& a, const Round& b, const std::vector<double>& squared_levels) {
  struct Position {
    double guided, unguided;
  };
  std::vector<Position> positions(squared_levels.size());
  for (size_t i = 0; i < positions.size(); ++i) {
    const FoundLight &p = a.found[i], &q = b.found[i];
    const double scale = 1.0 / std::max(squared_levels[i], 1e-60);
    positions[i] = {0.5 * std::pow(p.light - q.light, 2) * scale,
                    (0.5 * (p.unguided_square + q.unguided_square) - p.light * q.light) * scale};
  }
  const auto kept = ptrdiff_t(positions.size()) - ptrdiff_t(kOutliers * double(positions.size()));
  std::nth_element(positions.begin(), positions.begin() + kept - 1, positions.end(),
                   [](const Position& x, const Position& y) { return x.guided < y.guided; });
  Position sum{};
  for (auto p = positions.begin(); p != positions.begin() + kept; ++p)
    sum.guided += p->guided, sum.unguided += p->unguided;
  return sum.unguided > 0.0 ? sum.guided / sum.unguided : 1.0;
}

}  // namespace

GuideTraining train_guide(const IntegratorContext& context, uint32_t paths, const std::atomic<bool>& stop,
                          std::atomic<uint64_t>* cpu) {
  GuideTraining training;
  const Grid grid = grid_of(context.settings, double(paths) / kRounds);
  IntegratorContext guided = context;
  Samples samples;
  std::array<Round, kRounds> rounds;
  for (uint32_t i = 0; i < kRounds; ++i) {
    if (i == kRounds / 2) {
      const ScopedThreadTimer timer(cpu);
      auto field = std::make_shared<const guide::GuidingField>(samples, &stop);
      training.guided_share = field->guided_share();
      if (training.guided_share < kMinShare) return training;
      training.field = std::move(field);
      guided.snapshot = guided_snapshot(*context.snapshot, training.field);
    }
    rounds[i] = trace_round(guided, grid, i, stop, cpu, &samples);
    training.paths += grid.size();
    if (stop.load(std::memory_order_relaxed)) return training;
  }
  const ScopedThreadTimer timer(cpu);
  const std::vector<double> levels = squared_levels(rounds, grid);
  training.noise_ratio = noise_ratio(rounds[2], rounds[3], levels);
  training.time_ratio =
      kTimeOfGuide * double(rounds[2].rays + rounds[3].rays) / double(rounds[0].rays + rounds[1].rays);
  training.pays = training.noise_ratio * training.time_ratio < 1.0;
  if (training.pays) training.field = std::make_shared<const guide::GuidingField>(std::move(samples), &stop);
  return training;
}

std::shared_ptr<const scene::Snapshot> guided_snapshot(const scene::Snapshot& snapshot,
                                                       std::shared_ptr<const guide::GuidingField> field) {
  auto guided = std::make_shared<scene::Snapshot>(snapshot);
  guided->guiding = std::move(field);
  return guided;
}

}  // namespace gradus::integrator
