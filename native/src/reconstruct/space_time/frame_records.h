// What the pictures of other frames read of a frame: a record of 64 bytes for each pixel, so that a pixel to which
// motion leads is one line of the cache.
#pragma once

#include <algorithm>
#include <vector>

#include "film/film.h"
#include "reconstruct/field.h"
#include "reconstruct/regression/halved_image.h"

namespace gradus::reconstruct {

inline constexpr int kRecordsAhead = 12;  // number of pixels by which records are fetched ahead of their use

// Order of the values of a record. Light is in the units of the film, so that equal light is equal in all frames;
// weights and variance are in units of FrameRecords::scale, which keeps their squares within floats. Depth is a
// distance.
enum RecordValue : int {
  kRecordMean = 0,
  kRecordHalfDifference = 3,
  kRecordFeatures = 6,
  kRecordDepth = 12,
  kRecordWeight = 13,     // in windows
  kRecordOwnWeight = 14,  // of the pixel's own value
  kRecordVariance = 15,   // of the light, mean over the channels
  kRecordSize = 16,
};
struct alignas(64) SampleRecord {
  float values[kRecordSize];
};

struct AlphaRecord {
  float mean, variance;
};

struct FrameRecords {
  int width = 0, height = 0;
  float scale = 1.0f;  // median luminance
  float typical_depth = 1.0f;
  bool has_differences = false;  // whether the film has sampled differences
  std::vector<SampleRecord> pixels;
  std::vector<AlphaRecord> alpha;  // of each pixel; empty if the film is opaque
  // All channels of each component, in the units of the film; empty unless there are several components or alpha.
  std::vector<Field> components;

  const float* at(int pixel) const { return pixels[size_t(pixel)].values; }
  // Fetches the record of a pixel into the cache, unless it is kNoCorrespondence.
  void prefetch(int pixel) const {
    if (pixel >= 0) __builtin_prefetch(pixels.data() + pixel);
  }
};

// Largest ratio of the scales of two frames whose lights are compared. Its square fits in a float.
inline constexpr float kMaxRatio = 1e6f;
// Returns the scale of a frame over that of the picture, within the range of lights that are compared.
inline float relative_scale(const FrameRecords& frame, const FrameRecords& picture) {
  return std::clamp(frame.scale / picture.scale, 1.0f / kMaxRatio, kMaxRatio);
}
// Returns whether light of the frame, in units of the picture, is finite. Lights that differ by more are not the same.
inline bool is_comparable(const FrameRecords& frame, const FrameRecords& picture) {
  return frame.scale <= kMaxRatio * picture.scale;
}

// Throws `invalid_operation` if the film has no features.
FrameRecords read_records(const film::Film& film);

// Return planes of a frame, in the form in which a single picture is regressed: light in units of the scale.
HalvedImage image_of(const FrameRecords& frame);
std::vector<Field> components_of(const FrameRecords& frame);
Field features_of(const FrameRecords& frame);
Field plane_of(const FrameRecords& frame, RecordValue value);

}  // namespace gradus::reconstruct
