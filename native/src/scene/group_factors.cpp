#include "scene/group_factors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/parallel_each.h"
#include "bsdf/warp.h"
#include "camera/camera.h"
#include "geometry/shadow_terminator.h"
#include "geometry/surface.h"
#include "light/light_sampling.h"
#include "scene/snapshot.h"

namespace gradus::scene {

namespace {

// The camera sees a point in each cell of a grid over the picture.
constexpr int kColumns = 24, kRows = 14;
constexpr size_t kPixels = size_t(kColumns) * kRows;
// Light samples of each group at a point. Those of the first half and of the second are independent.
constexpr int kSamples = 4;
constexpr uint32_t kMaxTransparent = 8;
// BSDF samples at a point that the camera sees.
constexpr size_t kBounces = 2;
// Share of the light that a surface reflects, that of further bounces included.
constexpr double kAlbedo = 0.7;
// Share of the mean brightness of the picture that is added to the brightness of each pixel.
constexpr double kAmbient = 0.2;
// CPU time of light samples over that of the rest of a path.
constexpr double kTimeOfSamples = 0.5;
// Factor on the cost without light samples of a uniform world: points are better distributed over directions that one
// technique covers. Suzanne under a grey world has 0.72 of the variance in 0.64 of the time.
constexpr double kLeftOut = 0.8;

// Returns an evenly distributed sequence of points in [0, 1)² (Roberts 2018, "The Unreasonable Effectiveness of
// Quasirandom Sequences", R2).
Vec2 point_of_sequence(uint64_t index) {
  const double i = double(index) + 0.5;
  const double x = 0.7548776662466927 * i, y = 0.5698402909980532 * i;
  return {std::min(float(x - std::floor(x)), 0x1.fffffep-1f), std::min(float(y - std::floor(y)), 0x1.fffffep-1f)};
}

// A light sample of a group: the light that a white diffuse surface reflects, its density among the samples of its
// group, and that of BSDF sampling, which is 0 if no ray can find it.
struct Sample {
  double light = 0.0, density = 0.0, by_bsdf = 0.0;
};

// A point of a surface and its light samples.
struct Place {
  geometry::SurfacePoint point;
  light::Receiver receiver;
  light::GroupIrradiance irradiance;
  std::array<std::array<Sample, kSamples>, 3> samples;  // of the tree, the suns and the world
  // Light that BSDF samples find reflected on other surfaces; 0 where the place is one of these.
  std::array<double, kBounces> reflected{};
  size_t pixel = 0;
  double weight = 0.0;
};

std::array<double, 3> as_array(const light::GroupChoice& choice) { return {choice.tree, choice.suns, choice.world}; }

// Sets the place to where the ray meets a surface. Returns false if it meets none.
bool meet(const Snapshot& scene, const Ray& ray, uint32_t visibility, size_t pixel, double weight, Place* place) {
  geometry::Hit hit;
  if (is_none(ray) || !scene.intersect(ray, visibility, &hit)) return false;
  scene.place(hit, &place->point);
  const Vec3 normal = place->point.shading_normal;
  place->receiver.position = place->point.position;
  place->receiver.normal = glm::dot(normal, ray.direction) > 0.0f ? -normal : normal;
  place->receiver.time = ray.time;
  place->receiver.light_sets = place->point.light_set;
  place->pixel = pixel;
  place->weight = weight;
  return true;
}

// Returns the share of the light of a sample that reaches the place.
double visibility_of(const Snapshot& scene, const Place& place, const light::LightPoint& point,
                     const light::LightEvaluation& view) {
  if (!view.casts_shadow) return 1.0;
  const Vec3 start = geometry::shadow_origin(scene, place.point, view.direction);
  const Ray ray = light::ray_to_light(start, place.point, point, view);
  return double(mean_component(view.blockers == geometry::kAllSets
                                   ? scene.transmittance(ray, kMaxTransparent)
                                   : scene.transmittance(ray, kMaxTransparent, view.blockers)));
}

// Takes a light sample among those of a group, which light sampling chooses by numbers in [begin, begin + share).
Sample sample_group(const Snapshot& scene, const Place& place, double begin, double share, uint64_t index) {
  light::LightPoint point;
  light::LightEvaluation view;
  const auto choice = float(begin + share * double(point_of_sequence(index / 3 + 7).y));
  light::sample_light_point(scene, place.receiver, std::min(choice, 0x1.fffffep-1f), point_of_sequence(index), &point,
                            &view);
  const double cosine = std::max(0.0f, glm::dot(view.direction, place.receiver.normal));
  Sample sample;
  if (point.kind == light::LightKind::None || !(view.pdf > 0.0f) || !(cosine > 0.0)) return sample;
  sample.density = double(view.pdf) / share;
  sample.by_bsdf = point.found_by_rays ? cosine / double(kPi) : 0.0;
  const double light = double(mean_component(glm::abs(view.radiance))) * cosine / double(kPi);
  if (light > 0.0 && std::isfinite(light)) sample.light = light * visibility_of(scene, place, point, view);
  return sample;
}

void take_samples(const Snapshot& scene, uint64_t first_index, Place* place) {
  const light::LightTable& table = *scene.light_table;
  light::LightChoice choice;
  table.choose(place->receiver, &choice);
  place->irradiance = table.irradiance(place->receiver, choice.cut);
  const std::array<double, 3> shares = as_array(choice.group);
  double begin = 0.0;
  for (size_t group = 0; group < shares.size(); ++group) {
    for (uint64_t i = 0; i < kSamples && shares[group] > 0.0; ++i)
      place->samples[group][i] = sample_group(scene, *place, begin, shares[group], first_index + group * kSamples + i);
    begin += shares[group];
  }
}

// Returns the direct light that the place reflects, by its samples.
double direct_light(const Place& place) {
  double sum = 0.0;
  for (const auto& group : place.samples)
    for (const Sample& s : group) sum += s.light > 0.0 ? s.light / s.density / kSamples : 0.0;
  return sum;
}

// Returns the variance of one light sample and one BSDF sample at the place, combined by the balance heuristic, where
// the groups are chosen with these probabilities. With f the light and p and b the densities of both techniques, second
// moments are the integral of f²/(p + b). A BSDF sample that finds no light finds what other surfaces reflect, which
// makes up for part of it. The squares of the two means are products of independent estimates.
double variance(const Place& place, const std::array<double, 3>& shares) {
  double moment = 0.0;
  std::array<double, 2> by_light{}, by_bsdf{};  // means of the two techniques by each half of the samples
  for (size_t group = 0; group < shares.size(); ++group) {
    for (size_t i = 0; i < kSamples; ++i) {
      const Sample& s = place.samples[group][i];
      if (!(s.light > 0.0)) continue;
      const double both = shares[group] * s.density + s.by_bsdf;
      if (!(both > 0.0)) return INFINITY;
      const double value = s.light / s.density / both;
      moment += s.light * value / kSamples;
      by_light[i % 2] += shares[group] * s.density * value / (kSamples / 2);
      by_bsdf[i % 2] += s.by_bsdf * value / (kSamples / 2);
    }
  }
  const std::array<double, kBounces>& c = place.reflected;
  moment += 0.5 * (c[0] * c[0] + c[1] * c[1]);
  return moment - by_light[0] * by_light[1] - (by_bsdf[0] + c[0]) * (by_bsdf[1] + c[1]);
}

// Returns the brightness of each pixel by the direct light of the places that the camera sees.
std::vector<double> brightness_of(const std::vector<Place>& places) {
  std::vector<double> pixels(kPixels, 0.0);
  double sum = 0.0;
  for (const Place& place : places) {
    if (place.weight < 1.0) continue;
    sum += pixels[place.pixel] = direct_light(place);
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
double cost(const std::vector<Place>& places, const std::vector<double>& brightness,
            const light::GroupFactors& factors) {
  double sum = 0.0, sampled = 0.0;
  for (const Place& place : places) {
    const std::array<double, 3> shares = as_array(light::choose_group(place.irradiance, factors));
    sampled += shares[0] + shares[1] + shares[2];
    sum += place.weight * variance(place, shares) / (brightness[place.pixel] * brightness[place.pixel]);
  }
  return sum * (1.0 + kTimeOfSamples * sampled / double(places.size()));
}

// Finds what the camera sees in a pixel, and in `places`[1] and so on what that sees.
void find_places_of_pixel(const Snapshot& scene, const camera::Camera& camera, size_t pixel, Place* places) {
  const Vec2 corner(float(pixel % kColumns), float(pixel / kColumns));
  const Ray ray = camera.ray({corner + point_of_sequence(pixel), Vec2(0.5f), 0.5f});
  const uint64_t first_index = pixel * (1 + kBounces) * 3 * kSamples;
  if (!meet(scene, ray, GRADUS_VISIBLE_CAMERA, pixel, 1.0, places)) return;
  take_samples(scene, first_index, places);
  for (size_t k = 0; k < kBounces; ++k) {
    Place& next = places[1 + k];
    const Vec3 direction =
        bsdf::sample_cosine_around(places->receiver.normal, point_of_sequence(kBounces * (2 * pixel + 1) + k));
    const Ray bounce{geometry::offset_origin(places->point, direction), 0.0f, direction, kInfinity, ray.time};
    if (!meet(scene, bounce, GRADUS_VISIBLE_DIFFUSE, pixel, kAlbedo * kAlbedo, &next)) continue;
    take_samples(scene, first_index + (1 + k) * 3 * kSamples, &next);
    places->reflected[k] = kAlbedo * direct_light(next);
  }
}

// Returns the places that the camera sees and those that these see, in a fixed order.
std::vector<Place> find_places(const Snapshot& scene, const CommitMonitor& monitor) {
  const camera::Camera camera(scene.camera, kColumns, kRows);
  std::vector<Place> found((1 + kBounces) * kPixels);
  parallel_each<16>(kPixels, [&](size_t pixel) {
    if (monitor.is_running()) find_places_of_pixel(scene, camera, pixel, &found[(1 + kBounces) * pixel]);
  });
  monitor.check();
  std::erase_if(found, [](const Place& place) { return !(place.weight > 0.0); });
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

}  // namespace

light::GroupFactors measure_group_factors(const Snapshot& snapshot, const CommitMonitor& monitor) {
  const light::LightTable& table = *snapshot.light_table;
  const bool has_tree = !table.tree.empty(), has_suns = !table.suns.empty(), has_world = !table.world.black();
  const bool is_uniform = has_world && table.world.is_uniform();
  if (!snapshot.has_camera || int(has_tree) + int(has_suns) + int(has_world) + int(is_uniform) < 2) return {};
  const std::vector<Place> places = find_places(snapshot, monitor);
  if (places.empty()) return {};
  const std::vector<double> brightness = brightness_of(places);
  light::GroupFactors best;
  double least = INFINITY;
  for (const double suns : trials(has_suns, !has_tree, false))
    for (const double world : trials(has_world, !has_tree && !has_suns, is_uniform)) {
      const light::GroupFactors factors{1.0, suns, world};
      const double its_cost = cost(places, brightness, factors) * (world > 0.0 ? 1.0 : kLeftOut);
      if (!(its_cost < least)) continue;
      least = its_cost;
      best = factors;
    }
  return best;
}

}  // namespace gradus::scene
