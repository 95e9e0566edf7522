#include <cstring>
#include <new>

#include "image/readers/decoded.h"

namespace gradus::image {
namespace {

bool starts_with(Bytes file, const char* magic, size_t length) {
  return file.size() >= length && std::memcmp(file.data(), magic, length) == 0;
}

using Reader = bool (*)(Bytes, DecodedImage*, std::string*);
// A file format with the bytes that its files begin with.
struct Format {
  const char* magic;
  size_t length;
  Reader reader;
};
constexpr Format kFormats[] = {
    {"\x89PNG", 4, read_png},          {"\xff\xd8\xff", 3, read_jpeg},
    {"II*\0", 4, read_tiff},           {"MM\0*", 4, read_tiff},
    {"II+\0", 4, read_tiff},           {"MM\0+", 4, read_tiff},
    {"\x76\x2f\x31\x01", 4, read_exr}, {"#?", 2, read_hdr},
};

}  // namespace

bool allocate(DecodedImage* image, uint64_t width, uint64_t height, uint32_t channels, PixelFormat format,
              size_t file_bytes, uint64_t ratio, std::string* problem) {
  if (width == 0 || height == 0) {
    *problem = "it has no pixels";
    return false;
  }
  if (width > kMaxSide || height > kMaxSide || width * height > kMaxPixels) {
    *problem = "its size of " + std::to_string(width) + " x " + std::to_string(height) + " is too large";
    return false;
  }
  image->width = static_cast<uint32_t>(width);
  image->height = static_cast<uint32_t>(height);
  image->channels = channels;
  image->format = format;
  if (image->size_bytes() / ratio > file_bytes) {
    *problem = "it is truncated, or its header is wrong";
    return false;
  }
  image->pixels = std::make_unique_for_overwrite<uint8_t[]>(image->size_bytes());
  return true;
}

bool read_image(Bytes file, DecodedImage* image, std::string* problem) {
  if (file.empty()) {
    *problem = "it is empty";
    return false;
  }
  for (const Format& format : kFormats) {
    if (starts_with(file, format.magic, format.length)) {
      try {
        return format.reader(file, image, problem);
      } catch (const std::bad_alloc&) {
        *problem = "it needs too much memory";
        return false;
      }
    }
  }
  *problem = "its format is not known";
  return false;
}

}  // namespace gradus::image
