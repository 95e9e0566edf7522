// Gradient-domain path tracing (thesis 5.4): each base path with four offsets. The primal is that of plain path tracing, bit for bit.
// Unbiased, and so are the gradients.
#include "gradient/offset_paths.h"
#include "integrator/integrator.h"
#include "integrator/pixel_loop.h"
#include "shading/closure_tape.h"

namespace gradus {

namespace {

// What one worker needs; large, so kept from sample to sample.
struct Worker {
  Worker(const PathContext& context, Film* film, Counters* counters)
      : recorder(context, film, counters),
        vertices(context),
        offsets(context, counters, &vertices),
        tracer(context, &scratch, &recorder, counters, &offsets),
        plain(context, &plain_scratch, &recorder, counters, &nobody) {
    for (size_t i = 0; i < std::size(tapes); ++i) scratch.vertices[i].shade.tape = &tapes[i];
  }
  PathScratch scratch;
  ClosureTape tapes[3];  // of the base's vertices, which offsets see again
  PassRecorder recorder;
  CameraVertices vertices;
  OffsetPaths offsets;
  PathTracer<OffsetPaths> tracer;
  // Where no gradients are wanted.
  PathScratch plain_scratch;
  NoObserver nobody;
  PathTracer<NoObserver> plain;
};

bool has_gradients(const WorkUnit& unit, size_t pixel) { return unit.gradient_map == nullptr || (*unit.gradient_map)[pixel] != 0; }

// Counts of a pixel's half and its neighbours' (contract 1.5): none outside of the sampled region, so that such pairs are absent.
std::array<PairCount, kOffsets> pair_counts(const WorkUnit& unit, const Film& film, int32_t x, int32_t y, int half) {
  std::array<PairCount, kOffsets> pairs{};
  for (int k = 0; k < kOffsets; ++k) {
    const int32_t nx = x + kOffsetX[k];
    const int32_t ny = y + kOffsetY[k];
    if (film.region.contains(nx, ny) && has_gradients(unit, film.index(nx, ny))) {
      pairs[k].own = static_cast<float>(half_count(unit, film.index(x, y), half));
      pairs[k].other = static_cast<float>(half_count(unit, film.index(nx, ny), half));
    }
  }
  return pairs;
}

// Most paths have found nothing for most components, whose planes are left alone.
void add_gradients(const std::array<Radiance, kOffsets>& gradients, const PixelSample& s, int channels, ComponentPlanes* planes,
                   Counters* counters) {
  for (int k = 0; k < kOffsets; ++k) {
    Radiance gradient = gradients[size_t(k)];
    if (channels < 4) {
      gradient.w = 0.0f;
    }
    if (gradient != Radiance(0.0f)) {
      add_gradient(gradient, &planes->gradient[s.half][k][s.pixel], counters);
    }
  }
}

class GradientIntegrator final : public Integrator {
 public:
  explicit GradientIntegrator(const IntegratorContext& context)
      : context_(context), path_(*context_.snapshot, context_.camera, context_.settings, context_.components) {}

  void sample(const WorkUnit& unit, Film* film, Counters* counters, const std::atomic<bool>& stop) const override {
    const auto worker = std::make_unique<Worker>(path_, film, counters);
    for_each_sample(path_, unit, *film, &worker->vertices, stop, [&](const PixelSample& s) {
      worker->recorder.begin_sample(s.pixel, s.half, s.number, unit.adds_components);
      const uint32_t wanted = unit_components(unit, s.pixel);
      if (!has_gradients(unit, s.pixel)) {
        worker->plain.want(wanted);
        add_primal(worker->plain.trace(s.sampler, s.film, s.first), s, unit, film, counters);
        return;
      }
      const std::array<PairCount, kOffsets> pairs = pair_counts(unit, *film, s.x, s.y, s.half);
      worker->offsets.start(pairs, s, wanted);
      worker->tracer.want(wanted);
      add_primal(worker->tracer.trace(s.sampler, s.film, s.first), s, unit, film, counters);
      worker->offsets.finish();
      for (int c = 0; c < path_.components.count(); ++c) {
        if ((wanted >> c & 1) != 0) add_gradients(worker->offsets.gradient(c), s, film->channels, &film->components[size_t(c)], counters);
      }
      if (unit.adds_components) return;
      for (int k = 0; k < kOffsets; ++k) film->pair_count[s.half][k][s.pixel] += pairs[k].weight();
    });
  }

 private:
  IntegratorContext context_;
  PathContext path_;
};

}  // namespace

std::unique_ptr<Integrator> make_gradient_integrator(const IntegratorContext& context) {
  return std::make_unique<GradientIntegrator>(context);
}

}  // namespace gradus
