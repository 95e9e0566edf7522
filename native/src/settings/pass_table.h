// THE native table of passes: names, channels, and which stored plane a pass is read from. The integrator fills the planes that
// frame/pass_planes.h creates; frames are read through render/pass_read.h.
#pragma once

#include <cstdint>
#include <vector>

#include "gradus/gradus.h"

namespace gradus {

// How a pass comes out of a frame.
enum class PassKind : uint8_t {
  Image,     // Combined, Noisy Image
  Derived,   // gradients, variance, counts: from the frame's own planes
  Solved,    // error: comes with Combined (render/combine.h)
  Sequence,  // differences to the next frame: come with the delivery of a sequence (render/sequence), 0 elsewhere
  Radiance,  // sum of radiance; the film's exposure applies
  Light,     // sum of radiance, divided by its colour pass when read (contract 6.5)
  Color,     // sum of albedos
  Average,   // sum of a quantity over all samples, misses count as 0
  Weighted,  // sum over those samples that have it, divided by their number
  First,     // value of the first sample
  Feature,   // as Average, but by halves: its noise is to be known
};

struct PassInfo {
  uint32_t pass;
  const char* name;
  uint32_t channels;  // as delivered, and as stored
  PassKind kind;
  uint32_t color;  // Light: the colour pass it is divided by; GRADUS_PASS_COUNT otherwise
};

// Throws invalid_argument for a number that is no pass.
const PassInfo& pass_info(uint32_t pass);

// Passes of a component.
struct ComponentPassInfo {
  uint32_t pass;
  const char* name;
  uint32_t channels;
};
// Throws invalid_argument for a number that is none.
const ComponentPassInfo& component_pass_info(uint32_t pass);

inline bool wants(uint64_t passes, uint32_t pass) { return (passes >> pass & 1) != 0; }

// `passes` plus what they need: the colours that light passes are divided by.
uint64_t needed_passes(uint64_t passes);
// Those of needed_passes() that an integrator fills planes of, in order of pass number.
std::vector<PassInfo> stored_passes(uint64_t passes);
// Bytes of these planes per pixel.
uint64_t pass_bytes_per_pixel(uint64_t passes);
// What reconstructions and denoisers are guided by.
uint64_t feature_passes();

}  // namespace gradus
