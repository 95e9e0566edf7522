// What the pictures of other frames read of a frame: a record of 64 bytes for each pixel, so that a pixel to which
// motion leads is one line of the cache.
#pragma once

#include <vector>

#include "film/film.h"
#include "reconstruct/field.h"
#include "reconstruct/regression/halved_image.h"

namespace gradus::reconstruct {

// Order of the values of a record. Light is in units of FrameSamples::scale, depth is a distance.
inline constexpr int kRecordsAhead = 12;  // number of pixels by which records are fetched ahead of their use
enum RecordValue : int {
  kMean = 0,
  kHalfDifference = 3,
  kFeatures = 6,
  kDepth = 12,
  kWindowWeight = 13,  // weight in windows
  kOwnWeight = 14,     // weight of the pixel's own value
  kVariance = 15,      // of the light, mean over the channels
  kRecordSize = 16,
};
struct alignas(64) SampleRecord {
  float values[kRecordSize];
};

struct FrameSamples {
  int width = 0, height = 0;
  float scale = 1.0f;  // median luminance
  float typical_depth = 1.0f;
  bool has_differences = false;  // whether the film has sampled differences
  std::vector<SampleRecord> pixels;
  // All channels of each component, colours in units of `scale`; empty unless there are several components or alpha.
  std::vector<Field> components;

  const float* at(int pixel) const { return pixels[size_t(pixel)].values; }
  // Fetches the record of a pixel into the cache. `pixel` may be one outside of the image.
  void prefetch(int pixel) const { __builtin_prefetch(pixels.data() + pixel); }
};

// Throws `invalid_operation` if the film has no features.
FrameSamples read_frame(const film::Film& film);

// Return planes of a frame, in the form in which a single picture is regressed.
HalvedImage image_of(const FrameSamples& frame);
Field features_of(const FrameSamples& frame);
Field plane_of(const FrameSamples& frame, RecordValue value);

}  // namespace gradus::reconstruct
