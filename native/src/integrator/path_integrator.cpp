// Plain path tracing: next-event estimation and BSDF sampling, combined by the balance heuristic. Unbiased.
#include "integrator/integrator.h"
#include "integrator/pixel_loop.h"
#include "path/emission_edges.h"

namespace gradus::integrator {

namespace {

class PathIntegrator final : public Integrator {
 public:
  explicit PathIntegrator(const IntegratorContext& context)
      : context_(context), path_(*context_.snapshot, context_.camera, context_.settings, context_.components) {}

  std::vector<uint8_t> find_edges(const Region& region, const std::atomic<bool>& stop) const override {
    return path::find_emission_edges(path_, region, stop);
  }

  void sample(const WorkUnit& unit, film::Film* film, film::Counters* counters,
              const std::atomic<bool>& stop) const override {
    const auto scratch = std::make_unique<path::PathScratch>();
    path::PassRecorder recorder(path_, film, counters);
    path::NoObserver observer;
    path::PathTracer<path::NoObserver> tracer(path_, scratch.get(), &recorder, counters, &observer);
    const auto vertices = std::make_unique<path::CameraVertices>(path_);
    std::array<path::CameraRay, path::kEdgeRays> further;
    for_each_sample(path_, unit, *film, vertices.get(), stop, [&](const PixelSample& s) {
      recorder.begin_sample(s.pixel, s.half, s.number, unit.adds_components);
      tracer.want(unit_components(unit, s.pixel));
      const bool is_at_edge = unit_has_edge(unit, s.pixel);
      if (is_at_edge) path::make_edge_rays(path_, s.x, s.y, s.number, further);
      const std::span<const path::CameraRay> rays(further.data(), is_at_edge ? further.size() : 0);
      add_primal(tracer.li(s.sampler, s.film, s.first, rays), s, unit, film, counters);
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
