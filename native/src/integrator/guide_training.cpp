#include "integrator/guide_training.h"

#include <algorithm>
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
// The first part of the paths is not guided; the rest is guided by what the first part has found.
constexpr uint32_t kFirstPart = 3;  // 1 over this of all paths
// Guiding is used if it pays for this share of the samples.
constexpr float kMinShare = 0.1f;

using Samples = std::vector<guide::TrainingSample>;

// Records the directions in which a path leaves rough surfaces, and the light that it finds behind them.
class TrainingObserver : public path::NoObserver {
 public:
  explicit TrainingObserver(Samples* samples) : samples_(*samples) {}

  void on_path_start(const path::Sampler&, const camera::CameraSample&) {
    first_ = samples_.size();
    throughputs_.clear();
  }
  void on_segment(const path::RaySource& source, const path::PathState& state, const path::Segment& segment,
                  const path::Vertex& end) {
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

  // Adds a contribution to the radiance that arrives at each surface of the path.
  void add(const path::Contribution& c) {
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
};

// Traces about `paths` paths over the whole frame, and appends their samples row by row. `part` is that of the
// training.
void trace_part(const IntegratorContext& context, uint32_t paths, uint32_t part, const std::atomic<bool>& stop,
                std::atomic<uint64_t>* cpu, Samples* samples) {
  const path::PathContext path(*context.snapshot, context.camera, context.settings, context.components);
  const auto width = float(context.settings.width), height = float(context.settings.height);
  const float step = std::sqrt(width * height / float(paths));
  const auto columns = std::max(uint32_t(width / step), 1u), rows = std::max(uint32_t(height / step), 1u);
  std::vector<Samples> of_row(rows);
  tbb::parallel_for(0u, rows, [&](uint32_t y) {
    if (stop.load(std::memory_order_relaxed)) return;
    const FlushDenormals flush;
    const ScopedThreadTimer timer(cpu);
    film::Counters counters;
    TrainingObserver observer(&of_row[y]);
    const auto scratch = std::make_unique<path::PathScratch>();
    path::PathTracer<TrainingObserver> tracer(path, scratch.get(), nullptr, &counters, &observer);
    for (uint32_t x = 0; x < columns; ++x) {
      const path::Sampler sampler({kSeed, path::StreamKind::Pilot, y * columns + x, 0, part});
      const Vec2 jitter = sampler.get2(path::dimension::kFilm);
      tracer.li(sampler,
                {(float(x) + jitter.x) / float(columns) * width, (float(y) + jitter.y) / float(rows) * height});
    }
  });
  for (Samples& row : of_row) {
    samples->insert(samples->end(), row.begin(), row.end());
    row = {};
  }
}

}  // namespace

GuideTraining train_guide(const IntegratorContext& context, uint32_t paths, const std::atomic<bool>& stop,
                          std::atomic<uint64_t>* cpu) {
  GuideTraining training;
  IntegratorContext guided = context;
  Samples samples;
  for (uint32_t part = 0; part < 2; ++part) {
    const uint32_t count = part == 0 ? paths / kFirstPart : paths - paths / kFirstPart;
    trace_part(guided, count, part, stop, cpu, &samples);
    training.paths += count;
    if (stop.load(std::memory_order_relaxed)) return training;
    const ScopedThreadTimer timer(cpu);
    auto field = std::make_shared<guide::GuidingField>(part == 0 ? samples : std::move(samples));
    training.guided_share = field->guided_share();
    training.field = training.guided_share < kMinShare ? nullptr : std::move(field);
    if (!training.field) return training;
    guided.snapshot = guided_snapshot(*context.snapshot, training.field);
  }
  return training;
}

std::shared_ptr<const scene::Snapshot> guided_snapshot(const scene::Snapshot& snapshot,
                                                       std::shared_ptr<const guide::GuidingField> field) {
  auto guided = std::make_shared<scene::Snapshot>(snapshot);
  guided->guiding = std::move(field);
  return guided;
}

}  // namespace gradus::integrator
