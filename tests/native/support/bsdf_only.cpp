#include "support/bsdf_only.h"

#include "path/segment.h"

namespace gradus::test {

namespace {

Rgb lights_between(const scene::Snapshot& scene, const Ray& ray) {
  Rgb sum(0.0f);
  std::vector<light::LightHit> hits;
  light::intersect_lights(scene, ray, &hits);
  for (const light::LightHit& hit : hits)
    sum += light::evaluate_light(scene, hit.point, light::Receiver{ray.origin, Vec3(0.0f), true}).radiance;
  return sum;
}

// Samples a direction from all classes; false: absorbed. factor: f·|cos| over its density.
bool scatter(const bsdf::Closures& closures, const Vec3& wo, test::Random* random, Vec3* wi, Rgb* factor,
             std::string* path) {
  float u = random->get();
  for (int k = 0; k < bsdf::kPathEvents; ++k) {
    const auto c = static_cast<bsdf::ScatterClass>(k);
    const float probability = closures.class_probability(c);
    if (u < probability) {
      bsdf::BsdfSample sample;
      const float lobe = random->get();
      if (!closures.sample(c, wo, lobe, random->get2(), &sample) || !(sample.pdf > 0.0f)) return false;
      *wi = sample.wi;
      *path += "DRT"[k];
      *factor = sample.value / (probability * sample.pdf);
      return true;
    }
    u -= probability;
  }
  return false;
}

}  // namespace

void bsdf_only_path(const integrator::IntegratorContext& context, int x, int y, test::Random* random,
                    const FoundLight& found_light) {
  const scene::Snapshot& scene = *context.snapshot;
  const Vec2 film = Vec2(float(x), float(y)) + random->get2();
  const Vec2 lens = random->get2();
  Ray ray = context.camera.ray({film, lens, scene.shutter.sample(random->get())});
  Rgb throughput(1.0f);
  std::string path = "E";
  for (uint32_t scatterings = 0;; ++scatterings) {
    geometry::Hit hit;
    const bool found = scene.intersect(ray, GRADUS_VISIBLE_ALL, &hit);
    if (found) ray.t_max = hit.t;
    found_light(path + "L", throughput * lights_between(scene, ray));
    if (!found)
      return found_light(path + "L", throughput * shading::shade_world(scene, ray.direction, shading::RayState{}));
    const geometry::SurfacePoint point = scene.surface_point(hit);
    shading::ShadeResult shade;
    shading::shade_surface(scene, point, -ray.direction, shading::RayState{}, context.settings.roughness_threshold,
                           &shade);
    found_light(path + "L", throughput * shade.emission);
    Vec3 wi;
    Rgb factor;
    if (scatterings > context.settings.max_bounces ||
        !scatter(shade.closures, -ray.direction, random, &wi, &factor, &path))
      return;
    throughput *= factor;
    ray = path::spawn_ray(point, wi);
  }
}

Rgb bsdf_only_sample(const integrator::IntegratorContext& context, int x, int y, test::Random* random) {
  Rgb radiance(0.0f);
  bsdf_only_path(context, x, y, random, [&](const std::string&, const Rgb& light) { radiance += light; });
  return radiance;
}

}  // namespace gradus::test
