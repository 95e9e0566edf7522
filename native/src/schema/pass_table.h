// The passes: names, channels, and which stored plane a pass is read from. The table is generated:
// schema/pass_rows.cpp. The integrator fills the planes that film/channel.h creates; frames are read through
// output/pass_read.h.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "gradus/gradus.h"

namespace gradus::schema {

// How samples of a film become the values of a pass.
enum class PassKind : uint8_t {
  Image,     // The picture: Combined and Noisy Image.
  Derived,   // Computed from the film's own planes: gradients, variance, sample counts.
  Solved,    // Error, which the reconstruction of Combined computes.
  Sequence,  // Differences to the next frame, which an animation delivers; 0 elsewhere.
  Radiance,  // Mean of radiance, kept in half-buffers and multiplied by the film's exposure.
  Light,     // As Radiance, but divided by its colour pass when it is read.
  Color,     // Mean of albedos.
  Average,   // Mean of a quantity over all samples; samples without it count as 0.
  Weighted,  // Mean over the samples that have the quantity.
  First,     // Value of the first sample.
  Feature,   // As Average, but kept in half-buffers, from which the noise is estimated.
};

struct PassInfo {
  uint32_t pass;
  const char* name;
  const char* letters;  // One for each channel, as Blender names the channels in a multilayer file.
  PassKind kind;
  uint32_t color;  // The colour pass that divides a Light pass; GRADUS_PASS_COUNT for other kinds.
  uint32_t channels = uint32_t(std::string_view(letters).size());  // Number of values per pixel, delivered and stored.
};

// Returns whether a pass of this kind is a part of the picture's light. These passes add up to the picture.
constexpr bool is_of_light(PassKind kind) { return kind == PassKind::Radiance || kind == PassKind::Light; }
// Returns whether a pass of this kind is kept in half-buffers, whose difference estimates its noise.
constexpr bool is_in_halves(PassKind kind) { return kind == PassKind::Feature || is_of_light(kind); }

// Returns the passes in order of their numbers.
std::span<const PassInfo> all_passes();
// Throws invalid_argument for a number that is no pass.
const PassInfo& pass_info(uint32_t pass);

// Values of the depth and the face number in pixels where no surface is hit.
inline constexpr float kFarDepth = 1e10f;
inline constexpr float kNoFace = -1.0f;

// A pass that each component has.
struct ComponentPassInfo {
  uint32_t pass;
  const char* name;
  const char* letters;                                             // As in PassInfo.
  uint32_t channels = uint32_t(std::string_view(letters).size());  // Number of values per pixel.
};
// Returns the passes of a component in order of their numbers.
std::span<const ComponentPassInfo> all_component_passes();
// Throws invalid_argument for a number that is no pass of a component.
const ComponentPassInfo& component_pass_info(uint32_t pass);

inline bool has_bit(uint64_t passes, uint32_t pass) { return (passes >> pass & 1) != 0; }

// Returns whether the pass holds motion found by optical flow, which starts from the motion of the shown points.
constexpr bool is_irradiance_motion(uint32_t component_pass) {
  return component_pass == GRADUS_COMPONENT_IRRADIANCE_MOTION || component_pass == GRADUS_COMPONENT_IRRADIANCE_TRACKED;
}
// The following functions return from which data of the component a pass is computed: its picture, the first
// non-specular vertices of its paths, further details of these vertices, or its motion.
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
// Returns whether at least one of the passes (one bit each) is of the kind.
bool any_wanted(uint32_t component_passes, bool (*is_of_kind)(uint32_t component_pass));
// Returns whether an animation computes passes by optical flow: Irradiance Motion, and Motion of Residual.
inline bool needs_flow(const GradusSettings& settings) {
  return settings.use_decomposition != 0 && any_wanted(settings.component_passes, is_motion);
}
inline bool needs_pictures(const GradusSettings& settings) {
  return settings.use_decomposition != 0 && any_wanted(settings.component_passes, is_of_picture);
}

// Returns `passes` and the colour passes that divide the light passes among them.
uint64_t needed_passes(uint64_t passes);
// Returns those of needed_passes() for which an integrator fills channels, in order of pass number.
std::vector<PassInfo> stored_passes(uint64_t passes);
// Returns the passes that guide reconstructions and denoisers, one bit each.
uint64_t feature_passes();
// Returns the passes that are parts of the picture's light, one bit each.
uint64_t light_passes();

}  // namespace gradus::schema
