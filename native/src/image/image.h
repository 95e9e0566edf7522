// The pixels of one image, stored for look-ups.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/types.h"
#include "image/readers/decoded.h"

namespace gradus::image {

struct ImageTile {
  uint32_t number = 0;  // UDIM number; 0 if the image is not tiled
  uint32_t width = 0;   // 0 if the tile could not be read
  uint32_t height = 0;
  uint32_t channels = 0;  // as in DecodedImage
  PixelFormat format = PixelFormat::Byte;
  bool srgb = false;                  // sRGB values, converted after interpolation, as Cycles does
  bool is_opaque_outside = false;     // look-ups outside a clipped image return alpha 1
  std::shared_ptr<uint8_t[]> pixels;  // bottom row first; colours are multiplied by alpha if the image associates it
  // The tile at a quarter of the resolution, for look-ups of colours as they are stored, and of colours that are
  // divided by alpha; null: there is none.
  std::shared_ptr<const ImageTile> coarser, coarser_straight;

  size_t size_bytes() const { return static_cast<size_t>(width) * height * channels * bytes_per_channel(format); }
  // Returns the stored value of a texel, with alpha 1 if there is no alpha channel. x < width and y < height.
  Vec4 texel(uint32_t x, uint32_t y) const;
};

class Image {
 public:
  std::string name;
  std::vector<ImageTile> tiles;
  std::vector<std::string> warnings;
  bool ignores_alpha = false;     // all texels count as opaque
  bool has_alpha = false;         // some texel is not opaque
  bool associates_alpha = false;  // colours are multiplied by alpha
  Rgb mean = Rgb(0.0f);           // scene-linear mean colour
  uint64_t content_hash = 0;      // hash of the source data and settings, independent of paths
};

// Converts a stored value to scene-linear. sRGB values outside 0…1 take the exact formula instead of a table.
Vec4 decode_texel(const ImageTile& tile, const Vec4& stored);

}  // namespace gradus::image
