// Colour spaces to scene-linear, by OpenColorIO with the host's configuration (contract 8.1).
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include "gradus/gradus.h"

namespace gradus::image {

// How values of a colour space become scene-linear.
enum class ColorTransform {
  Data,   // not colour (Non-Color, Raw, ""), or already scene-linear: values stay
  Srgb,   // the sRGB curve on Rec. 709 primaries, where those are the scene-linear ones
  Other,  // through to_scene_linear() only
};

class ColorManager {
 public:
  using Warn = std::function<void(const std::string&)>;

  // config_path: a file of OpenColorIO, UTF-8. Missing, unreadable or without a scene-linear role: one warning, then
  // sRGB and linear alone are known. Never throws but for lack of memory.
  ColorManager(const std::string& config_path, Warn warn);
  ~ColorManager();
  ColorManager(const ColorManager&) = delete;
  ColorManager& operator=(const ColorManager&) = delete;

  // Values baked elsewhere, which win over the configuration. Throws Error(INVALID_ARGUMENT) for a nameless space or
  // non-finite values.
  void set_override(const GradusColorSpace& space);

  // Which transform `space` needs. Unknown names: one warning with the name, then Srgb if is_byte, else Data.
  ColorTransform transform(const std::string& space, bool is_byte) const;
  // In place: the first three of `channels` (3 or 4) floats of each pixel become scene-linear; alpha, not associated,
  // stays.
  void to_scene_linear(const std::string& space, bool is_byte, float* pixels, size_t pixel_count, int channels) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// The piecewise sRGB curve (IEC 61966-2-1), encoded to linear and back; any finite argument.
float srgb_to_linear(float encoded);
float linear_to_srgb(float linear);

}  // namespace gradus::image
