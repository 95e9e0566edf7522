// Plain path tracing: next-event estimation and BSDF sampling, combined by the balance heuristic. Unbiased.
#include "integrator/integrator.h"
#include "integrator/pixel_loop.h"

namespace gradus::integrator {

namespace {

class PathIntegrator final : public Integrator {
 public:
  explicit PathIntegrator(const IntegratorContext& context)
      : context_(context), path_(*context_.snapshot, context_.camera, context_.settings, context_.components) {}

  void sample(const WorkUnit& unit, film::Film* film, film::Counters* counters,
              const std::atomic<bool>& stop) const override {
    const auto scratch = std::make_unique<path::PathScratch>();
    path::PassRecorder recorder(path_, film, counters);
    path::NoObserver observer;
    path::PathTracer<path::NoObserver> tracer(path_, scratch.get(), &recorder, counters, &observer);
    const auto vertices = std::make_unique<path::CameraVertices>(path_);
    for_each_sample(path_, unit, *film, vertices.get(), stop, [&](const PixelSample& s) {
      recorder.begin_sample(s.pixel, s.half, s.number, unit.adds_components);
      tracer.want(unit_components(unit, s.pixel));
      add_primal(tracer.li(s.sampler, s.film, s.first), s, unit, film, counters);
    });
  }

 private:
  IntegratorContext context_;
  path::PathContext path_;
};

}  // namespace

std::unique_ptr<Integrator> make_path_integrator(const IntegratorContext& context) {
  return std::make_unique<PathIntegrator>(context);
}

}  // namespace gradus::integrator
