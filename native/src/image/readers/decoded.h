// What image readers deliver, and the limits they keep to. All readers take files as bytes in memory, treat them as
// hostile, and report what is wrong as text.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace gradus::image {

enum class PixelFormat : uint8_t { Byte, Short, Half, Float };  // 8 and 16 bit: 1.0 is the largest number

inline size_t bytes_per_channel(PixelFormat format) {
  return format == PixelFormat::Byte ? 1 : format == PixelFormat::Float ? 4 : 2;
}

struct DecodedImage {
  uint32_t width = 0;
  uint32_t height = 0;
  uint32_t channels = 0;  // 1 grey, 2 grey and alpha, 3 RGB, 4 RGBA; interleaved
  PixelFormat format = PixelFormat::Byte;
  bool associated_alpha = false;      // colour is multiplied by alpha in the file
  std::unique_ptr<uint8_t[]> pixels;  // bottom row first
  std::string warning;                // read, but something was wrong

  size_t row_bytes() const { return static_cast<size_t>(width) * channels * bytes_per_channel(format); }
  size_t size_bytes() const { return row_bytes() * height; }
  uint8_t* row_from_top(uint32_t y) { return pixels.get() + row_bytes() * (height - 1 - y); }
};

// Largest image: 2^30 pixels, 2^17 on a side.
inline constexpr uint64_t kMaxPixels = 1ull << 30;
inline constexpr uint64_t kMaxSide = 1ull << 17;

// Sets size and layout and reserves the pixels (not touched, so that a false header costs no memory). False, with a
// text, where the size is impossible, or a file of `file_bytes` cannot hold that many bytes at `ratio` times
// compression.
bool allocate(DecodedImage* image, uint64_t width, uint64_t height, uint32_t channels, PixelFormat format,
              size_t file_bytes, uint64_t ratio, std::string* problem);

using Bytes = std::span<const uint8_t>;

bool read_png(Bytes file, DecodedImage* image, std::string* problem);
bool read_jpeg(Bytes file, DecodedImage* image, std::string* problem);
bool read_tiff(Bytes file, DecodedImage* image, std::string* problem);
bool read_exr(Bytes file, DecodedImage* image, std::string* problem);
bool read_hdr(Bytes file, DecodedImage* image, std::string* problem);

// By the first bytes, whatever the file is called.
bool read_image(Bytes file, DecodedImage* image, std::string* problem);

}  // namespace gradus::image
