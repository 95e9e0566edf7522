// How the fresh and the replayed samples of a frame share its sample number, its time limit and its noise threshold.
//
// L2 and L1 compare samples that replay the random numbers of the previous frame: of n samples of a frame, ⌈n/2⌉ are
// fresh and ⌊n/2⌋ are replayed. REGULARIZED joins frames whose samples are independent, so all of them are fresh.
#pragma once

#include "animation/sequence_folder.h"
#include "film/film_header.h"
#include "schema/options.h"
#include "schema/pass_table.h"

namespace gradus::animation {

// Returns whether the samples of several frames are joined: whether REGULARIZED reconstructs.
inline bool joins_frames(const GradusSettings& settings) {
  return settings.reconstruction == GRADUS_RECONSTRUCTION_AUTO ||
         settings.reconstruction == GRADUS_RECONSTRUCTION_REGULARIZED;
}

// Returns whether half of the samples replay those of the previous frame.
inline bool takes_replays(const GradusSettings& settings) {
  return !joins_frames(settings) || schema::has_bit(settings.passes, GRADUS_PASS_GRADIENT_T);
}

// Returns the share of the time limit that fresh samples take. Replayed samples are as many, and take at least as long.
inline float fresh_share_of_time(const GradusSettings& settings) { return takes_replays(settings) ? 0.4f : 1.0f; }

// Returns the factor of the noise threshold for fresh samples: half of the samples have twice the squared error of all
// samples.
inline float fresh_share_of_threshold(const GradusSettings& settings) {
  return takes_replays(settings) ? 1.41421356f : 1.0f;
}

// Returns how many samples of a frame with these settings are of this kind.
inline uint32_t samples_of(FrameSamples kind, const GradusSettings& settings) {
  const uint32_t replayed = takes_replays(settings) ? settings.samples / 2 : 0;
  return kind == FrameSamples::kFresh ? settings.samples - replayed : replayed;
}

// Returns the number of samples per pixel. With adaptive sampling the ranges of sample numbers are those of the pixels
// with the maximum number of samples, so the stored mean is used instead.
inline uint64_t samples_taken(const film::FilmHeader& stored) {
  return stored.shared.rays.empty() ? stored.samples.total() : stored.shared.mean;
}

// Whether the stored samples of one kind suffice for the requested settings: they are as many as requested, or they
// reached the noise threshold or the time limit.
inline bool has_as_many(const film::FilmHeader& stored, FrameSamples kind, const GradusSettings& requested) {
  const bool is_quiet =
      stored.settings.noise_threshold <= fresh_share_of_threshold(requested) * requested.noise_threshold;
  if (stored.shared.is_done()) return is_quiet;
  // Frames with a time limit have as many samples as the time allowed, which may be fewer than in their settings.
  const bool is_limited = stored.settings.time_limit > 0.0f;
  if (is_limited && requested.time_limit > 0.0f &&
      requested.time_limit <= stored.settings.time_limit / fresh_share_of_time(requested))
    return true;
  const uint64_t samples =
      is_limited || kind == FrameSamples::kReplayed ? samples_taken(stored) : stored.settings.samples;
  return samples >= samples_of(kind, requested) && is_quiet;
}

}  // namespace gradus::animation
