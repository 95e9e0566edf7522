// Reads JPEG files with libjpeg-turbo: grey, RGB, and CMYK as Adobe writes it. libjpeg reports errors by longjmp, so
// the functions that call setjmp hold no object with a destructor.
#include <csetjmp>
#include <cstdio>
#include <cstring>

#include <jerror.h>
#include <jpeglib.h>

#include "image/readers/decoded.h"

namespace gradus::image {
namespace {

// The decoder and the state of its error handlers.
struct Jpeg {
  jpeg_decompress_struct decoder;
  jpeg_error_mgr errors;
  std::jmp_buf jump;
  char message[JMSG_LENGTH_MAX];
  bool ended_early;          // the data ended before the end marker
  uint32_t rows_before_end;  // rows that were complete when the data ended
  uint32_t rows;             // rows that are complete so far
};

Jpeg* jpeg_of(j_common_ptr info) { return static_cast<Jpeg*>(info->client_data); }

// Stores the error text and returns to the last setjmp.
void on_jpeg_error(j_common_ptr info) {
  Jpeg* jpeg = jpeg_of(info);
  info->err->format_message(info, jpeg->message);
  std::longjmp(jpeg->jump, 1);
}

// Notes the first warning that the data ended early. Other warnings and messages are ignored.
void on_message(j_common_ptr info, int level) {
  Jpeg* jpeg = jpeg_of(info);
  if (level < 0 && info->err->msg_code == JWRN_JPEG_EOF && !jpeg->ended_early) {
    jpeg->ended_early = true;
    jpeg->rows_before_end = jpeg->rows;
  }
}

void no_output(j_common_ptr) {}

// Reads the header and selects the colour space of the output: CMYK, grey or RGB.
bool read_jpeg_header(Jpeg* jpeg, Bytes file) {
  if (setjmp(jpeg->jump)) {
    return false;
  }
  jpeg_mem_src(&jpeg->decoder, file.data(), file.size());
  jpeg_read_header(&jpeg->decoder, TRUE);
  const J_COLOR_SPACE space = jpeg->decoder.jpeg_color_space;
  const bool four = space == JCS_CMYK || space == JCS_YCCK;
  jpeg->decoder.out_color_space = four ? JCS_CMYK : space == JCS_GRAYSCALE ? JCS_GRAYSCALE : JCS_RGB;
  // The decoder keeps all coefficients of a progressive file in memory. Its limit is what the largest image needs.
  jpeg->decoder.mem->max_memory_to_use = 1l << 32;
  jpeg_calc_output_dimensions(&jpeg->decoder);
  return true;
}

bool start(Jpeg* jpeg) {
  if (setjmp(jpeg->jump)) {
    return false;
  }
  return jpeg_start_decompress(&jpeg->decoder) != 0;
}

bool read_jpeg_row(Jpeg* jpeg, uint8_t* row) {
  if (setjmp(jpeg->jump)) {
    return false;
  }
  JSAMPROW rows[1] = {row};
  jpeg_read_scanlines(&jpeg->decoder, rows, 1);
  return true;
}

// Converts a row of CMYK, which Adobe stores inverted (255 means no ink), to RGB.
void cmyk_to_rgb(const uint8_t* cmyk, uint8_t* rgb, uint32_t width) {
  for (uint32_t x = 0; x < width; x++, cmyk += 4, rgb += 3) {
    for (int c = 0; c < 3; c++) {
      rgb[c] = static_cast<uint8_t>(cmyk[c] * cmyk[3] / 255);
    }
  }
}

// Decodes the file into `image`. A file that ends early by at most 32 rows gives a warning, else an error.
bool decode_jpeg(Jpeg* jpeg, Bytes file, DecodedImage* image, std::string* problem) {
  if (!read_jpeg_header(jpeg, file)) {
    *problem = jpeg->message;
    return false;
  }
  const uint32_t components = jpeg->decoder.out_color_space == JCS_GRAYSCALE ? 1 : 3;
  // Each block of 64 pixels takes at least a few bits, so the compression ratio stays below 2000.
  if (!allocate(image, jpeg->decoder.output_width, jpeg->decoder.output_height, components, PixelFormat::Byte,
                file.size(), 2000, problem)) {
    return false;
  }
  const bool four = jpeg->decoder.out_color_space == JCS_CMYK;
  const std::unique_ptr<uint8_t[]> line = std::make_unique<uint8_t[]>(static_cast<size_t>(image->width) * 4);
  bool good = start(jpeg);
  for (uint32_t y = 0; good && y < image->height; y++) {
    uint8_t* row = image->row_from_top(y);
    jpeg->rows = y;
    good = read_jpeg_row(jpeg, four ? line.get() : row);
    if (good && four) {
      cmyk_to_rgb(line.get(), row, image->width);
    }
  }
  if (!good) {
    *problem = jpeg->message;
    return false;
  }
  // Some cameras and tools leave out only the end marker. The last blocks are then complete, and the image is usable.
  if (jpeg->ended_early && jpeg->rows_before_end + 32 < image->height) {
    *problem = "it is truncated";
    return false;
  }
  image->warning = jpeg->ended_early ? "it ends early" : "";
  return true;
}

}  // namespace

bool read_jpeg(Bytes file, DecodedImage* image, std::string* problem) {
  const std::unique_ptr<Jpeg> jpeg = std::make_unique<Jpeg>();
  jpeg->decoder.err = jpeg_std_error(&jpeg->errors);
  jpeg->errors.error_exit = on_jpeg_error;
  jpeg->errors.emit_message = on_message;
  jpeg->errors.output_message = no_output;
  jpeg->decoder.client_data = jpeg.get();
  if (setjmp(jpeg->jump)) {
    *problem = "libjpeg could not be initialised";
    return false;
  }
  jpeg_create_decompress(&jpeg->decoder);
  jpeg->decoder.client_data = jpeg.get();
  const bool ok = decode_jpeg(jpeg.get(), file, image, problem);
  jpeg_destroy_decompress(&jpeg->decoder);
  return ok;
}

}  // namespace gradus::image
