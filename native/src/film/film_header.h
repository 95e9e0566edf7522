// Metadata of a stored film, which can be read without unpacking its planes.
#pragma once

#include "film/film.h"

namespace gradus::film {

struct FilmHeader {
  Region region;
  int color_channels = 3;
  bool gradients = false;
  uint64_t planes = 0;  // stored passes, one bit each
  ComponentContent of_components;
  GradusSettings settings{};
  SampleRanges samples;
  uint64_t scene_key = 0;
  int32_t frame_number = 0;
  Mat3 view_rotation{1.0f};
  int32_t replayed_frame = 0;  // number of the frame whose samples are replayed
  uint64_t replayed_key = 0;   // scene key of that frame; 0 if unknown
  uint32_t replayed_seed = 0;
  uint32_t replayed_net_samples = 0;
  AdaptiveState shared;
  std::vector<std::string> warnings;  // features in the file that this version does not support
};

inline FilmHeader header_of(const Film& film) {
  const ReplayMap& replayed = film.replayed;
  return {film.region,
          film.color_channels,
          film.gradients,
          film.channels.passes(),
          component_content(film),
          film.settings,
          film.samples,
          film.scene_key,
          film.frame_number,
          film.view_rotation,
          replayed.stream_frame,
          replayed.scene_key,
          replayed.seed,
          replayed.net_samples,
          film.shared,
          {}};
}

}  // namespace gradus::film
