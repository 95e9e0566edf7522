// What is known of a stored frame without unpacking its planes.
#pragma once

#include "frame/frame.h"
#include "frame/pass_planes.h"

namespace gradus {

struct FrameHeader {
  Region region;
  int channels = 3;
  bool gradients = false;
  uint64_t planes = 0;  // of passes, a bit each
  KeptOfComponents of_components;
  GradusSettings settings{};
  SampleRanges samples;
  uint64_t scene_key = 0;
  int32_t frame_number = 0;
  int32_t replayed_frame = 0;  // of a replay
  uint64_t replayed_key = 0;   // of its scene; 0: not known
  uint32_t replayed_seed = 0;
  SharedSamples shared;
  std::vector<std::string> warnings;  // what the file asks for that this version does not have
};

inline FrameHeader header_of(const Frame& frame) {
  const SampleSources& replayed = frame.replayed;
  return {frame.region,       frame.channels, frame.gradients, kept_passes(frame), kept_of_components(frame),
          frame.settings,     frame.samples,  frame.scene_key, frame.frame_number, replayed.stream_frame,
          replayed.scene_key, replayed.seed,  frame.shared,    {}};
}

}  // namespace gradus
