// How the fresh and the replayed samples of a frame share its sample number, its time limit and its noise threshold. Of
// n samples of a frame, ⌈n/2⌉ are fresh and ⌊n/2⌋ replay the random numbers of the previous frame.
#pragma once

#include "animation/sequence_folder.h"
#include "film/film_header.h"

namespace gradus::animation {

// Share of the time limit that fresh samples take. The replayed samples are as many, and take at least as long.
inline constexpr float kFreshShareOfTime = 0.4f;

// Factor of the noise threshold for fresh samples: half of the samples have twice the squared error of all samples.
inline constexpr float kFreshShareOfThreshold = 1.41421356f;

// Returns how many of a frame's `samples` are of this kind.
inline uint32_t samples_of(FrameSamples kind, uint32_t samples) {
  return kind == FrameSamples::kFresh ? samples : 1;
}

// Returns the number of samples per pixel. With adaptive sampling the ranges of sample numbers are those of the pixels
// with the maximum number of samples, so the stored mean is used instead.
inline uint64_t samples_taken(const film::FilmHeader& half) {
  return half.shared.rays.empty() ? half.samples.total() : half.shared.mean;
}

// Whether the stored samples of one kind suffice for the requested settings: they are as many as requested, or they
// reached the noise threshold or the time limit.
inline bool has_as_many(const film::FilmHeader& half, FrameSamples kind, const GradusSettings& requested) {
  const bool is_quiet = half.settings.noise_threshold <= kFreshShareOfThreshold * requested.noise_threshold;
  if (half.shared.is_done()) return is_quiet;
  // Frames with a time limit have as many samples as the time allowed, which may be fewer than in their settings.
  const bool is_limited = half.settings.time_limit > 0.0f;
  if (is_limited && requested.time_limit > 0.0f && requested.time_limit <= half.settings.time_limit / kFreshShareOfTime)
    return true;
  const uint64_t samples = is_limited ? samples_taken(half) : half.settings.samples;
  return samples >= samples_of(kind, requested.samples) && is_quiet;
}

}  // namespace gradus::animation
