// Reads Radiance .hdr files (RGBE), uncompressed or with the old or the new run-length code.
// Source: Ward, "Real Pixels", Graphics Gems II, 1991.
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <vector>

#include "image/readers/decoded.h"

namespace gradus::image {
namespace {

// Reads lines and bytes from a file in memory.
class HdrReader {
 public:
  explicit HdrReader(Bytes file) : file_(file) {}
  // Reads up to the next line feed, which is skipped. Returns false if none follows.
  bool line(std::string_view* text) {
    const size_t start = position_;
    while (position_ < file_.size() && file_[position_] != '\n') {
      position_++;
    }
    if (position_ == file_.size()) {
      return false;
    }
    *text = std::string_view(reinterpret_cast<const char*>(file_.data()) + start, position_ - start);
    position_++;
    return true;
  }
  // Copies the next `count` bytes. Returns false if fewer are left.
  bool take(uint8_t* out, size_t count) {
    if (count > file_.size() - position_) {
      return false;
    }
    std::memcpy(out, file_.data() + position_, count);
    position_ += count;
    return true;
  }

 private:
  Bytes file_;
  size_t position_ = 0;
};

// Size and orientation of the picture.
struct Resolution {
  unsigned long width = 0;
  unsigned long height = 0;
  bool flip_x = false;  // rows run from right to left
  bool flip_y = false;  // the first row is the bottom one
};

// Parses a resolution line such as "-Y 480 +X 640". Orders with X first, which rotate the picture, are refused.
bool parse_resolution(std::string_view text, Resolution* resolution) {
  const std::string line(text.substr(0, 100));
  char sign_y = 0;
  char sign_x = 0;
  if (std::sscanf(line.c_str(), "%cY %9lu %cX %9lu", &sign_y, &resolution->height, &sign_x, &resolution->width) != 4) {
    return false;
  }
  resolution->flip_y = sign_y == '+';
  resolution->flip_x = sign_x == '-';
  return true;
}

// Reads a row of the new run-length code, which stores all values of each of the four components in turn. A count above
// 128 marks a run of count - 128 equal values. Returns false if the row is damaged.
bool read_planes(HdrReader* reader, std::vector<uint8_t>* row, size_t width) {
  for (size_t component = 0; component < 4; component++) {
    for (size_t x = 0; x < width;) {
      uint8_t head[2];
      if (!reader->take(head, 2)) {
        return false;
      }
      if (head[0] > 128) {
        const size_t count = head[0] - 128u;
        if (count > width - x) {
          return false;
        }
        for (size_t i = 0; i < count; i++) {
          (*row)[4 * (x++) + component] = head[1];
        }
        continue;
      }
      const size_t count = head[0];
      if (count == 0 || count > width - x) {
        return false;
      }
      std::array<uint8_t, 128> literals;
      literals[0] = head[1];
      if (!reader->take(literals.data() + 1, count - 1)) {
        return false;
      }
      for (size_t i = 0; i < count; i++) {
        (*row)[4 * (x++) + component] = literals[i];
      }
    }
  }
  return true;
}

// Reads a row of whole pixels, the first of which is `first`, in the old run-length code. A pixel (1, 1, 1, n) repeats
// the pixel before it n times; in a sequence of them each n counts 256 times as much as the one before. Returns false
// if the row is damaged.
bool read_pixels(HdrReader* reader, std::vector<uint8_t>* row, size_t width, const uint8_t first[4]) {
  uint8_t pixel[4] = {first[0], first[1], first[2], first[3]};
  unsigned shift = 0;
  for (size_t x = 0; x < width;) {
    const bool repeat = pixel[0] == 1 && pixel[1] == 1 && pixel[2] == 1;
    if (repeat) {
      const size_t count = shift > 24 ? width : static_cast<size_t>(pixel[3]) << shift;
      if (x == 0 || count > width - x) {
        return false;
      }
      for (size_t i = 0; i < count; i++, x++) {
        std::memcpy(&(*row)[4 * x], &(*row)[4 * (x - 1)], 4);
      }
      shift += 8;
    } else {
      std::memcpy(&(*row)[4 * x++], pixel, 4);
      shift = 0;
    }
    if (x < width && !reader->take(pixel, 4)) {
      return false;
    }
  }
  return true;
}

// Reads one row. The bytes 2 2 and the width mark the new run-length code, which is used for widths of 8 to 32767.
bool read_hdr_row(HdrReader* reader, std::vector<uint8_t>* row, size_t width) {
  uint8_t head[4];
  if (!reader->take(head, 4)) {
    return false;
  }
  const bool planes = width >= 8 && width < 32768 && head[0] == 2 && head[1] == 2 &&
                      (head[2] << 8 | head[3]) == static_cast<int>(width);
  return planes ? read_planes(reader, row, width) : read_pixels(reader, row, width, head);
}

// Converts a row from RGBE, which shares one exponent with bias 128, to RGB floats: component / 256 * 2^(e - 128).
void to_float(const std::vector<uint8_t>& row, float* out, size_t width, bool flip) {
  for (size_t x = 0; x < width; x++, out += 3) {
    const uint8_t* rgbe = &row[4 * (flip ? width - 1 - x : x)];
    const float scale = rgbe[3] ? std::ldexp(1.0f, rgbe[3] - 136) : 0.0f;
    for (int c = 0; c < 3; c++) {
      out[c] = static_cast<float>(rgbe[c]) * scale;
    }
  }
}

}  // namespace

bool read_hdr(Bytes file, DecodedImage* image, std::string* problem) {
  HdrReader reader(file);
  std::string_view text;
  bool in_header = true;
  while (in_header) {
    if (!reader.line(&text)) {
      *problem = "its header is incomplete";
      return false;
    }
    if (text.starts_with("FORMAT=") && !text.starts_with("FORMAT=32-bit_rle_rgbe")) {
      *problem = "its format " + std::string(text.substr(7, 40)) + " is not supported";
      return false;
    }
    in_header = !text.empty();
  }
  Resolution resolution;
  if (!reader.line(&text) || !parse_resolution(text, &resolution)) {
    *problem = "its header has no valid size";
    return false;
  }
  // In the new code a run of 127 pixels takes 8 bytes and becomes 1524. The old code compresses more.
  if (!allocate(image, resolution.width, resolution.height, 3, PixelFormat::Float, file.size(), 1u << 16, problem)) {
    return false;
  }
  std::vector<uint8_t> row(static_cast<size_t>(image->width) * 4);
  for (uint32_t y = 0; y < image->height; y++) {
    if (!read_hdr_row(&reader, &row, image->width)) {
      *problem = "it is truncated or damaged";
      return false;
    }
    uint8_t* out = image->row_from_top(resolution.flip_y ? image->height - 1 - y : y);
    to_float(row, reinterpret_cast<float*>(out), image->width, resolution.flip_x);
  }
  return true;
}

}  // namespace gradus::image
