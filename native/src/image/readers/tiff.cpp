// Reads TIFF and BigTIFF files with libtiff. The usual layouts (8 or 16 bit, half or float; grey to RGBA; strips or
// tiles) keep their values. Others (palettes, CMYK, LAB, other bit depths) go through libtiff's conversion to 8-bit
// RGBA.
#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <vector>

#include <tiffio.h>

#include "image/readers/decoded.h"

namespace gradus::image {
namespace {

// A file in memory, the position in it, and the text of its first error.
struct TiffSource {
  Bytes file;
  uint64_t position = 0;
  std::string message;
};

// The following functions let libtiff read from memory. Reading stops at the end of the file, as with a real file.
tmsize_t read_tiff_bytes(thandle_t handle, void* out, tmsize_t count) {
  TiffSource* source = static_cast<TiffSource*>(handle);
  const uint64_t left = source->position < source->file.size() ? source->file.size() - source->position : 0;
  const size_t n = std::min<uint64_t>(left, static_cast<uint64_t>(std::max<tmsize_t>(count, 0)));
  if (n > 0) {
    std::memcpy(out, source->file.data() + source->position, n);
  }
  source->position += n;
  return static_cast<tmsize_t>(n);
}
tmsize_t no_write(thandle_t, void*, tmsize_t) { return 0; }
toff_t seek(thandle_t handle, toff_t offset, int whence) {
  TiffSource* source = static_cast<TiffSource*>(handle);
  const uint64_t base = whence == SEEK_SET ? 0 : whence == SEEK_CUR ? source->position : source->file.size();
  source->position = base + offset;
  return source->position;
}
int close_nothing(thandle_t) { return 0; }
toff_t size_of(thandle_t handle) { return static_cast<TiffSource*>(handle)->file.size(); }
int no_map(thandle_t, void**, toff_t*) { return 0; }
void no_unmap(thandle_t, void*, toff_t) {}

// Keeps the first error of this file. The handler is set for this file only, because the process-wide ones belong to
// the host.
int on_tiff_error(TIFF*, void* user, const char*, const char* format, va_list arguments) {
  TiffSource* source = static_cast<TiffSource*>(user);
  if (source->message.empty()) {
    char text[200];
    std::vsnprintf(text, sizeof(text), format, arguments);
    source->message = text;
  }
  return 1;
}
int on_tiff_warning(TIFF*, void*, const char*, const char*, va_list) { return 1; }

// An open TIFF file; get() is nullptr if it could not be opened.
class Tiff {
 public:
  explicit Tiff(TiffSource* source) {
    TIFFOpenOptions* options = TIFFOpenOptionsAlloc();
    TIFFOpenOptionsSetErrorHandlerExtR(options, on_tiff_error, source);
    TIFFOpenOptionsSetWarningHandlerExtR(options, on_tiff_warning, source);
    TIFFOpenOptionsSetMaxSingleMemAlloc(options, tmsize_t{1} << 32);
    handle_ = TIFFClientOpenExt("image", "rm", source, read_tiff_bytes, no_write, seek, close_nothing, size_of, no_map,
                                no_unmap, options);
    TIFFOpenOptionsFree(options);
  }
  ~Tiff() {
    if (handle_) {
      TIFFClose(handle_);
    }
  }
  Tiff(const Tiff&) = delete;
  Tiff& operator=(const Tiff&) = delete;
  TIFF* get() const { return handle_; }

 private:
  TIFF* handle_ = nullptr;
};

// The tags of a TIFF file that determine how its pixels are stored, with the defaults of the TIFF specification.
struct Layout {
  uint32_t width = 0;
  uint32_t height = 0;
  uint16_t bits = 1;
  uint16_t samples = 1;
  uint16_t sample_format = SAMPLEFORMAT_UINT;
  uint16_t planes = PLANARCONFIG_CONTIG;
  uint16_t photometric = 0;
  uint16_t orientation = ORIENTATION_TOPLEFT;
  bool associated = false;  // colours are multiplied by alpha

  // Returns whether the values can be copied as they are, without libtiff's conversion.
  bool direct() const {
    const bool depth = (sample_format == SAMPLEFORMAT_UINT && (bits == 8 || bits == 16)) ||
                       (sample_format == SAMPLEFORMAT_IEEEFP && (bits == 16 || bits == 32));
    const bool colour =
        photometric == PHOTOMETRIC_RGB ? samples >= 3 : photometric == PHOTOMETRIC_MINISBLACK && samples >= 1;
    return depth && colour && orientation == ORIENTATION_TOPLEFT;
  }
  PixelFormat format() const {
    if (sample_format == SAMPLEFORMAT_IEEEFP) {
      return bits == 16 ? PixelFormat::Half : PixelFormat::Float;
    }
    return bits == 16 ? PixelFormat::Short : PixelFormat::Byte;
  }
  // Returns the number of channels to read. Extra samples beyond alpha are left out.
  uint32_t channels() const {
    const uint32_t wanted = photometric == PHOTOMETRIC_RGB ? (samples >= 4 ? 4u : 3u) : (samples >= 2 ? 2u : 1u);
    return wanted;
  }
};

// Reads the layout. Returns false if a required tag is missing.
bool read_layout(TIFF* tiff, Layout* layout) {
  uint16_t extra_count = 0;
  uint16_t* extra = nullptr;
  if (!TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &layout->width) ||
      !TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &layout->height) ||
      !TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &layout->photometric)) {
    return false;
  }
  TIFFGetFieldDefaulted(tiff, TIFFTAG_BITSPERSAMPLE, &layout->bits);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLESPERPIXEL, &layout->samples);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLEFORMAT, &layout->sample_format);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_PLANARCONFIG, &layout->planes);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_ORIENTATION, &layout->orientation);
  if (TIFFGetField(tiff, TIFFTAG_EXTRASAMPLES, &extra_count, &extra) && extra_count > 0 && extra) {
    layout->associated = extra[0] == EXTRASAMPLE_ASSOCALPHA;
  }
  return layout->sample_format != SAMPLEFORMAT_VOID || (layout->sample_format = SAMPLEFORMAT_UINT);
}

// A decoded block, which is a strip or a tile, of one plane or of all interleaved samples.
struct Block {
  uint32_t x0;     // left column in the image
  uint32_t y0;     // top row in the image
  uint32_t width;  // width in the buffer, which may reach beyond the image
  uint32_t height;
  uint32_t samples;  // interleaved samples per pixel in the buffer
  uint32_t plane;    // first channel of the image that the block fills
};
// Copies a block from the buffer into the image.
void copy_block(const uint8_t* data, const Block& block, DecodedImage* image) {
  const size_t bytes = bytes_per_channel(image->format);
  const uint32_t columns = std::min(block.width, image->width - block.x0);
  const uint32_t rows = std::min(block.height, image->height - block.y0);
  const uint32_t used = std::min(block.samples, image->channels - block.plane);
  for (uint32_t y = 0; y < rows; y++) {
    const uint8_t* in = data + static_cast<size_t>(y) * block.width * block.samples * bytes;
    uint8_t* out =
        image->row_from_top(block.y0 + y) + (static_cast<size_t>(block.x0) * image->channels + block.plane) * bytes;
    for (uint32_t x = 0; x < columns; x++, in += block.samples * bytes, out += image->channels * bytes) {
      std::memcpy(out, in, used * bytes);
    }
  }
}

// Reads all strips or tiles of a file with a direct layout into the image.
bool read_blocks(TIFF* tiff, const Layout& layout, DecodedImage* image, std::string* problem) {
  const bool tiled = TIFFIsTiled(tiff) != 0;
  uint32_t width = layout.width;
  uint32_t height = layout.height;
  if (tiled) {
    if (!TIFFGetField(tiff, TIFFTAG_TILEWIDTH, &width) || !TIFFGetField(tiff, TIFFTAG_TILELENGTH, &height)) {
      return false;
    }
  } else {
    TIFFGetFieldDefaulted(tiff, TIFFTAG_ROWSPERSTRIP, &height);
    height = std::min(height, layout.height);
  }
  const bool separate = layout.planes == PLANARCONFIG_SEPARATE;
  const uint32_t samples = separate ? 1 : layout.samples;
  const uint64_t needed = static_cast<uint64_t>(width) * height * samples * bytes_per_channel(image->format);
  if (width == 0 || height == 0 || needed > (1ull << 32)) {
    *problem = "its blocks are too large";
    return false;
  }
  const tmsize_t size = tiled ? TIFFTileSize(tiff) : TIFFStripSize(tiff);
  if (size <= 0 || static_cast<uint64_t>(size) < needed) {
    *problem = "its blocks have a wrong size";
    return false;
  }
  const auto buffer = std::make_unique_for_overwrite<uint8_t[]>(static_cast<size_t>(size));
  for (uint32_t plane = 0; plane < (separate ? image->channels : 1); plane++) {
    for (uint32_t y = 0; y < layout.height; y += height) {
      for (uint32_t x = 0; x < layout.width; x += width) {
        const uint16_t s = static_cast<uint16_t>(plane);
        const tmsize_t got = tiled ? TIFFReadEncodedTile(tiff, TIFFComputeTile(tiff, x, y, 0, s), buffer.get(), size)
                                   : TIFFReadEncodedStrip(tiff, TIFFComputeStrip(tiff, y, s), buffer.get(), size);
        const uint64_t rows = tiled ? height : std::min(height, layout.height - y);
        if (got < 0 || static_cast<uint64_t>(got) < needed / height * rows) {
          return false;
        }
        copy_block(buffer.get(), {x, y, width, static_cast<uint32_t>(rows), samples, plane}, image);
      }
    }
  }
  return true;
}

// Reads a file of any other layout as 8-bit RGBA with libtiff's conversion.
bool read_converted(TIFF* tiff, const Layout& layout, size_t file_bytes, DecodedImage* image, std::string* problem) {
  if (!allocate(image, layout.width, layout.height, 4, PixelFormat::Byte, file_bytes, 20000, problem)) {
    return false;
  }
  image->associated_alpha = true;
  // libtiff writes uint32 pixels with R in the lowest byte, which is RGBA in memory, with the bottom row first.
  uint32_t* raster = reinterpret_cast<uint32_t*>(image->pixels.get());
  return TIFFReadRGBAImageOriented(tiff, image->width, image->height, raster, ORIENTATION_BOTLEFT, 1) != 0;
}

}  // namespace

bool read_tiff(Bytes file, DecodedImage* image, std::string* problem) {
  TiffSource source{file, 0, {}};
  const Tiff tiff(&source);
  Layout layout;
  bool ok = tiff.get() && read_layout(tiff.get(), &layout);
  if (ok && layout.direct()) {
    ok = allocate(image, layout.width, layout.height, layout.channels(), layout.format(), file.size(), 20000, problem);
    image->associated_alpha = layout.associated;
    ok = ok && read_blocks(tiff.get(), layout, image, problem);
  } else if (ok) {
    ok = read_converted(tiff.get(), layout, file.size(), image, problem);
  }
  if (!ok && problem->empty()) {
    *problem = source.message.empty() ? "it is damaged" : source.message;
  }
  return ok;
}

}  // namespace gradus::image
