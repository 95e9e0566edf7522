// Pixels of one image, ready for look-ups.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/types.h"
#include "image/readers/decoded.h"

namespace gradus::image {

struct ImageTile {
  uint32_t number = 0;  // UDIM; 0 = not tiled
  uint32_t width = 0;   // 0: could not be read
  uint32_t height = 0;
  uint32_t channels = 0;  // as in DecodedImage
  PixelFormat format = PixelFormat::Byte;
  bool srgb = false;                  // interpolated as encoded, then made linear, as Cycles does with 8 bit images
  std::unique_ptr<uint8_t[]> pixels;  // bottom row first; alpha associated, if it is at all

  size_t size_bytes() const { return static_cast<size_t>(width) * height * channels * bytes_per_channel(format); }
  // Stored value of a texel, alpha 1 where there is none. x < width, y < height.
  Vec4 texel(uint32_t x, uint32_t y) const;
};

class Image {
 public:
  std::string name;
  std::vector<ImageTile> tiles;
  std::vector<std::string> warnings;
  bool ignores_alpha = false;  // alpha reads 1
  bool has_alpha = false;      // some texel is not opaque
  Rgb mean = Rgb(0.0f);        // scene-linear
  uint64_t content_hash = 0;   // of what it was made of, wherever that lies
};

// Stored value to scene-linear; outside 0…1 by the formula.
Vec4 decode_texel(const ImageTile& tile, const Vec4& stored);

}  // namespace gradus::image
