#include "path/pass_recorder.h"

#include <algorithm>
#include <cmath>

#include "film/finite_check.h"
#include "geometry/surface_values.h"
#include "path/light.h"
#include "schema/pass_table.h"
#include "shading/material.h"

namespace gradus::path {

namespace {

PassShare full_share(bsdf::LightPass pass) {
  PassShare share{Rgb(0.0f), Rgb(0.0f), Rgb(0.0f)};
  share[static_cast<int>(pass)] = Rgb(1.0f);
  return share;
}

// Returns the share of each light pass in their sum. A channel without light goes to the first pass.
PassShare share_of(const std::array<Rgb, 3>& passes) {
  const Rgb sum = passes[0] + passes[1] + passes[2];
  PassShare share;
  for (int pass = 0; pass < 3; ++pass) {
    for (int c = 0; c < 3; ++c) {
      share[pass][c] = sum[c] != 0.0f ? passes[pass][c] / sum[c] : (pass == 0 ? 1.0f : 0.0f);
    }
  }
  return share;
}

constexpr uint32_t first_pass(int light_pass) {
  return GRADUS_PASS_DIFFUSE_DIRECT + 3u * static_cast<uint32_t>(light_pass);
}

// Returns (u, v, 1) for Blender's UV pass, or 0 without a UV map.
Vec3 uv_of(const geometry::InstanceData& instance, const geometry::Hit& hit) {
  const geometry::MeshAttribute* map = geometry::default_uv_map(*instance.mesh);
  if (map == nullptr) {
    return Vec3(0.0f);
  }
  const Vec4 uv = geometry::attribute_at(instance, *map, hit);
  return Vec3(uv.x, uv.y, 1.0f);
}

// Returns 1 / depth, bounded for a depth of 0.
float inverse_depth(float depth) { return 1.0f / std::max(depth, 1e-10f); }

// Passes that show one surface of a pixel, whatever the weight of its light: those of which a pixel keeps the first
// sample, and all.
constexpr std::array<uint32_t, 4> kFirstSurfaceData = {GRADUS_PASS_DEPTH, GRADUS_PASS_POSITION,
                                                       GRADUS_PASS_OBJECT_INDEX, GRADUS_PASS_MATERIAL_INDEX};
constexpr std::array<uint32_t, 7> kSurfaceData = {
    GRADUS_PASS_DEPTH,  GRADUS_PASS_POSITION, GRADUS_PASS_OBJECT_INDEX, GRADUS_PASS_MATERIAL_INDEX,
    GRADUS_PASS_NORMAL, GRADUS_PASS_UV,       GRADUS_PASS_VECTOR};

constexpr std::array<uint32_t, 3> kFeaturePasses = {GRADUS_PASS_DENOISING_ALBEDO, GRADUS_PASS_DENOISING_NORMAL,
                                                    GRADUS_PASS_DENOISING_DEPTH};

Vec3 shown_normal(const Vertex& vertex) {
  if (!vertex.shade.closures.empty()) {
    return vertex.shade.closures.average_normal();
  }
  const Vec3 n = vertex.point.shading_normal;
  return glm::dot(n, vertex.wo) < 0.0f ? -n : n;
}

}  // namespace

PassRecorder::PassRecorder(const PathContext& context, film::Film* film, film::Counters* counters)
    : context_(context),
      counters_(counters),
      channels_(context, film, counters),
      catchers_(context, film, counters),
      active_(channels_.active() || catchers_.active()) {
  for (film::Channel& plane : film->channels) {
    // Integrators fill other channels, and pixel loops count the samples with replaced nodes.
    if (plane.pass == GRADUS_PASS_COUNT || plane.pass == GRADUS_PASS_FALLBACK) continue;
    planes_[plane.pass] = &plane;
    active_ = true;
    has_light_passes_ |= plane.pass >= GRADUS_PASS_EMISSION && plane.pass <= GRADUS_PASS_TRANSMISSION_COLOR;
    const bool is_feature = schema::pass_info(plane.pass).kind == schema::PassKind::Feature;
    has_features_ |= is_feature;
    has_surface_data_ |= std::ranges::find(kSurfaceData, plane.pass) != kSurfaceData.end();
  }
  visits_surfaces_ = has_surface_data_ || channels_.visits_surfaces() || plane(GRADUS_PASS_MIST) != nullptr ||
                     plane(GRADUS_PASS_AMBIENT_OCCLUSION) != nullptr;
  records_non_specular_ = !film->components[0].non_specular[0].empty();
  records_details_ = !film->components[0].details.empty();
  if (records_non_specular_ || records_details_) {
    components_ = &film->components;
    active_ = true;
  }
}

void PassRecorder::begin_sample(size_t pixel, int half, uint32_t number, bool adds_components) {
  pixel_ = pixel;
  half_ = half;
  number_ = number;
  first_sample_ = number == context_.settings.first_sample;
  surface_data_done_ = false;
  adds_components_ = adds_components;
  begin_camera_ray(false);
  feature_share_ = 1.0f;
  channels_.begin_sample(pixel, half);
  catchers_.begin_sample(pixel, half, adds_components);
  if (!adds_components) add(GRADUS_PASS_MIST, 1.0f);
}

void PassRecorder::begin_camera_ray(bool is_further) {
  is_further_ray_ = is_further;
  features_done_ = !has_features_ || adds_components_;
  seeks_non_specular_ = components_ != nullptr && !adds_components_ && !is_further;
  detail_components_ = vertex_components_ = 0;
  path_length_ = 0.0f;
  albedo_ = Rgb(0.0f);
}

void PassRecorder::begin_further_ray() { begin_camera_ray(true); }

void PassRecorder::begin_path(float feature_share) {
  begin_camera_ray(false);
  feature_share_ = feature_share;
  for (const uint32_t pass : kFeaturePasses) {
    if (feature_share < 1.0f) add(pass, feature_share * further_features_[pass]);
    further_features_[pass] = Vec3(0.0f);
  }
}

void PassRecorder::add_feature(uint32_t pass, const Vec3& value) {
  if (is_further_ray_) {
    further_features_[pass] += value;
  } else {
    add(pass, feature_share_ * value);
  }
}

void PassRecorder::hole(const Sampler& sampler, const PathState& state, const Vertex& vertex, const Segment& segment) {
  if (!catchers_.catches(vertex)) return;
  surface(state, vertex, segment);
  catchers_.catcher(sampler, state, vertex);
}

void PassRecorder::add(uint32_t pass, const Vec4& value) {
  film::Channel* target = plane(pass);
  if (target != nullptr && (first_sample_ || !target->keeps_first_sample())) {
    film::add_feature(&value.x, 1.0f, pixel_, half_, target, counters_);
  }
}

void PassRecorder::add_light(int scatterings, const Rgb& value, const PassShare& share, uint32_t direct_pass) {
  if (!has_light_passes_) {
    return;
  }
  if (scatterings == 0) {
    add(direct_pass, value);
    return;
  }
  for (int pass = 0; pass < 3; ++pass) {
    add(first_pass(pass) + (scatterings > 1 ? 1u : 0u), value * share[pass]);
  }
}

void PassRecorder::emission(int scatterings, const light::LightPoint& point, const Rgb& value) {
  if (channels_.has_groups()) channels_.light(light::light_group_of(context_.scene, point), value);
  add_light(scatterings, value, share_, GRADUS_PASS_EMISSION);
}

void PassRecorder::emission(int scatterings, const Vertex& vertex, const Rgb& value) {
  if (channels_.has_groups()) channels_.light(context_.scene.instances[vertex.point.hit.instance].light_group, value);
  add_light(scatterings, value, share_, GRADUS_PASS_EMISSION);
}

void PassRecorder::environment(int scatterings, const Rgb& value) {
  if (channels_.has_groups()) channels_.light(context_.scene.world.light_group, value);
  if (scatterings == 0) catchers_.background(value);
  add_light(scatterings, value, share_, GRADUS_PASS_ENVIRONMENT);
}

void PassRecorder::film_background(const Rgb& throughput, const Rgb& light, const Rgb& value) {
  if (!features_done_) add_albedo(throughput * light);
  environment(0, value);
}

void PassRecorder::light(const PathState& state, const Vertex& vertex, bsdf::ScatterClass c, const LightSample& light,
                         const Rgb& value) {
  if (channels_.has_groups()) channels_.light(light::light_group_of(context_.scene, light.point), value);
  if (!has_light_passes_) {
    return;
  }
  const bool first = state.depth == 0;
  add_light(state.depth + 1, value,
            first ? share_of(light_by_pass(context_, vertex, c, light, state.ray.state)) : share_,
            GRADUS_PASS_EMISSION);
}

void PassRecorder::scattered(int depth, const Vertex& vertex, const ScatterEvent& event) {
  seeks_non_specular_ = seeks_non_specular_ && event.scatter_class != bsdf::ScatterClass::Diffuse;
  detail_components_ = vertex_components_ = 0;
  if (depth > 0 || !has_light_passes_) {
    return;
  }
  const bsdf::Closures& closures = vertex.shade.closures;
  if (event.sample.dirac) {
    share_ = full_share(closures.light_pass(event.sample.lobe, event.sample.transmitted));
    return;
  }
  std::array<Rgb, 3> passes =
      closures.evaluate_by_pass(event.scatter_class, vertex.wo, event.sample.wi, event.sample.transmitted);
  for (int pass = 0; pass < 3 && event.by_kind; ++pass) {
    if ((static_cast<bsdf::LightPass>(pass) == bsdf::LightPass::Diffuse) != event.sample.diffuse)
      passes[pass] = Rgb(0.0f);
  }
  share_ = share_of(passes);
}

void PassRecorder::surface(const PathState& state, const Vertex& vertex, const Segment& segment) {
  path_length_ += segment.length;
  if (has_light_passes_ && records_data(state) && shows_data(context_, vertex, state.ray.state)) {
    colors(state.throughput, vertex);
  }
  if (!features_done_) {
    features(state, vertex);
  }
  if (seeks_non_specular_) {
    if (records_non_specular_) non_specular_vertex(state, vertex);
    if (records_details_) details(state, vertex);
  }
}

void PassRecorder::escaped(const PathState& state) {
  if (!state.shows_background() || adds_components_ || is_further_ray_) {
    return;
  }
  channels_.escaped(state.ray);
  if (surface_data_done_) {
    return;
  }
  for (const uint32_t pass : kFirstSurfaceData) add(pass, Vec4(0.0f));
  if (plane(GRADUS_PASS_VECTOR) != nullptr && context_.settings.background_motion != 0) {
    background_motion(state.ray.ray.direction);
  }
}

SurfaceVisitor* PassRecorder::follow(const PathState& state) {
  if (!visits_surfaces_ || !records_data(state)) return nullptr;
  throughput_ = state.throughput;
  is_camera_segment_ = state.depth == 0;
  return this;
}

void PassRecorder::visit(const Sampler& sampler, const Vertex& vertex, const shading::RayState& ray,
                         const Rgb& weight) {
  const Rgb arriving = throughput_ * weight;
  channels_.visit(vertex, ray, arriving);
  if (!shows_data(context_, vertex, ray)) return;
  if (has_surface_data_ && !surface_data_done_) surface_data(vertex);
  const Rgb opaque = arriving * vertex.shade.opacity();
  if (is_camera_segment_ && plane(GRADUS_PASS_AMBIENT_OCCLUSION) != nullptr) {
    ambient_occlusion(sampler, opaque, vertex, ray.transparent_depth);
  }
  mist(opaque, vertex.point.position, vertex.point.hit.time);
}

void PassRecorder::surface_data(const Vertex& vertex) {
  const geometry::InstanceData& instance = context_.scene.instances[vertex.point.hit.instance];
  add(GRADUS_PASS_DEPTH, context_.camera.depth(vertex.point.position, vertex.point.hit.time));
  add(GRADUS_PASS_POSITION, vertex.point.position + context_.scene.origin);
  add(GRADUS_PASS_OBJECT_INDEX, static_cast<float>(instance.pass_index));
  add(GRADUS_PASS_MATERIAL_INDEX, static_cast<float>(context_.scene.materials[vertex.point.material]->pass_index));
  surface_data_done_ = 1.0f - vertex.shade.passed() >= context_.settings.alpha_threshold;
  if (!surface_data_done_) {
    return;
  }
  add(GRADUS_PASS_NORMAL, shown_normal(vertex));
  if (plane(GRADUS_PASS_UV) != nullptr) {
    add(GRADUS_PASS_UV, uv_of(instance, vertex.point.hit));
  }
  if (plane(GRADUS_PASS_VECTOR) != nullptr) {
    motion(vertex);
  }
}

void PassRecorder::colors(const Rgb& weight, const Vertex& vertex) {
  for (int pass = 0; pass < 3 && has_light_passes_; ++pass) {
    if (plane(first_pass(pass) + 2) != nullptr) {
      add(first_pass(pass) + 2, weight * vertex.shade.closures.albedo(static_cast<bsdf::LightPass>(pass), vertex.wo));
    }
  }
}

void PassRecorder::ambient_occlusion(const Sampler& sampler, const Rgb& weight, const Vertex& vertex,
                                     uint32_t crossed) {
  // Surfaces on a segment take the blocks of later vertices, which record no occlusion, so that their noise differs.
  const Vec2 u = sampler.get2(dimension::kFirstVertex + crossed * dimension::kPerVertex + dimension::kOcclusion);
  const Vec3 n = shown_normal(vertex);
  const Vec3 t = glm::normalize(std::fabs(n.x) > 0.5f ? glm::cross(n, Vec3(0, 1, 0)) : glm::cross(n, Vec3(1, 0, 0)));
  const float radius = std::sqrt(u.x);
  const float angle = 2.0f * kPi * u.y;
  const Vec3 direction = glm::normalize(t * (radius * std::cos(angle)) + glm::cross(n, t) * (radius * std::sin(angle)) +
                                        n * std::sqrt(std::max(0.0f, 1.0f - u.x)));
  if (!(glm::dot(direction, vertex.facing_normal()) > 0.0f)) {
    return;
  }
  const float limit = context_.scene.world.ao_distance;
  const Ray ray = spawn_ray(vertex.point, direction, limit > 0.0f ? limit : kInfinity);
  ++counters_->rays_shadow;
  add(GRADUS_PASS_AMBIENT_OCCLUSION, weight * shadow_transmittance(context_, ray, crossed));
}

void PassRecorder::mist(const Rgb& weight, const Vec3& position, float time) {
  if (plane(GRADUS_PASS_MIST) == nullptr) {
    return;
  }
  const GradusWorld& world = context_.scene.world;
  const bool orthographic = context_.scene.camera.type == GRADUS_CAMERA_ORTHOGRAPHIC;
  const float distance = orthographic ? std::fabs(context_.camera.depth(position, time))
                                      : glm::length(position - context_.camera.position(time));
  const float range = std::max(world.mist_depth, 1e-6f);
  float value = std::clamp((distance - world.mist_start) / range, 0.0f, 1.0f);
  if (world.mist_falloff == GRADUS_MIST_QUADRATIC) {
    value *= value;
  } else if (world.mist_falloff == GRADUS_MIST_INVERSE_QUADRATIC) {
    value = std::sqrt(value);
  }
  add(GRADUS_PASS_MIST, mean_component(weight) * (value - 1.0f));
}

template <class Project>
void PassRecorder::add_motion(const Project& project) {
  Vec2 now, previous, next;
  if (project(Moment::Now, &now) && project(Moment::Previous, &previous) && project(Moment::Next, &next)) {
    add(GRADUS_PASS_VECTOR,
        Vec4(context_.camera.film_displacement(now, previous), context_.camera.film_displacement(next, now)));
  }
}

void PassRecorder::motion(const Vertex& vertex) {
  add_motion([&](Moment moment, Vec2* film) {
    return context_.camera.project(context_.scene.position_at(vertex.point.hit, moment), moment, film);
  });
}

void PassRecorder::background_motion(const Vec3& direction) {
  // All pixels of an orthographic camera see the sky in the same direction, so that it does not move on the film.
  if (context_.scene.camera.type == GRADUS_CAMERA_ORTHOGRAPHIC) return add(GRADUS_PASS_VECTOR, Vec4(0.0f));
  add_motion([&](Moment moment, Vec2* film) { return context_.camera.project_direction(direction, moment, film); });
}

// Records the denoising features of the first vertex that is not mostly a mirror or clear glass, as in Cycles. Emission
// counts as albedo, because lights and the sky have no closures and would be black.
void PassRecorder::features(const PathState& state, const Vertex& vertex) {
  const bsdf::Closures& closures = vertex.shade.closures;
  add_albedo(state.throughput * vertex.shade.emission);
  const bool mirror = !closures.empty() && closures.non_specular_probability() <= bsdf::kMaxNonSpecular;
  if (mirror && !state.emission_only) {
    return;
  }
  features_done_ = true;
  if (plane(GRADUS_PASS_DENOISING_ALBEDO) != nullptr) {
    add_albedo(state.throughput * closures.albedo(vertex.wo));
  }
  add_feature(GRADUS_PASS_DENOISING_NORMAL, shown_normal(vertex));
  add_feature(GRADUS_PASS_DENOISING_DEPTH, Vec3(path_length_, 0.0f, 0.0f));
}

// Returns the components, as bits, of paths whose first non-specular vertex this is: those that scatter here in class
// D.
uint32_t PassRecorder::components_of_non_specular(const PathState& state, const Vertex& vertex) const {
  if (!(vertex.shade.closures.non_specular_probability() > 0.0f)) {
    return 0;
  }
  return context_.components.ahead(context_.components.next(state.lpe_state, bsdf::ScatterClass::Diffuse));
}

void PassRecorder::non_specular_vertex(const PathState& state, const Vertex& vertex) {
  const uint32_t ahead = components_of_non_specular(state, vertex);
  if (ahead == 0) {
    return;
  }
  record(ahead, film::NonSpecularVertices{vertex.shade.closures.albedo(vertex.wo), shown_normal(vertex),
                                          inverse_depth(path_length_), 1.0f});
}

// Records details of a vertex that is non-specular or emits.
void PassRecorder::details(const PathState& state, const Vertex& vertex) {
  uint32_t components = components_of_non_specular(state, vertex);
  if (!is_black(vertex.shade.emission)) components |= uint32_t{1} << context_.components.component(state.lpe_state);
  if (components == 0) {
    return;
  }
  const geometry::Hit& hit = vertex.point.hit;
  const geometry::InstanceData& instance = context_.scene.instances[hit.instance];
  const auto object = static_cast<float>(instance.pass_index),
             face = static_cast<float>(instance.mesh->face(hit.primitive));
  record(components, {uv_of(instance, hit), vertex.shade.emission, 0.0f, object, face, number_});
}

// Adds details to components. A segment counts once, even if it shows several lights and the surface behind them.
void PassRecorder::record(uint32_t components, const film::NonSpecularDetails& here) {
  for (size_t c = 0; c < components_->size(); ++c) {
    if ((components >> c & 1) == 0) continue;
    film::NonSpecularDetails once = here;
    once.segments = (detail_components_ >> c & 1) == 0 ? 1.0f : 0.0f;
    film::add_details(once, &(*components_)[c].details[pixel_], counters_);
  }
  detail_components_ |= components;
}

// Adds a vertex to components. A segment counts once, with the depth of the first emitter or surface on it, and the sum
// of the reflectances is limited to 1.
void PassRecorder::record(uint32_t components, const film::NonSpecularVertices& here) {
  for (size_t c = 0; c < components_->size(); ++c) {
    if ((components >> c & 1) == 0) continue;
    const bool is_first = (vertex_components_ >> c & 1) == 0;
    const Rgb before = is_first ? Rgb(0.0f) : recorded_reflectance_[c];
    recorded_reflectance_[c] = glm::clamp(before + here.reflectance, Rgb(0.0f), Rgb(1.0f));
    film::NonSpecularVertices once = here;
    once.reflectance = recorded_reflectance_[c] - before;
    if (!is_first) once.inverse_depth = once.samples = 0.0f;
    film::add_non_specular(once, &(*components_)[c].non_specular[half_][pixel_], counters_);
  }
  vertex_components_ |= components;
}

void PassRecorder::record_emission(int component, const Rgb& light, float further) {
  if (!seeks_non_specular_ || !records_non_specular_ || is_black(light)) {
    return;
  }
  record(uint32_t{1} << component,
         film::NonSpecularVertices{light, Vec3(0.0f), inverse_depth(path_length_ + further), 1.0f});
}

// Adds to the denoising albedo. The sum of a sample stays in [0, 1], as denoisers expect.
void PassRecorder::add_albedo(const Rgb& value) {
  const Rgb sum = glm::clamp(albedo_ + value, Rgb(0.0f), Rgb(1.0f));
  add_feature(GRADUS_PASS_DENOISING_ALBEDO, sum - albedo_);
  albedo_ = sum;
}

}  // namespace gradus::path
