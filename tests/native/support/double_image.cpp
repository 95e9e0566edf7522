#include "support/double_image.h"

#include <algorithm>
#include <cmath>

#include "integrator/pixel_loop.h"
#include "support/path_scene.h"

namespace gradus::test {

namespace {

using DVec3 = glm::dvec3;

// No light of these scenes depends on the kind of ray.
const shading::RayState kAnyRay;

DVec3 to_double(const Vec3& v) { return DVec3(v.x, v.y, v.z); }

// Sums the contributions of a path in double.
class DoubleObserver : public path::NoObserver {
 public:
  explicit DoubleObserver(const path::PathContext& context) : context_(context) {}
  DVec3 radiance = DVec3(0.0);

  void on_path_start(const path::Sampler&, const camera::CameraSample&) {
    radiance = DVec3(0.0);
    throughput_ = DVec3(1.0);
  }
  void on_light_crossing(const path::RaySource&, const path::Contribution& c, const path::LightCrossing& crossing) {
    add(to_double(crossing.weight) * found(c));
  }
  void on_segment_passed(const path::Segment& segment) { throughput_ *= to_double(segment.weight); }
  void on_world(const path::RaySource&, const path::Contribution& c) { add(found(c)); }
  void on_emission(const path::RaySource&, const path::Contribution& c, const path::Vertex&) { add(found(c)); }
  void on_survival(float probability, const path::Vertex&) { throughput_ /= double(probability); }
  void on_light_sample(const path::Vertex& vertex, const path::LightSample& sample, bsdf::ScatterClass scatter_class,
                       const path::Contribution& c) {
    const path::LitClass lit = path::light_class(context_, vertex, scatter_class, sample, kAnyRay);
    add(to_double(lit.value) * to_double(c.light) / (double(c.pdf_light) + double(lit.pdf_bsdf)));
  }
  void on_scattering(const path::Vertex& vertex, const path::VertexSample&, const path::ScatterEvent& event) {
    const double pdf = double(vertex.shade.closures.class_probability(event.scatter_class)) * double(event.sample.pdf);
    throughput_ *= to_double(event.sample.value) / pdf;
  }

 private:
  static DVec3 found(const path::Contribution& c) {
    const double light = c.pdf_light, bsdf = c.pdf_bsdf;
    return to_double(c.light) * (light > 0.0 ? bsdf / (light + bsdf) : 1.0);
  }
  void add(const DVec3& value) { radiance += throughput_ * value; }
  const path::PathContext& context_;
  DVec3 throughput_ = DVec3(1.0);
};

struct Sums {
  DVec3 sum = DVec3(0.0), squares = DVec3(0.0);
};

}  // namespace

double DoubleImage::worst() const {
  double result = 0.0;
  for (size_t i = 0; i < image.size(); ++i) {
    const double difference = std::fabs(image[i] - mean[i]), bound = 0.01 * error[i] + 1e-6 * std::fabs(mean[i]);
    if (difference > 0.0) result = std::max(result, bound > 0.0 ? difference / bound : HUGE_VAL);
  }
  return result;
}

DoubleImage render_in_double(const integrator::IntegratorContext& context, uint32_t samples) {
  const path::PathContext path(*context.snapshot, context.camera, context.settings);
  film::Film film = make_test_film(context.settings, false);
  const auto scratch = std::make_unique<path::PathScratch>();
  path::PassRecorder recorder(path, &film, &film.counters);
  DoubleObserver observer(path);
  path::PathTracer<DoubleObserver> tracer(path, scratch.get(), &recorder, &film.counters, &observer);
  std::vector<Sums> sums(size_t(film.region.area()));
  const integrator::WorkUnit unit{film.region, 0, samples, nullptr};
  const auto vertices = std::make_unique<path::CameraVertices>(path);
  for_each_sample(path, unit, film, vertices.get(), std::atomic<bool>{false}, [&](const integrator::PixelSample& s) {
    const path::PathResult& result = tracer.li(s.sampler, s.film, s.first);
    integrator::add_primal(result, s, unit, &film, &film.counters);
    if (!film::fits(result.radiance[0])) return;
    sums[s.pixel].sum += observer.radiance;
    sums[s.pixel].squares += observer.radiance * observer.radiance;
  });
  DoubleImage result;
  result.image = film::read_images(film, 0).primal;
  for (size_t i = 0; i < result.image.size(); ++i) {
    const double mean = sums[i / 3].sum[int(i % 3)] / samples;
    const double variance = (sums[i / 3].squares[int(i % 3)] / samples - mean * mean) / std::max(1u, samples - 1);
    result.mean.push_back(mean);
    result.error.push_back(std::sqrt(std::max(0.0, variance)));
  }
  return result;
}

}  // namespace gradus::test
