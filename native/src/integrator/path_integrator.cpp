// Plain path tracing: next-event estimation and BSDF sampling, combined by the balance heuristic. Unbiased.
#include <mutex>
#include <optional>

#include "integrator/integrator.h"
#include "integrator/pixel_loop.h"
#include "path/batch.h"
#include "path/emission_edges.h"

namespace gradus::integrator {

namespace {

// Number of paths that are traced together. With 8 a sample takes as long as with 32.
constexpr size_t kBatchSize = 32;

// Memory of the paths of a batch.
using BatchScratch = std::array<path::PathScratch, kBatchSize>;

// Memory for one batch of each thread. It is kept from unit to unit, because initialising it takes as long as some
// samples.
class ScratchPool {
 public:
  std::unique_ptr<BatchScratch> take() {
    const std::lock_guard lock(mutex_);
    if (unused_.empty()) return std::make_unique<BatchScratch>();
    std::unique_ptr<BatchScratch> scratch = std::move(unused_.back());
    unused_.pop_back();
    return scratch;
  }
  void give_back(std::unique_ptr<BatchScratch> scratch) {
    const std::lock_guard lock(mutex_);
    unused_.push_back(std::move(scratch));
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<BatchScratch>> unused_;
};

// A path of a batch.
struct Lane {
  Lane(const path::PathContext& context, path::PathScratch* scratch, film::Film* film, film::Counters* counters)
      : recorder(context, film, counters), tracer(context, scratch, &recorder, counters, &observer) {}

  PixelSample sample;
  path::PassRecorder recorder;
  path::NoObserver observer;
  path::PathTracer<path::NoObserver> tracer;
};

// Samples whose paths are traced together. They are of different pixels, so that sums have one order.
class Batch {
 public:
  Batch(const path::PathContext& context, BatchScratch* scratch, const WorkUnit& unit, film::Film* film,
        film::Counters* counters)
      : context_(context), scratch_(*scratch), unit_(unit), film_(*film), counters_(*counters) {}

  // Starts the path of a sample.
  void add(const PixelSample& s) {
    if (count_ > 0 && s.number != lanes_[0]->sample.number) finish();
    const size_t i = count_++;
    std::optional<Lane>& memory = lanes_[i];
    Lane& lane = memory ? *memory : memory.emplace(context_, &scratch_[i], &film_, &counters_);
    lane.sample = s;
    lane.recorder.begin_sample(s.pixel, s.half, s.number, unit_.adds_components);
    lane.tracer.want(unit_components(unit_, s.pixel));
    const bool is_at_edge = unit_has_edge(unit_, s.pixel);
    if (is_at_edge) path::make_edge_rays(context_, s.x, s.y, s.number, further_);
    lane.tracer.start(s.sampler, s.film, nullptr, {further_.data(), is_at_edge ? further_.size() : 0});
    if (count_ == lanes_.size()) finish();
  }

  // Traces the paths that were started, and adds them to the film in the order of their samples.
  void finish() {
    path::extend_together<kBatchSize>(
        count_, [&](size_t i) -> auto& { return lanes_[i]->tracer; });
    for (size_t i = 0; i < count_; ++i)
      add_primal(lanes_[i]->tracer.result(), lanes_[i]->sample, unit_, &film_, &counters_);
    count_ = 0;
  }

 private:
  const path::PathContext& context_;
  BatchScratch& scratch_;
  const WorkUnit& unit_;
  film::Film& film_;
  film::Counters& counters_;
  std::array<std::optional<Lane>, kBatchSize> lanes_;  // each is made when it is first used
  size_t count_ = 0;
  std::array<path::CameraRay, path::kEdgeRays> further_;
};

class PathIntegrator final : public Integrator {
 public:
  explicit PathIntegrator(const IntegratorContext& context)
      : context_(context), path_(*context_.snapshot, context_.camera, context_.settings, context_.components) {}

  std::vector<uint8_t> find_edges(const Region& region, const std::atomic<bool>& stop) const override {
    return path::find_emission_edges(path_, region, stop);
  }

  void sample(const WorkUnit& unit, film::Film* film, film::Counters* counters,
              const std::atomic<bool>& stop) const override {
    std::unique_ptr<BatchScratch> scratch = scratches_.take();
    const auto batch = std::make_unique<Batch>(path_, scratch.get(), unit, film, counters);
    for_each_sample(path_, unit, *film, nullptr, stop, [&](const PixelSample& s) { batch->add(s); });
    batch->finish();
    scratches_.give_back(std::move(scratch));
  }

 private:
  IntegratorContext context_;
  path::PathContext path_;
  mutable ScratchPool scratches_;
};

}  // namespace

std::unique_ptr<Integrator> make_path_integrator(const IntegratorContext& context) {
  return std::make_unique<PathIntegrator>(context);
}

}  // namespace gradus::integrator
