// How the two halves of a frame share its samples, its time and its noise (contract 4.2).
#pragma once

#include "animation/sequence_folder.h"
#include "film/film_header.h"

namespace gradus::animation {

// Of a time limit; the other half takes as long, and the differences over time make it no shorter (contract 4.6).
inline constexpr float kFreshShareOfTime = 0.4f;

// Of a noise threshold: half of the samples have twice the squared error of all.
inline constexpr float kFreshShareOfThreshold = 1.41421356f;

inline uint32_t samples_of(FrameSamples kind, uint32_t samples) {
  return kind == FrameSamples::kFresh ? samples - samples / 2 : samples / 2;
}

// Of a pixel. The numbers of an adaptive half's samples are those of the pixels that have most: the mean over those
// that went on tells.
inline uint64_t samples_taken(const film::FilmHeader& half) {
  return half.shared.rays.empty() ? half.samples.total() : half.shared.mean;
}

// Whether a half has as many samples as are asked of the frame, or as many as it may have.
inline bool has_as_many(const film::FilmHeader& half, FrameSamples kind, const GradusSettings& requested) {
  const bool is_quiet = half.settings.noise_threshold <= kFreshShareOfThreshold * requested.noise_threshold;
  if (half.shared.is_done()) return is_quiet;
  // Frames with a time limit have as many as it left them, whatever their settings say.
  const bool is_limited = half.settings.time_limit > 0.0f;
  if (is_limited && requested.time_limit > 0.0f && requested.time_limit <= half.settings.time_limit / kFreshShareOfTime)
    return true;
  const uint64_t samples = is_limited ? samples_taken(half) : half.settings.samples;
  return samples >= samples_of(kind, requested.samples) && is_quiet;
}

}  // namespace gradus::animation
