// The film accumulates samples as sums per pixel, in two half-buffers A and B, so that variances can be estimated. All
// samples enter it through the finite check in film/finite_check.h.
//
// A pixel p keeps the gradient samples of its own four offset paths (towards +x, +y, -x, -y). No pixel writes to
// another one, so the result does not depend on tiles or threads. Reading merges the four into dx and dy:
//   dx(p) = sum(p, +x) / pair_count(p, +x) - sum(p + x, -x) / pair_count(p + x, -x)
// Each end of a pair is normalised by its own samples, so that a batch interrupted by a cancel does not give a gradient
// that is too small. The weights are those of the batch's sample counts, and batches are combined by these counts.
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
#include "film/channel.h"
#include "film/replay_map.h"
#include "film/sample_ranges.h"
#include "gradus/gradus.h"

namespace gradus::film {

enum Offset : int { kRight = 0, kUp = 1, kLeft = 2, kDown = 3, kOffsets = 4 };
inline constexpr int kOffsetX[kOffsets] = {1, 0, -1, 0};
inline constexpr int kOffsetY[kOffsets] = {0, 1, 0, -1};
// First non-specular vertices of a component's paths, as sums over the samples that reached such a vertex.
struct NonSpecularVertices {
  Rgb reflectance = Rgb(0.0f);
  Vec3 normal = Vec3(0.0f);  // shading normal in world space
  // Reciprocal length of the path, which varies linearly in the picture over a plane; 0 at infinity.
  float inverse_depth = 0.0f;
  float samples = 0.0f;
};

inline constexpr uint32_t kNoSample = std::numeric_limits<uint32_t>::max();

// Further data of first non-specular vertices, and of emitters of any roughness: sums over the path segments that end
// at such a vertex or meet such an emitter. Identifiers cannot be averaged; they come from the first sample that met a
// surface.
struct NonSpecularDetails {
  Vec3 uv = Vec3(0.0f);      // u, v, 1; 0 without a UV map
  Rgb emission = Rgb(0.0f);  // emitted radiance
  float segments = 0.0f;
  float object = 0.0f;          // pass index
  float face = -1.0f;           // face number in the mesh
  uint32_t sample = kNoSample;  // number of the sample that gave object and face
};

// The point that a component shows at the centre of a pixel, seen through smooth surfaces.
struct ShownPoint {
  // Unique number of the specular signature and the object at its end, at most 2^24; 0 if nothing is shown.
  float object = 0.0f;
  float depth = 0.0f;  // length of the specular chain; 0 if it does not end
};

// One component of the decomposition: primal sums and gradient sums of both halves. Row-major over Film::region.
struct ComponentPlanes {
  std::string name, expression;  // lpe/components.h
  std::array<std::vector<Radiance>, kHalves> primal;
  std::array<std::array<std::vector<Radiance>, kOffsets>, kHalves> gradient;  // empty where the integrator makes none
  std::array<std::vector<NonSpecularVertices>, kHalves> non_specular;         // empty unless requested
  std::vector<NonSpecularDetails> details;                                    // empty unless requested
  // Motion of the points that the component shows at pixel centres: previous − now (x, y) and now − next (z, w), in
  // pixels. `tracked` is 1, or the reason why the motion is unknown (motion/component_motion.h).
  // Empty unless requested.
  std::vector<Vec4> motion;
  std::vector<float> tracked;
  std::vector<ShownPoint> shown;  // for optical flow (motion/irradiance_motion.h); empty unless requested
};

// Value of ComponentPlanes::tracked for a pixel in which a component shows nothing.
inline constexpr float kNothingToTrack = -1.0f;

// Data that a film keeps for its components beside their radiance.
struct ComponentContent {
  bool non_specular = false;  // NonSpecularVertices
  bool details = false;       // NonSpecularDetails
  bool motion = false;
  bool shown = false;  // ShownPoint
};

// Event counters, reported in gradus stats. Each worker has its own; they are added at the end.
struct Counters {
  uint64_t rays_primary = 0, rays_bounce = 0, rays_shadow = 0, rays_shift = 0, rays_shift_shadow = 0;
  uint64_t shifts_attempted = 0, shifts_reconnected = 0, shifts_half_vector = 0, shifts_replayed = 0;
  // failed shifts by cause
  uint64_t fail_missed = 0, fail_occluded = 0, fail_class = 0, fail_total_reflection = 0, fail_side = 0,
           fail_density = 0, fail_jacobian = 0, fail_border = 0;
  uint64_t nonfinite_radiance = 0, nonfinite_gradient = 0, nonfinite_feature = 0;
  void add(const Counters& other);
};

// State of an adaptive render (render/adaptive_sampling.h), from which it can resume as if it had not ended. Vectors
// have one entry per pixel block, row-major; they are empty if no adaptive render can resume from the film.
struct AdaptiveState {
  uint32_t mean = 0;  // mean samples per pixel over the pixels that have not stopped
  // First samples of each pixel that a render without adaptive sampling took; their cost in rays is unknown.
  uint32_t uncounted = 0;
  std::vector<uint64_t> rays;    // rays traced for the samples of the block
  std::vector<uint8_t> stopped;  // 1 if the block takes no more samples
  bool is_done() const { return !stopped.empty() && std::find(stopped.begin(), stopped.end(), 0) == stopped.end(); }
};

class Film {
 public:
  // full: size of the full frame; region: pixels that are sampled, guard ring included; color_channels: 3, or 4 for a
  // transparent film.
  Film(uint32_t full_width, uint32_t full_height, const Region& region, int color_channels, int components,
       bool gradients);

  size_t index(int32_t x, int32_t y) const { return region.index(x, y); }
  // Returns the size of all planes in bytes.
  uint64_t memory_bytes() const;

  uint32_t full_width, full_height;
  Region region;
  int color_channels;  // of the components' radiance
  bool gradients;
  std::vector<ComponentPlanes> components;
  std::array<std::vector<uint32_t>, kHalves> count;  // samples of each pixel and half
  // Divisor of the gradient sums of a pixel's own samples: the sum over these samples of (m_p + m_q)/(2 m_p), where m
  // are the sample counts of the batch. After whole batches this is the sum over batches of (m_p + m_q)/2, which is
  // equal at both ends of a pair.
  std::array<std::array<std::vector<float>, kOffsets>, kHalves> pair_count;
  ChannelList channels;  // everything else that is sampled, such as passes
  Counters counters;

  // Sample numbers that were taken. Some pixels have fewer if tiles stopped early or the render was cancelled.
  SampleRanges samples;
  AdaptiveState shared;
  ReplayMap replayed;  // source of the random numbers of replayed samples; empty if all samples are fresh
  // Keys of the sampled scene and settings that reading needs.
  GradusSettings settings{};
  uint64_t scene_key = 0;
  int32_t frame_number = 0;
  Mat3 view_rotation{1.0f};  // from directions of the world to the camera's right, up and view axis
};

// Adds zeroed channels for the passes, one bit each.
void add_pass_channels(uint64_t passes, Film* film);
// Allocates the planes for `content` with initial values.
void allocate_component_content(const ComponentContent& content, Film* film);
// Returns the content that the film has planes for.
ComponentContent component_content(const Film& film);

// Returns the component names for messages, such as "Diffuse, Residual".
std::string component_names(const Film& film);
// Returns whether both films have the same component names and expressions in the same order.
bool same_components(const Film& a, const Film& b);
// Returns the index of component `name`, or -1.
int find_component(const Film& film, std::string_view name);
// Keeps only component `name`, as if no other had been sampled; it is black if the film has no such component.
void select_component(std::string_view name, Film* film);
// Keeps only the named components, in this order; a component that the film does not have is black.
void select_components(const std::vector<std::string>& names, Film* film);
// Returns a film with one component, the sum of all components' samples and differences. It has no channels.
Film sum_components(const Film& film);
// Returns the sample count of the pixel with index i.
inline uint32_t samples_at(const Film& film, size_t i) { return film.count[0][i] + film.count[1][i]; }
// Returns the mean sample count per pixel over the region.
double mean_samples(const Film& film);
// Returns the sample count of each pixel.
std::vector<uint32_t> samples_of_pixels(const Film& film);
// Returns the requested region, without the guard ring.
Region delivered_region(const Film& film);

// Half-buffers that an image is read from: [first, last).
struct HalfRange {
  int first = 0;
  int last = kHalves;
};

// Marks a difference without samples; solvers omit it.
inline constexpr float kAbsentPair = std::numeric_limits<float>::quiet_NaN();

// Write one row of the images that read_images() returns. y counts from the region's first row. offset: kRight for dx,
// kUp for dy.
void read_primal_row(const Film& film, int component, HalfRange halves, int y, float* row);
void read_difference_row(const Film& film, int component, Offset offset, HalfRange halves, int y, float* row);

// Images read from a film, over its region: row-major, Film::color_channels interleaved channels.
struct GradientImages {
  int width = 0, height = 0, channels = 3;
  std::vector<float> primal;  // mean
  // Forward differences, y up. The last column of dx and the last row of dy are 0.
  // A pair without samples has kAbsentPair.
  std::vector<float> dx, dy;
  // Estimated standard deviations of the means, one value per pixel: the root mean square over RGB of half the
  // difference between the two half-buffers. NaN where one of them has no samples. Empty unless requested.
  std::vector<float> primal_deviation, dx_deviation, dy_deviation;
};

// Reads a component's means and differences; merges half-buffers and both ends of each pair.
GradientImages read_images(const Film& film, int component);
// As above, without the differences dx and dy.
GradientImages read_pixels(const Film& film, int component);
// Reads half the difference of the half-buffers, (A − B)/2, in place of primal, dx and dy. Its square estimates the
// variance, and any linear function of the images applies to it, too. A pixel with samples in only one half-buffer gets
// its mean, whose expected square is no less than the variance. A difference without samples in one of the half-buffers
// is kAbsentPair.
GradientImages read_half_differences(const Film& film, int component);
// As above, without the differences dx and dy.
GradientImages read_half_differences_of_pixels(const Film& film, int component);
// Fills primal_deviation, dx_deviation and dy_deviation of `images`.
void read_deviations(const Film& film, int component, GradientImages* images);
// Writes the estimated variances of the means in a row, ((A - B)/2)² per channel, where A and B are the sums of all
// components. y counts from the region's first row. The variance is 0 where a half-buffer has no samples, because one
// alone gives no estimate.
void read_variance_row(const Film& film, int y, float* row);

// Writes the normalised values of a channel in `count` pixels from index `first`. `scale` multiplies all values but
// those of the first sample and identifiers. Pixels without samples, weight or paths are 0. A channel that is not in
// halves has only both together.
void read_channel(const Film& film, const Channel& channel, HalfRange halves, size_t first, size_t count, float scale,
                  float* to);

}  // namespace gradus::film
