// Reads PNG files of all kinds with libpng, as 8 or 16 bit and grey to RGBA. libpng reports errors by longjmp, so the
// functions that call setjmp hold no object with a destructor.
#include <csetjmp>
#include <cstring>
#include <vector>

#include <png.h>

#include "image/readers/decoded.h"

namespace gradus::image {
namespace {

// A file in memory, the position in it, and the text of the error that ended the decoding.
struct PngSource {
  const uint8_t* data;
  size_t size;
  size_t position;
  char message[200];
};

// Reads bytes from memory for libpng.
void read_png_bytes(png_structp png, png_bytep out, png_size_t length) {
  PngSource* source = static_cast<PngSource*>(png_get_io_ptr(png));
  if (length > source->size - source->position) {
    png_error(png, "it is truncated");
  }
  std::memcpy(out, source->data + source->position, length);
  source->position += length;
}

// Stores the error text and returns to the last setjmp.
void on_png_error(png_structp png, png_const_charp text) {
  PngSource* source = static_cast<PngSource*>(png_get_error_ptr(png));
  std::strncpy(source->message, text, sizeof(source->message) - 1);
  longjmp(png_jmpbuf(png), 1);
}

void on_png_warning(png_structp, png_const_charp) {}

// Reads the header and selects 8 or 16 bit grey or RGB for the output, with alpha if the file has any.
bool read_png_header(png_structp png, png_infop info, PngSource* source) {
  if (setjmp(png_jmpbuf(png))) {
    return false;
  }
  png_set_read_fn(png, source, read_png_bytes);
  // libpng itself refuses images that are larger than the limit.
  png_set_user_limits(png, static_cast<png_uint_32>(kMaxSide), static_cast<png_uint_32>(kMaxSide));
  png_set_chunk_malloc_max(png, 16u << 20);
  png_read_info(png, info);
  png_set_expand(png);
  if (png_get_bit_depth(png, info) == 16) {
    png_set_swap(png);  // the file is big-endian
  }
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
  return true;
}

bool read_rows(png_structp png, png_bytepp rows) {
  if (setjmp(png_jmpbuf(png))) {
    return false;
  }
  png_read_image(png, rows);
  return true;
}

bool decode_png(png_structp png, png_infop info, PngSource* source, DecodedImage* image, std::string* problem) {
  if (!read_png_header(png, info, source)) {
    *problem = source->message;
    return false;
  }
  const PixelFormat format = png_get_bit_depth(png, info) == 16 ? PixelFormat::Short : PixelFormat::Byte;
  // Deflate compresses by at most about 1030:1.
  if (!allocate(image, png_get_image_width(png, info), png_get_image_height(png, info), png_get_channels(png, info),
                format, source->size, 1100, problem)) {
    return false;
  }
  if (image->channels < 1 || image->channels > 4 || png_get_rowbytes(png, info) != image->row_bytes()) {
    *problem = "its layout is not supported";
    return false;
  }
  std::vector<png_bytep> rows(image->height);
  for (uint32_t y = 0; y < image->height; y++) {
    rows[y] = image->row_from_top(y);
  }
  if (!read_rows(png, rows.data())) {
    *problem = source->message;
    return false;
  }
  return true;
}

}  // namespace

bool read_png(Bytes file, DecodedImage* image, std::string* problem) {
  PngSource source{file.data(), file.size(), 0, {}};
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &source, on_png_error, on_png_warning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  bool ok = false;
  if (info) {
    ok = decode_png(png, info, &source, image, problem);
  } else {
    *problem = "libpng could not be initialised";
  }
  png_destroy_read_struct(&png, &info, nullptr);
  return ok;
}

}  // namespace gradus::image
