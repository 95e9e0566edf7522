// The sampled frame: sums per pixel, in halves, so that variances are known. The one gate into it is
// film/finite_check.h.
//
// A pixel p keeps the gradient samples of its own four offsets (towards +x, +y, -x, -y), so that nothing is written
// across pixels and the result does not depend on tiles or threads; dx and dy are merged when read:
//   dx(p) = sum(p, +x) / pair_count(p, +x) - sum(p + x, -x) / pair_count(p + x, -x)
// Each end of a pair is normalised by the samples that it has taken itself, so that a batch that was cut short in
// between (a cancel) gives no gradient that is too small (contract 1.5: the weights are those of the batch's counts,
// and batches are combined by these).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "base/region.h"
#include "base/types.h"
#include "film/replay_map.h"
#include "film/sample_ranges.h"
#include "gradus/gradus.h"

namespace gradus::film {

enum Offset : int { kRight = 0, kUp = 1, kLeft = 2, kDown = 3, kOffsets = 4 };
inline constexpr int kOffsetX[kOffsets] = {1, 0, -1, 0};
inline constexpr int kOffsetY[kOffsets] = {0, 1, 0, -1};
inline constexpr int kHalves = 2;

// Of the first rough vertices of a component's paths: sums over the samples that have come to one.
struct NonSpecularVertices {
  Rgb reflectance = Rgb(0.0f);
  Vec3 normal = Vec3(0.0f);  // in the world, as shaded
  // 1/length of the path, which is linear over a plane in the picture; 0: infinitely far.
  float inverse_depth = 0.0f;
  float samples = 0.0f;
};

inline constexpr uint32_t kNoSample = std::numeric_limits<uint32_t>::max();

// More of these vertices, and of what shines, be it rough or not: sums over the segments at whose ends, or on which,
// there was one or the other; what cannot be averaged is that of the first sample that met a surface.
struct NonSpecularDetails {
  Vec3 uv = Vec3(0.0f);      // u, v, 1; 0 without a UV map
  Rgb emission = Rgb(0.0f);  // radiance that shines from there
  float segments = 0.0f;
  float object = 0.0f;          // pass index
  float face = -1.0f;           // of the mesh
  uint32_t sample = kNoSample;  // of which object and face are
};

// What a component shows at the centre of a pixel, through smooth surfaces.
struct ShownPoint {
  float object = 0.0f;  // a number of the way and of the object at its end, not above 2^24: others have others; 0: it
                        // shows nothing
  float depth = 0.0f;   // length of the way; 0: it does not end
};

// One component of the decomposition: primal sums and gradient sums of both halves. Row-major over Film::region.
struct ComponentPlanes {
  std::string name, expression;  // lpe/components.h
  std::array<std::vector<Radiance>, kHalves> primal;
  std::array<std::array<std::vector<Radiance>, kOffsets>, kHalves> gradient;  // empty where the integrator makes none
  std::array<std::vector<NonSpecularVertices>, kHalves> non_specular;         // empty unless asked for
  std::vector<NonSpecularDetails> details;                                    // likewise
  // Of what the component shows at the centres of pixels: previous − now, now − next, in pixels; 1, or why that is not
  // known (motion/component_motion.h). Empty unless asked for.
  std::vector<Vec4> motion;
  std::vector<float> tracked;
  std::vector<ShownPoint> shown;  // for optical flow (motion/irradiance_motion.h); empty unless that is asked for
};

// Of a pixel in which a component shows nothing.
inline constexpr float kNothingToTrack = -1.0f;

// A data or light pass: sums over samples, `channels` per pixel.
struct PassPlane {
  uint32_t pass = GRADUS_PASS_COUNT;
  uint32_t channels = 0;
  bool first_sample_only = false;                  // depth, ids: value, not a sum
  bool skips_transparent = false;                  // averaged by `weight` instead of the sample count
  bool in_halves = false;                          // features, whose noise is to be known
  std::array<std::vector<float>, kHalves> values;  // all in the first, unless in_halves
  std::vector<float> weight;

  std::vector<float>& of_half(int half) { return values[in_halves ? half : 0]; }
};

// Counters by cause; names in gradus stats. One per worker, added up in the end.
struct Counters {
  uint64_t rays_primary = 0, rays_bounce = 0, rays_shadow = 0, rays_shift = 0, rays_shift_shadow = 0;
  uint64_t shifts_attempted = 0, shifts_reconnected = 0, shifts_half_vector = 0, shifts_replayed = 0;
  // failures by cause
  uint64_t fail_missed = 0, fail_occluded = 0, fail_class = 0, fail_total_reflection = 0, fail_side = 0,
           fail_density = 0, fail_jacobian = 0, fail_border = 0;
  uint64_t nonfinite_radiance = 0, nonfinite_gradient = 0, nonfinite_feature = 0;
  void add(const Counters& other);
};

// How far an adaptive render has come (render/adaptive_sampling.h), so that it can go on as if it had not ended. By
// cells of the lattice, row by row; empty where no such render can go on from the frame.
struct AdaptiveState {
  uint32_t mean = 0;  // samples of a pixel, on average over those that went on
  uint32_t uncounted =
      0;  // the first of each pixel, taken by a render that was not adaptive: what they have cost is not known
  std::vector<uint64_t> rays;    // that the samples of a cell have cost
  std::vector<uint8_t> stopped;  // 1: takes no more
  bool is_done() const { return !stopped.empty() && std::find(stopped.begin(), stopped.end(), 0) == stopped.end(); }
};

class Film {
 public:
  // full: size of the full frame; region: what is sampled (guard ring included); channels: 3, or 4 with a transparent
  // film.
  Film(uint32_t full_width, uint32_t full_height, const Region& region, int channels, int components, bool gradients);

  size_t index(int32_t x, int32_t y) const {
    return size_t(y - region.y0) * size_t(region.width()) + size_t(x - region.x0);
  }
  uint64_t memory_bytes() const;

  uint32_t full_width, full_height;
  Region region;
  int channels;
  bool gradients;
  std::vector<ComponentPlanes> components;
  std::array<std::vector<uint32_t>, kHalves> count;  // samples of each pixel and half
  // What the gradient sums of a pixel's own samples are divided by: the sum over these of (m_p + m_q)/(2 m_p), m the
  // counts of the batch; after whole batches the sum over batches of (m_p + m_q)/2, the same at both ends of a pair.
  std::array<std::array<std::vector<float>, kOffsets>, kHalves> pair_count;
  std::vector<PassPlane> passes;
  std::vector<float> fallback;  // samples that met a replaced node; empty unless asked for
  Counters counters;

  // Sample numbers that were taken; of some pixels fewer, where tiles stopped early or the render was cancelled.
  SampleRanges samples;
  AdaptiveState shared;
  ReplayMap replayed;  // whose random numbers they have taken; no pixels: their own
  // Keys of what was sampled (contract 7.2) and settings that reading needs.
  GradusSettings settings{};
  uint64_t scene_key = 0;
  int32_t frame_number = 0;
};

// For people: "Diffuse, Residual".
std::string component_names(const Film& film);
bool same_components(const Film& a, const Film& b);
// -1: there is none.
int find_component(const Film& film, std::string_view name);
// As if no other had been sampled; black where the frame has none of that name.
void select_component(std::string_view name, Film* film);
// The same of several, which come in this order.
void select_components(const std::vector<std::string>& names, Film* film);
// Samples of the pixel with this index.
inline uint32_t samples_at(const Film& film, size_t i) { return film.count[0][i] + film.count[1][i]; }
// Samples of a pixel, on average over the region.
double mean_samples(const Film& film);
// Samples of each pixel.
std::vector<uint32_t> samples_of_pixels(const Film& film);
// What was asked for, without the guard ring.
Region delivered_region(const Film& film);

// Which halves an image is read from: [first, last).
struct HalfRange {
  int first = 0;
  int last = kHalves;
};

// In the place of a difference of which no samples were taken: solvers leave it out.
inline constexpr float kAbsentPair = std::numeric_limits<float>::quiet_NaN();

// Rows of what read_images() gives, y counted from the region's first row. `offset`: kRight for dx, kUp for dy.
void read_primal_row(const Film& film, int component, HalfRange halves, int y, float* row);
void read_difference_row(const Film& film, int component, Offset offset, HalfRange halves, int y, float* row);

// Images read from a frame: planes of the region, channels interleaved (Film::channels each).
struct GradientImages {
  int width = 0, height = 0, channels = 3;
  std::vector<float> primal;  // mean
  std::vector<float> dx,
      dy;  // forward differences, y up; last column, row are 0; NaN where a pair has no samples (kAbsentPair)
  // Estimated standard deviations of the means, one value per pixel: the root mean square over RGB of half the
  // difference between the two halves (contract 1.2). NaN where a half has no samples. Empty unless asked for.
  std::vector<float> primal_deviation, dx_deviation, dy_deviation;
};

// Merges halves and pairs.
GradientImages read_images(const Film& film, int component);
// Half the differences of the halves, (A − B)/2, in the place of primal, dx and dy: their squares estimate variances
// (contract 1.2), and what is linear in those is so in these. Of a pixel with samples in one half alone, its mean: the
// square is no less than the variance on average. A difference that a half lacks is absent.
GradientImages read_half_differences(const Film& film, int component);
// Fills the deviations.
void read_deviations(const Film& film, int component, GradientImages* images);

}  // namespace gradus::film
