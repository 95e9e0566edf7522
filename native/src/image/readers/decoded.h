// The result of the image readers, and the limits that they enforce. All readers take files as bytes in memory, treat
// them as hostile, and report errors as text.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace gradus::image {

// Type of a channel. Byte and Short are unsigned integers of 8 and 16 bits, whose largest number stands for 1.0.
enum class PixelFormat : uint8_t { Byte, Short, Half, Float };

inline size_t bytes_per_channel(PixelFormat format) {
  return format == PixelFormat::Byte ? 1 : format == PixelFormat::Float ? 4 : 2;
}

// The pixels of an image file, with interleaved channels.
struct DecodedImage {
  uint32_t width = 0;
  uint32_t height = 0;
  uint32_t channels = 0;  // 1: grey, 2: grey and alpha, 3: RGB, 4: RGBA
  PixelFormat format = PixelFormat::Byte;
  bool associated_alpha = false;      // whether colours are multiplied by alpha in the file
  std::unique_ptr<uint8_t[]> pixels;  // bottom row first
  std::string warning;                // problem of a file that could be read nevertheless; empty if there is none

  size_t row_bytes() const { return static_cast<size_t>(width) * channels * bytes_per_channel(format); }
  size_t size_bytes() const { return row_bytes() * height; }
  // Returns row `y`, counted from the top of the picture.
  uint8_t* row_from_top(uint32_t y) { return pixels.get() + row_bytes() * (height - 1 - y); }
};

// Largest image that is read: 2^30 pixels, and 2^17 pixels on a side.
inline constexpr uint64_t kMaxPixels = 1ull << 30;
inline constexpr uint64_t kMaxSide = 1ull << 17;

// Sets size and layout of the image and allocates its pixels. It does not write to them, so that a wrong header
// occupies no physical memory. Returns false, with the reason in *problem, if the size is zero or above the limits, or
// if a file of `file_bytes` cannot hold so many pixels at a compression ratio of `ratio`.
bool allocate(DecodedImage* image, uint64_t width, uint64_t height, uint32_t channels, PixelFormat format,
              size_t file_bytes, uint64_t ratio, std::string* problem);

using Bytes = std::span<const uint8_t>;

// Each reader decodes a file of one format. It returns false, with the reason in *problem, if it cannot, and throws
// only std::bad_alloc.
bool read_png(Bytes file, DecodedImage* image, std::string* problem);
bool read_jpeg(Bytes file, DecodedImage* image, std::string* problem);
bool read_tiff(Bytes file, DecodedImage* image, std::string* problem);
bool read_exr(Bytes file, DecodedImage* image, std::string* problem);
bool read_hdr(Bytes file, DecodedImage* image, std::string* problem);

// Decodes a file of any of these formats. Its first bytes determine the format, not its name. Returns false, with the
// reason in *problem, if it cannot be decoded or needs too much memory.
bool read_image(Bytes file, DecodedImage* image, std::string* problem);

}  // namespace gradus::image
