// Image files in memory, for the tests of readers: four colours, or any pattern.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "base/types.h"

namespace gradus::test {

using FileBytes = std::vector<uint8_t>;

// Colour of a texel, x to the right, y up, both in 0…1.
using Pattern = std::function<Vec4(float x, float y)>;
// Returns red at the lower left, green at the lower right, blue at the upper left, white at the upper right; opaque.
Vec4 four_colors(float x, float y);

struct PngOptions {
  int bits = 8;      // 8 or 16
  int channels = 4;  // 1 to 4
  bool interlaced = false;
};
FileBytes make_png(uint32_t width, uint32_t height, const Pattern& pattern, const PngOptions& options = {});
// Returns a file with two bits per pixel and a palette.
FileBytes make_palette_png(uint32_t width, uint32_t height);

FileBytes make_jpeg(uint32_t width, uint32_t height, const Pattern& pattern, bool grey = false,
                    bool progressive = false);

struct TiffOptions {
  int bits = 8;  // 8, 16, or 32 for float
  int channels = 3;
  bool tiled = false;
  bool separate = false;
  int compression = 1;  // as in tiff.h
};
FileBytes make_tiff(uint32_t width, uint32_t height, const Pattern& pattern, const TiffOptions& options = {});

struct ExrOptions {
  std::string channels = "RGBA";  // one letter each; "Z" and others may follow
  std::string layer;              // prefix with its dot
  int type = 1;                   // as in ImfPixelType.h: 0 uint, 1 half, 2 float
  int compression = 3;            // as in ImfCompression.h
  bool tiled = false;
  bool multipart = false;
  bool bottom_up = false;
  int offset_x = 0;  // of the data window
  int offset_y = 0;
};
FileBytes make_exr(uint32_t width, uint32_t height, const Pattern& pattern, const ExrOptions& options = {});
FileBytes make_deep_exr();

// Returns an HDR file. runs: uses the newer run-length code, which requires a width of at least 8.
FileBytes make_hdr(uint32_t width, uint32_t height, const Pattern& pattern, bool runs = true);

}  // namespace gradus::test
