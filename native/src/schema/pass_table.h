// The passes: names, channels, and which stored plane a pass is read from. The table is generated:
// schema/pass_rows.cpp. The integrator fills the planes that film/channel.h creates; frames are read through
// output/pass_read.h.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gradus/gradus.h"

namespace gradus::schema {

// How a pass comes out of a frame.
enum class PassKind : uint8_t {
  Image,     // Combined, Noisy Image
  Derived,   // gradients, variance, counts: from the frame's own planes
  Solved,    // error: comes with Combined (output/developer.h)
  Sequence,  // differences to the next frame: come with the delivery of a sequence (render/sequence), 0 elsewhere
  Radiance,  // sum of radiance, by halves; the film's exposure applies
  Light,     // the same, divided by its colour pass when read (contract 6.5)
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

// Parts of the picture's light, which add up to it (contract 6.5).
constexpr bool is_of_light(PassKind kind) { return kind == PassKind::Radiance || kind == PassKind::Light; }
// By halves, whose difference tells the noise.
constexpr bool is_in_halves(PassKind kind) { return kind == PassKind::Feature || is_of_light(kind); }

// Returns the passes in order of their numbers.
std::span<const PassInfo> all_passes();
// Throws invalid_argument for a number that is no pass.
const PassInfo& pass_info(uint32_t pass);

// Depth and face where there is nothing.
inline constexpr float kFarDepth = 1e10f;
inline constexpr float kNoFace = -1.0f;

// Passes of a component.
struct ComponentPassInfo {
  uint32_t pass;
  const char* name;
  uint32_t channels;
};
// Returns the passes of a component in order of their numbers.
std::span<const ComponentPassInfo> all_component_passes();
// Throws invalid_argument for a number that is none.
const ComponentPassInfo& component_pass_info(uint32_t pass);

inline bool has_bit(uint64_t passes, uint32_t pass) { return (passes >> pass & 1) != 0; }

// Motion by optical flow, which is about that of what the component shows.
constexpr bool is_irradiance_motion(uint32_t component_pass) {
  return component_pass == GRADUS_COMPONENT_IRRADIANCE_MOTION || component_pass == GRADUS_COMPONENT_IRRADIANCE_TRACKED;
}
// Passes of a component that are made of its picture, of the first rough vertices of its paths, of more that is kept of
// these, of its motion.
constexpr bool is_of_picture(uint32_t component_pass) {
  return component_pass == GRADUS_COMPONENT_COLOR || component_pass == GRADUS_COMPONENT_IRRADIANCE;
}
constexpr bool is_of_non_specular_vertices(uint32_t component_pass) {
  return component_pass == GRADUS_COMPONENT_REFLECTANCE || component_pass == GRADUS_COMPONENT_IRRADIANCE ||
         component_pass == GRADUS_COMPONENT_NORMAL || component_pass == GRADUS_COMPONENT_DEPTH ||
         is_irradiance_motion(component_pass);
}
constexpr bool is_of_non_specular_details(uint32_t component_pass) {
  return component_pass == GRADUS_COMPONENT_UV || component_pass == GRADUS_COMPONENT_OBJECT_INDEX ||
         component_pass == GRADUS_COMPONENT_FACE_INDEX || component_pass == GRADUS_COMPONENT_EMIT;
}
constexpr bool is_motion(uint32_t component_pass) {
  return component_pass == GRADUS_COMPONENT_MOTION || component_pass == GRADUS_COMPONENT_TRACKED ||
         is_irradiance_motion(component_pass);
}
// Whether some pass of that kind is wanted.
bool any_wanted(uint32_t component_passes, bool (*is_of_kind)(uint32_t component_pass));
// In sequences: Irradiance Motion, and Motion of Residual, are made of two frames.
inline bool needs_flow(const GradusSettings& settings) {
  return settings.use_decomposition != 0 && any_wanted(settings.component_passes, is_motion);
}
inline bool needs_pictures(const GradusSettings& settings) {
  return settings.use_decomposition != 0 && any_wanted(settings.component_passes, is_of_picture);
}

// `passes` plus what they need: the colours that light passes are divided by.
uint64_t needed_passes(uint64_t passes);
// Those of needed_passes() that an integrator fills planes of, in order of pass number.
std::vector<PassInfo> stored_passes(uint64_t passes);
// Bytes of these planes per pixel.
uint64_t pass_bytes_per_pixel(uint64_t passes);
// What reconstructions and denoisers are guided by.
uint64_t feature_passes();
// Parts of the picture's light.
uint64_t light_passes();

}  // namespace gradus::schema
