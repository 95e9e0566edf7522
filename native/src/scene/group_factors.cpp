#include "scene/group_factors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "base/parallel_each.h"
#include "base/random_bits.h"
#include "bsdf/warp.h"
#include "camera/camera.h"
#include "geometry/surface.h"
#include "light/light_sampling.h"
#include "scene/snapshot.h"
#include "shading/lattice_hash.h"
#include "shading/material.h"
#include "shading/shade.h"

namespace gradus::scene {

namespace {

// The camera sees a point in each cell of a grid over the picture.
constexpr int kColumns = 24, kRows = 14;
constexpr uint32_t kPixels = uint32_t(kColumns * kRows);
// Light samples of each group at a point. Those of the first half and of the second are independent.
constexpr uint32_t kSamples = 4;
constexpr uint32_t kMaxTransparent = 8;
// BSDF samples at a point that the camera sees.
constexpr uint32_t kBounces = 2;
// Share of the light that a surface reflects, that of further bounces included.
constexpr double kAlbedo = 0.7;
// Share of the mean brightness of the picture that is added to the brightness of each pixel.
constexpr double kAmbient = 0.2;
// CPU time of light samples over that of the rest of a path, measured on a figure under a grey sky.
constexpr double kTimeOfSamples = 0.5;
// Relative variance of what is not measured: edges in a pixel and further bounces.
constexpr double kOtherVariance = 1e-3;
// Factors are 1 unless others have less than this share of the cost: where factors change from frame to frame, samples
// that replay another frame choose other lights.
constexpr double kWorthwhile = 0.95;

// Returns independent random numbers in [0, 1) for each index.
std::array<float, 3> random_numbers(uint32_t index) {
  const auto number = [index](uint32_t i) { return to_unit(shading::lattice_hash(index, i)); };
  return {number(0), number(1), number(2)};
}

// A light sample of a group: the light that a white diffuse surface reflects, its density among the samples of its
// group, and that of BSDF sampling, which is 0 if no ray can find it.
struct Sample {
  double light = 0.0, density = 0.0, by_bsdf = 0.0;
};

// A point of a surface and its light samples.
struct MeasuredPoint {
  geometry::SurfacePoint point;
  light::Receiver receiver;
  light::GroupIrradiance irradiance;
  std::array<std::array<Sample, kSamples>, 3> samples;  // of the tree, the suns and the world
  // Light that BSDF samples find reflected on other surfaces; 0 where the point is on one of these.
  std::array<double, kBounces> reflected{};
  double diffuse_share = 1.0;  // probability with which BSDF sampling scatters diffusely
  size_t pixel = 0;
  double weight = 0.0;
};

std::array<double, 3> as_array(const light::GroupChoice& choice) { return {choice.tree, choice.suns, choice.world}; }

// Lets the ray pass surfaces that are more transparent than not. Returns whether it then hits another one.
bool find_hit(const Snapshot& scene, Ray ray, uint32_t visibility, geometry::Hit* hit) {
  shading::RayState state;
  for (uint32_t passed = 0; scene.intersect(ray, visibility, hit); ++passed) {
    const geometry::SurfacePoint point = scene.surface_point(*hit);
    const Rgb through = shading::shade_transparency(scene, point, -ray.direction, state);
    if (passed == kMaxTransparent || !(mean_component(through) > 0.5f)) return true;
    geometry::pass_surface(point, &ray);
  }
  return false;
}

// Returns the probability with which BSDF sampling scatters a ray diffusely at the point.
double diffuse_share_of(const Snapshot& scene, const geometry::SurfacePoint& point, const Ray& ray) {
  constexpr float kRoughnessThreshold = 0.1f;  // the default of GradusSettings
  shading::ShadeResult shade;
  shading::shade_surface(scene, point, -ray.direction, shading::RayState{}, kRoughnessThreshold, &shade);
  return double(shade.closures.class_probability(bsdf::ScatterClass::Diffuse));
}

// Sets the point to where the ray meets a surface that scatters diffusely. Returns false if it meets none.
bool find_surface(const Snapshot& scene, const Ray& ray, uint32_t visibility, size_t pixel, double weight,
                  MeasuredPoint* found) {
  geometry::Hit hit;
  if (is_none(ray) || !find_hit(scene, ray, visibility, &hit)) return false;
  scene.place(hit, &found->point);
  const Vec3 normal = found->point.shading_normal;
  found->receiver.position = found->point.position;
  found->receiver.normal = glm::dot(normal, ray.direction) > 0.0f ? -normal : normal;
  found->receiver.time = ray.time;
  found->receiver.light_sets = found->point.light_set;
  found->diffuse_share = diffuse_share_of(scene, found->point, ray);
  if (!(found->diffuse_share > 0.0)) return false;
  found->pixel = pixel;
  found->weight = weight;
  return true;
}

// Returns the share of the light of a sample that reaches the point.
double visibility_of(const Snapshot& scene, const MeasuredPoint& from, const light::LightPoint& point,
                     const light::LightEvaluation& view) {
  if (!view.casts_shadow) return 1.0;
  const Vec3 start = light::shadow_ray_origin(scene, from.point, point, view.direction);
  const Ray ray = light::ray_to_light(start, from.point, point, view);
  return double(mean_component(view.blockers == geometry::kAllSets
                                   ? scene.transmittance(ray, kMaxTransparent)
                                   : scene.transmittance(ray, kMaxTransparent, view.blockers)));
}

// Returns the radiance of a light sample towards diffuse bounces, as the mean of the channels.
double diffuse_radiance(const Snapshot& scene, const light::LightPoint& point, const light::LightEvaluation& view) {
  if ((view.visibility & GRADUS_VISIBLE_DIFFUSE) == 0) return 0.0;
  shading::RayState ray;
  ray.flags = shading::kRayDiffuse | shading::kRayReflection;
  ray.length = view.distance;
  const Rgb radiance = view.by_kind ? light::evaluated_radiance(scene, point, view, ray) : view.radiance;
  const double mean = double(mean_component(glm::abs(radiance)));
  return std::isfinite(mean) ? mean : 0.0;
}

// Takes a light sample among those of a group, which light sampling chooses by numbers in [begin, begin + share).
Sample sample_group(const Snapshot& scene, const MeasuredPoint& from, double begin, double share, uint32_t index) {
  light::LightPoint point;
  light::LightEvaluation view;
  const auto [u, v, w] = random_numbers(index);
  const auto choice = float(begin + share * double(w));
  light::sample_light_point(scene, from.receiver, std::min(choice, 0x1.fffffep-1f), Vec2(u, v), &point, &view);
  const double cosine = std::max(0.0f, glm::dot(view.direction, from.receiver.normal));
  Sample sample;
  if (point.kind == light::LightKind::None || !(view.pdf > 0.0f) || !(cosine > 0.0)) return sample;
  sample.density = double(view.pdf) / share;
  sample.by_bsdf = point.found_by_rays ? from.diffuse_share * cosine / double(kPi) : 0.0;
  sample.light = diffuse_radiance(scene, point, view) * cosine / double(kPi);
  if (sample.light > 0.0) sample.light *= visibility_of(scene, from, point, view);
  return sample;
}

void take_samples(const Snapshot& scene, uint32_t first_index, MeasuredPoint* at) {
  const light::LightTable& table = *scene.light_table;
  light::LightChoice choice;
  table.choose(at->receiver, &choice);
  at->irradiance = table.irradiance(at->receiver, choice.cut);
  const std::array<double, 3> shares = as_array(choice.group);
  double begin = 0.0;
  for (uint32_t group = 0; group < shares.size(); ++group) {
    for (uint32_t i = 0; i < kSamples && shares[group] > 0.0; ++i)
      at->samples[group][i] = sample_group(scene, *at, begin, shares[group], first_index + group * kSamples + i);
    begin += shares[group];
  }
}

// Returns the direct light that the point reflects, by its samples.
double direct_light(const MeasuredPoint& point) {
  double sum = 0.0;
  for (const auto& group : point.samples)
    for (const Sample& s : group) sum += s.light > 0.0 ? s.light / s.density / kSamples : 0.0;
  return sum;
}

// Returns the variance of one light sample and one BSDF sample at the point, combined by the balance heuristic, where
// the groups are chosen with these probabilities. With f the light and p and b the densities of both techniques, the
// second moments are the integral of f²/(p + b). A BSDF sample that finds no light finds what other surfaces reflect,
// which makes up for part of it. The squares of the two means are products of independent estimates, so that the result
// can be negative.
double variance(const MeasuredPoint& point, const std::array<double, 3>& shares) {
  double moment = 0.0;
  std::array<double, 2> by_light{}, by_bsdf{};  // means of the two techniques by each half of the samples
  for (size_t group = 0; group < shares.size(); ++group) {
    for (size_t i = 0; i < kSamples; ++i) {
      const Sample& s = point.samples[group][i];
      if (!(s.light > 0.0)) continue;
      const double both = shares[group] * s.density + s.by_bsdf;
      if (!(both > 0.0)) return INFINITY;
      const double value = s.light / s.density / both;
      moment += s.light * value / kSamples;
      by_light[i % 2] += shares[group] * s.density * value / (kSamples / 2);
      by_bsdf[i % 2] += s.by_bsdf * value / (kSamples / 2);
    }
  }
  const std::array<double, kBounces>& c = point.reflected;
  moment += 0.5 * (c[0] * c[0] + c[1] * c[1]) / point.diffuse_share;
  return moment - by_light[0] * by_light[1] - (by_bsdf[0] + c[0]) * (by_bsdf[1] + c[1]);
}

// Returns the brightness of each pixel by the direct light of the points that the camera sees.
std::vector<double> brightness_of(const std::vector<MeasuredPoint>& points) {
  std::vector<double> pixels(kPixels, 0.0);
  double sum = 0.0;
  for (const MeasuredPoint& point : points) {
    if (point.weight < 1.0) continue;
    sum += pixels[point.pixel] = direct_light(point);
  }
  // The mean over 3×3 pixels removes most of the noise.
  std::vector<double> smooth(kPixels, kAmbient * sum / double(kPixels) + 1e-12);
  for (int y = 0; y < kRows; ++y)
    for (int x = 0; x < kColumns; ++x)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          const int column = std::clamp(x + dx, 0, kColumns - 1), row = std::clamp(y + dy, 0, kRows - 1);
          smooth[size_t(y) * kColumns + size_t(x)] += pixels[size_t(row) * kColumns + size_t(column)] / 9.0;
        }
  return smooth;
}

// Returns the relative variance of the picture times its time, in no particular unit.
double cost(const std::vector<MeasuredPoint>& points, const std::vector<double>& brightness,
            const light::GroupFactors& factors) {
  double sum = 0.0, weight = 0.0, sampled = 0.0;
  for (const MeasuredPoint& point : points) {
    const std::array<double, 3> shares = as_array(light::choose_group(point.irradiance, factors));
    sampled += shares[0] + shares[1] + shares[2];
    weight += point.weight;
    sum += point.weight * variance(point, shares) / (brightness[point.pixel] * brightness[point.pixel]);
  }
  const double time = 1.0 + kTimeOfSamples * sampled / double(points.size());
  return (std::max(sum / weight, 0.0) + kOtherVariance) * time;
}

// Finds what the camera sees in a pixel, and in the elements behind `first` what that sees.
void find_points_of_pixel(const Snapshot& scene, const camera::Camera& camera, uint32_t pixel, MeasuredPoint* first) {
  const auto [x, y, w] = random_numbers(pixel);
  const Vec2 film = Vec2(float(pixel % kColumns), float(pixel / kColumns)) + Vec2(x, y);
  const Ray ray = camera.ray({film, Vec2(0.5f), 0.5f});
  const uint32_t first_index = (1 + pixel) * (1 + kBounces) * 4 * kSamples;
  if (!find_surface(scene, ray, GRADUS_VISIBLE_CAMERA, pixel, 1.0, first)) return;
  take_samples(scene, first_index, first);
  for (uint32_t k = 0; k < kBounces; ++k) {
    const uint32_t index = first_index + (1 + k) * 4 * kSamples;
    const auto [u, v, unused] = random_numbers(index + 3 * kSamples);
    const Vec3 direction = bsdf::sample_cosine_around(first->receiver.normal, Vec2(u, v));
    const Ray bounce{geometry::offset_origin(first->point, direction), 0.0f, direction, kInfinity, ray.time};
    MeasuredPoint& next = first[1 + k];
    if (!find_surface(scene, bounce, GRADUS_VISIBLE_DIFFUSE, pixel, kAlbedo * kAlbedo, &next)) continue;
    take_samples(scene, index, &next);
    first->reflected[k] = kAlbedo * direct_light(next);
  }
}

// Returns the points that the camera sees and those that these see, in a fixed order.
std::vector<MeasuredPoint> find_points(const Snapshot& scene, const CommitMonitor& monitor) {
  const camera::Camera camera(scene.camera, kColumns, kRows);
  std::vector<MeasuredPoint> found((1 + kBounces) * kPixels);
  parallel_each<16>(kPixels, monitor, [&](size_t i) {
    const auto pixel = uint32_t(i);
    find_points_of_pixel(scene, camera, pixel, &found[(1 + kBounces) * pixel]);
  });
  std::erase_if(found, [](const MeasuredPoint& point) { return !(point.weight > 0.0); });
  return found;
}

// Returns the factors to try for a group, beside a reference whose factor is 1.
std::vector<double> trials(bool exists, bool is_reference, bool may_be_left_out) {
  if (!exists) return {1.0};
  std::vector<double> factors{1.0};
  if (!is_reference) factors.insert(factors.end(), {0.5, 0.25, 0.125, 0.0625, 2.0, 4.0});
  if (may_be_left_out) factors.push_back(0.0);
  return factors;
}

// Returns whether all kinds of bounces and shadow rays meet the same surfaces, so that light samples of a uniform world
// show what BSDF samples of it do. Transparency may differ for shadow rays, which then count as diffuse bounces.
bool kinds_are_alike(const Snapshot& snapshot) {
  return snapshot.features.has_uniform_visibility &&
         std::none_of(snapshot.materials.begin(), snapshot.materials.end(), [](const auto& material) {
           return material->may_be_transparent && (material->depends_on_kind || !material->transparent_shadow);
         });
}

}  // namespace

light::GroupFactors measure_group_factors(const Snapshot& snapshot, const CommitMonitor& monitor) {
  const light::LightTable& table = *snapshot.light_table;
  const bool has_tree = !table.tree.empty(), has_suns = !table.suns.empty(), has_world = !table.world.black();
  const bool is_uniform = has_world && table.world.is_uniform();
  const bool is_left_out = is_uniform && !kinds_are_alike(snapshot);
  const light::GroupFactors neutral{1.0, 1.0, is_left_out ? 0.0 : 1.0};
  const bool has_choice = int(has_tree) + int(has_suns) + int(has_world) > 1 || (is_uniform && !is_left_out);
  if (!snapshot.has_camera || !has_choice) return neutral;
  const std::vector<MeasuredPoint> points = find_points(snapshot, monitor);
  if (points.empty()) return neutral;
  const std::vector<double> brightness = brightness_of(points);
  std::vector<light::GroupFactors> candidates;  // the first is neutral
  for (const double suns : trials(has_suns, !has_tree, false))
    for (const double world : trials(has_world && !is_left_out, !has_tree && !has_suns, is_uniform))
      candidates.push_back({1.0, suns, is_left_out ? 0.0 : world});
  std::vector<double> costs(candidates.size());
  parallel_each<1>(candidates.size(), monitor, [&](size_t i) { costs[i] = cost(points, brightness, candidates[i]); });
  const auto minimum = std::min_element(costs.begin(), costs.end());
  return *minimum < kWorthwhile * costs[0] ? candidates[size_t(minimum - costs.begin())] : neutral;
}

std::shared_ptr<const Snapshot> with_factors_of(const Snapshot& other, std::shared_ptr<const Snapshot> scene) {
  const light::GroupFactors &theirs = other.light_table->factors, &own = scene->light_table->factors;
  // The tree is the reference of the factors: its own is always 1.
  const bool leave_out_the_same = (theirs.world > 0.0) == (own.world > 0.0);
  const bool has_catchers = scene->catchers != nullptr && other.catchers != nullptr;
  const auto catchers = has_catchers ? with_factors_of(*other.catchers, scene->catchers) : scene->catchers;
  const bool takes_theirs = leave_out_the_same && (theirs.suns != own.suns || theirs.world != own.world);
  if (!takes_theirs && catchers == scene->catchers) return scene;
  auto result = std::make_shared<Snapshot>(*scene);
  result->catchers = catchers;
  if (takes_theirs) {
    auto table = std::make_shared<light::LightTable>(*scene->light_table);
    table->factors = theirs;
    result->light_table = std::move(table);
  }
  return result;
}

}  // namespace gradus::scene
