// Gradient-domain path tracing (Kettunen et al. 2015; Manzi 2016, section 5.4). It traces each base path with four
// offset paths. The primal equals that of plain path tracing bit for bit. Primal and gradients are unbiased.
#include "gradient/gradient_integrator.h"

#include "gradient/gradient_observer.h"
#include "integrator/pixel_loop.h"
#include "shading/closure_tape.h"

namespace gradus::gradient {

namespace {

// State of one worker thread. It is large, so the worker keeps it for all samples of its work unit.
struct Worker {
  Worker(const path::PathContext& context, film::Film* film, film::Counters* counters)
      : recorder(context, film, counters),
        vertices(context),
        observer(context, counters, &vertices),
        tracer(context, &scratch, &recorder, counters, &observer),
        plain(context, &plain_scratch, &recorder, counters, &nobody) {
    for (size_t i = 0; i < std::size(tapes); ++i) scratch.vertices[i].shade.tape = &tapes[i];
  }
  path::PathScratch scratch;
  shading::ClosureTape tapes[3];  // of the base's vertices, which are shaded again as seen from the offsets
  path::PassRecorder recorder;
  path::CameraVertices vertices;
  GradientObserver observer;
  path::PathTracer<GradientObserver> tracer;
  // Tracer of pixels without gradients.
  path::PathScratch plain_scratch;
  path::NoObserver nobody;
  path::PathTracer<path::NoObserver> plain;
};

bool has_gradients(const integrator::WorkUnit& unit, size_t pixel) {
  return unit.gradient_map == nullptr || (*unit.gradient_map)[pixel] != 0;
}

// Returns the sample counts of a pixel and of its neighbours in one half-buffer. A neighbour outside the sampled
// region, or without gradients, keeps the count 0, so that its pair is absent.
PairCounts pair_counts(const integrator::WorkUnit& unit, const film::Film& film, int32_t x, int32_t y, int half) {
  PairCounts pairs{};
  for (int k = 0; k < film::kOffsets; ++k) {
    const int32_t nx = x + film::kOffsetX[k];
    const int32_t ny = y + film::kOffsetY[k];
    if (film.region.contains(nx, ny) && has_gradients(unit, film.index(nx, ny))) {
      pairs[k].own = static_cast<float>(integrator::half_count(unit, film.index(x, y), half));
      pairs[k].other = static_cast<float>(integrator::half_count(unit, film.index(nx, ny), half));
    }
  }
  return pairs;
}

// Adds the gradient sample of a path to the planes of one component. Most paths contribute nothing to most components,
// so zero samples are skipped to save memory traffic.
void add_gradients(const std::array<Radiance, film::kOffsets>& gradients, const integrator::PixelSample& s,
                   int channels, film::ComponentPlanes* planes, film::Counters* counters) {
  for (int k = 0; k < film::kOffsets; ++k) {
    Radiance gradient = gradients[size_t(k)];
    if (channels < 4) {
      gradient.w = 0.0f;
    }
    if (gradient != Radiance(0.0f)) {
      film::add_gradient(gradient, &planes->gradient[s.half][k][s.pixel], counters);
    }
  }
}

class GradientIntegrator final : public integrator::Integrator {
 public:
  explicit GradientIntegrator(const integrator::IntegratorContext& context)
      : context_(context), path_(*context_.snapshot, context_.camera, context_.settings, context_.components) {}

  void sample(const integrator::WorkUnit& unit, film::Film* film, film::Counters* counters,
              const std::atomic<bool>& stop) const override {
    const auto worker = std::make_unique<Worker>(path_, film, counters);
    for_each_sample(path_, unit, *film, &worker->vertices, stop, [&](const integrator::PixelSample& s) {
      worker->recorder.begin_sample(s.pixel, s.half, s.number, unit.adds_components);
      const uint32_t wanted = integrator::unit_components(unit, s.pixel);
      if (!has_gradients(unit, s.pixel)) {
        worker->plain.want(wanted);
        integrator::add_primal(worker->plain.li(s.sampler, s.film, s.first), s, unit, film, counters);
        return;
      }
      const PairCounts pairs = pair_counts(unit, *film, s.x, s.y, s.half);
      worker->observer.start(pairs, s, wanted);
      worker->tracer.want(wanted);
      integrator::add_primal(worker->tracer.li(s.sampler, s.film, s.first), s, unit, film, counters);
      worker->observer.finish();
      for (int c = 0; c < path_.components.count(); ++c) {
        if ((wanted >> c & 1) != 0)
          add_gradients(worker->observer.gradient(c), s, film->color_channels, &film->components[size_t(c)], counters);
      }
      if (unit.adds_components) return;
      for (int k = 0; k < film::kOffsets; ++k) film->pair_count[s.half][k][s.pixel] += pairs[k].weight();
    });
  }

 private:
  integrator::IntegratorContext context_;
  path::PathContext path_;
};

}  // namespace

std::unique_ptr<integrator::Integrator> make_gradient_integrator(const integrator::IntegratorContext& context) {
  return std::make_unique<GradientIntegrator>(context);
}

}  // namespace gradus::gradient
