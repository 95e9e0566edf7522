// Conversion of colour spaces to scene-linear by OpenColorIO, with the host's configuration.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include "gradus/gradus.h"

namespace gradus::image {

// The conversion from a colour space to scene-linear.
enum class ColorTransform {
  Data,   // none, because the values are no colours (Non-Color, Raw, "") or already scene-linear
  Srgb,   // the sRGB curve alone, because the primaries are those of scene-linear
  Other,  // any other conversion, applied by to_scene_linear()
};

class ColorManager {
 public:
  using Warn = std::function<void(const std::string&)>;

  // Reads the OpenColorIO configuration at `config_path`, in UTF-8. If it is missing, unreadable or without a
  // scene-linear role it emits one warning, and only the built-in spaces, sRGB and linear, are known. Throws only
  // std::bad_alloc.
  ColorManager(const std::string& config_path, Warn warn);
  ~ColorManager();
  ColorManager(const ColorManager&) = delete;
  ColorManager& operator=(const ColorManager&) = delete;

  // Sets a space by baked values, which take precedence over the configuration. Throws Error(INVALID_ARGUMENT) if the
  // name is empty or a value is not finite.
  void set_override(const GradusColorSpace& space);

  // Returns the transform of `space`. An unknown name causes one warning; its transform is Srgb if `is_byte`, else
  // Data.
  ColorTransform transform(const std::string& space, bool is_byte) const;
  // Converts pixels of 3 or 4 `channels` in place. The first three become scene-linear. Alpha does not change, and the
  // colours must not be multiplied by it.
  void to_scene_linear(const std::string& space, bool is_byte, float* pixels, size_t pixel_count, int channels) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// The piecewise sRGB curve (IEC 61966-2-1) and its inverse, for any finite argument.
float srgb_to_linear(float encoded);
float linear_to_srgb(float linear);

}  // namespace gradus::image
