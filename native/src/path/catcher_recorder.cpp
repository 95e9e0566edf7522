#include "path/catcher_recorder.h"

#include "film/catcher_channels.h"
#include "film/finite_check.h"
#include "path/trace.h"

namespace gradus::path {

struct CatcherRecorder::Tracers {
  // Continues camera paths in one scene.
  class Continuation {
   public:
    Continuation(const PathContext& context, film::Counters* counters)
        : context_(context), tracer_(context, &scratch_, nullptr, counters, &nobody_) {}

    // Returns the light that the path finds from a hit on. `state` is that on arrival, `wo` the way back.
    Rgb trace(const Sampler& sampler, const PathState& state, const geometry::Hit& hit, const Vec3& wo) {
      Vertex* vertex = &scratch_.vertices[0];
      context_.scene.place(hit, &vertex->point);
      vertex->wo = wo;
      vertex->shade.complete = false;
      const PathResult& result = tracer_.continue_path(sampler, state, vertex, false);
      Rgb sum(0.0f);
      for (int c = 0; c < context_.components.count(); ++c) sum += Rgb(result.radiance[size_t(c)]);
      return sum;
    }

   private:
    const PathContext& context_;
    PathScratch scratch_;
    NoObserver nobody_;
    PathTracer<NoObserver> tracer_;
  };

  Tracers(const PathContext& whole, film::Counters* counters)
      : catchers(*whole.scene.catchers, whole.camera, whole.settings),
        shaded(whole, counters),
        alone(catchers, counters) {}

  PathContext catchers;
  Continuation shaded, alone;
};

CatcherRecorder::CatcherRecorder(const PathContext& context, film::Film* film, film::Counters* counters)
    : context_(context), counters_(counters) {
  if (context.scene.catchers == nullptr) return;
  shaded_ = film->channels.find(film::kCatcherShaded);
  alone_ = film->channels.find(film::kCatcherAlone);
  background_ = film->channels.find(film::kCatcherBackground);
  if (shaded_ == nullptr) return;  // The film is that of a pilot.
  tracers_ = std::make_unique<Tracers>(context, counters);
}

CatcherRecorder::~CatcherRecorder() = default;

void CatcherRecorder::begin_sample(size_t pixel, int half, bool is_recorded) {
  pixel_ = pixel;
  half_ = half;
  is_recorded_ = is_recorded;
}

bool CatcherRecorder::catches(const Vertex& vertex) const {
  return active() && !is_recorded_ && context_.scene.catcher_index[vertex.point.hit.instance] != UINT32_MAX;
}

// Both paths take the same random numbers, so that their quotient has little noise where nothing casts a shadow.
void CatcherRecorder::catcher(const Sampler& sampler, const PathState& state, const Vertex& vertex) {
  const Rgb emission = clamp_contribution(context_, state.throughput * vertex.shade.emission, false);
  geometry::Hit hit = vertex.point.hit;
  const Rgb shaded = emission + tracers_->shaded.trace(sampler, state, hit, vertex.wo);
  hit.instance = context_.scene.catcher_index[hit.instance];
  const Rgb alone = emission + tracers_->alone.trace(sampler, state, hit, vertex.wo);
  add(Vec4(shaded, mean_component(state.throughput)), shaded_);
  add(Vec4(alone, 1.0f), alone_);
  background(clamp_contribution(context_, state.throughput * world_radiance(context_, state.ray, state.depth), false));
}

void CatcherRecorder::background(const Rgb& value) {
  if (active() && !is_recorded_) add(Vec4(value, 0.0f), background_);
}

void CatcherRecorder::add(const Vec4& value, film::Channel* channel) {
  film::add_feature(&value.x, 1.0f, pixel_, half_, channel, counters_);
}

}  // namespace gradus::path
