#include "image/builtin_spaces.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace gradus::image {
namespace {

// Names of spaces whose values need no conversion, because they are data or already scene-linear.
constexpr std::array<std::string_view, 10> kUnchanged = {
    "",       "Non-Color",      "Non-Colour Data", "Generic Data",    "Raw", "Utility - Raw",
    "Linear", "Linear Rec.709", "scene_linear",    "lin_rec709_scene"};
// Names of sRGB, as Blender's own and common OpenColorIO configurations spell it.
constexpr std::array<std::string_view, 5> kSrgb = {"sRGB", "sRGB - Texture", "Utility - sRGB - Texture", "srgb_tx",
                                                   "srgb_rec709_scene"};

}  // namespace

std::optional<ColorTransform> builtin_transform(const std::string& space) {
  if (std::find(kUnchanged.begin(), kUnchanged.end(), space) != kUnchanged.end()) {
    return ColorTransform::Data;
  }
  if (std::find(kSrgb.begin(), kSrgb.end(), space) != kSrgb.end()) {
    return ColorTransform::Srgb;
  }
  return std::nullopt;
}

}  // namespace gradus::image
