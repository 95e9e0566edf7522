// Conversion of colour spaces to scene-linear by OpenColorIO: the host's own, or the one of this library with the
// host's configuration.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace gradus::image {

// Converts pixels of red, green, blue and alpha to scene-linear in place. It may be called by several threads at once.
using ConvertColors = std::function<void(float* rgba, size_t pixel_count)>;

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

  // Sets the conversion of a space, which takes precedence over the configuration. Throws Error(INVALID_ARGUMENT) if
  // the name is empty.
  void set_conversion(const std::string& space, ConvertColors convert);

  // Returns the transform of `space`. An unknown name causes one warning; its transform is Srgb if `is_byte`, else
  // Data.
  ColorTransform transform(const std::string& space, bool is_byte) const;
  // Returns a number that depends on how the space is converted, or 0 for data and sRGB.
  uint64_t fingerprint(const std::string& space, bool is_byte) const;
  // Converts pixels of four channels in place. The first three become scene-linear. They must not be multiplied by
  // alpha, which OpenColorIO may change by a rounding error.
  void to_scene_linear(const std::string& space, bool is_byte, float* rgba, size_t pixel_count) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// The piecewise sRGB curve (IEC 61966-2-1) and its inverse, for any finite argument. Negative encoded values are black,
// as in Cycles.
float srgb_to_linear(float encoded);
float linear_to_srgb(float linear);

}  // namespace gradus::image
