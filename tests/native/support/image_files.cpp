#include "support/image_files.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineOutputFile.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStdIO.h>
#include <ImfTiledOutputFile.h>
#include <half.h>
#include <jpeglib.h>
#include <png.h>
#include <tiffio.h>

namespace gradus::test {
namespace {

Vec4 at(const Pattern& pattern, uint32_t width, uint32_t height, uint32_t x, uint32_t row_from_top) {
  return pattern((static_cast<float>(x) + 0.5f) / static_cast<float>(width),
                 1.0f - (static_cast<float>(row_from_top) + 0.5f) / static_cast<float>(height));
}

// Returns a channel of a colour in the order of files with 1 to 4 channels.
float channel(const Vec4& c, int channels, int index) {
  if (channels <= 2) {
    return index == 0 ? c.x : c.w;
  }
  return c[index];
}

uint32_t quantise(float x, uint32_t largest) {
  return static_cast<uint32_t>(std::lround(std::clamp(x, 0.0f, 1.0f) * static_cast<float>(largest)));
}

// Returns the pixels, top row first, integers in the machine's byte order.
FileBytes raster(uint32_t width, uint32_t height, const Pattern& pattern, int channels, int bits) {
  FileBytes bytes;
  for (uint32_t y = 0; y < height; y++) {
    for (uint32_t x = 0; x < width; x++) {
      const Vec4 c = at(pattern, width, height, x, y);
      for (int k = 0; k < channels; k++) {
        const float value = channel(c, channels, k);
        uint8_t raw[4];
        if (bits == 8) {
          raw[0] = static_cast<uint8_t>(quantise(value, 255));
        } else if (bits == 16) {
          const uint16_t word = static_cast<uint16_t>(quantise(value, 65535));
          std::memcpy(raw, &word, 2);
        } else {
          std::memcpy(raw, &value, 4);
        }
        bytes.insert(bytes.end(), raw, raw + bits / 8);
      }
    }
  }
  return bytes;
}

void append_png(png_structp png, png_bytep data, png_size_t length) {
  FileBytes* out = static_cast<FileBytes*>(png_get_io_ptr(png));
  out->insert(out->end(), data, data + length);
}
void flush_png(png_structp) {}

FileBytes write_png(uint32_t width, uint32_t height, int type, int bits, bool interlaced, const FileBytes& pixels,
                    size_t row_bytes, const std::vector<png_color>& palette) {
  FileBytes out;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(png, &out, append_png, flush_png);
  png_set_IHDR(png, info, width, height, bits, type, interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (!palette.empty()) {
    png_set_PLTE(png, info, palette.data(), static_cast<int>(palette.size()));
  }
  png_write_info(png, info);
  if (bits == 16) {
    png_set_swap(png);
  }
  std::vector<png_bytep> rows;
  for (uint32_t y = 0; y < height; y++) {
    rows.push_back(const_cast<png_bytep>(pixels.data() + y * row_bytes));
  }
  png_write_image(png, rows.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return out;
}

}  // namespace

Vec4 four_colors(float x, float y) {
  if (y < 0.5f) {
    return x < 0.5f ? Vec4(1, 0, 0, 1) : Vec4(0, 1, 0, 1);
  }
  return x < 0.5f ? Vec4(0, 0, 1, 1) : Vec4(1, 1, 1, 1);
}

FileBytes make_png(uint32_t width, uint32_t height, const Pattern& pattern, const PngOptions& options) {
  constexpr int kTypes[] = {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB,
                            PNG_COLOR_TYPE_RGB_ALPHA};
  const FileBytes pixels = raster(width, height, pattern, options.channels, options.bits);
  const size_t row_bytes = static_cast<size_t>(width) * static_cast<size_t>(options.channels * options.bits / 8);
  return write_png(width, height, kTypes[options.channels - 1], options.bits, options.interlaced, pixels, row_bytes,
                   {});
}

FileBytes make_palette_png(uint32_t width, uint32_t height) {
  const size_t row_bytes = (width + 3) / 4;
  FileBytes pixels(row_bytes * height, 0);
  for (uint32_t y = 0; y < height; y++) {
    for (uint32_t x = 0; x < width; x++) {
      const unsigned index = (x < width / 2 ? 0u : 1u) + (y < height / 2 ? 2u : 0u);
      pixels[y * row_bytes + x / 4] = static_cast<uint8_t>(pixels[y * row_bytes + x / 4] | index << (6 - 2 * (x % 4)));
    }
  }
  return write_png(width, height, PNG_COLOR_TYPE_PALETTE, 2, false, pixels, row_bytes,
                   {{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {255, 255, 255}});
}

FileBytes make_jpeg(uint32_t width, uint32_t height, const Pattern& pattern, bool grey, bool progressive) {
  const int channels = grey ? 1 : 3;
  FileBytes pixels = raster(width, height, pattern, channels, 8);
  jpeg_compress_struct encoder;
  jpeg_error_mgr errors;
  encoder.err = jpeg_std_error(&errors);
  jpeg_create_compress(&encoder);
  unsigned char* data = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&encoder, &data, &size);
  encoder.image_width = width;
  encoder.image_height = height;
  encoder.input_components = channels;
  encoder.in_color_space = grey ? JCS_GRAYSCALE : JCS_RGB;
  jpeg_set_defaults(&encoder);
  jpeg_set_quality(&encoder, 95, TRUE);
  if (progressive) {
    jpeg_simple_progression(&encoder);
  }
  jpeg_start_compress(&encoder, TRUE);
  while (encoder.next_scanline < height) {
    JSAMPROW row = pixels.data() + static_cast<size_t>(encoder.next_scanline) * width * static_cast<size_t>(channels);
    jpeg_write_scanlines(&encoder, &row, 1);
  }
  jpeg_finish_compress(&encoder);
  jpeg_destroy_compress(&encoder);
  const FileBytes out(data, data + size);
  std::free(data);
  return out;
}

FileBytes make_tiff(uint32_t width, uint32_t height, const Pattern& pattern, const TiffOptions& options) {
  char path[] = "/tmp/gradus_tiff_XXXXXX";
  close(mkstemp(path));
  TIFF* tiff = TIFFOpen(path, "w");
  const size_t bytes = static_cast<size_t>(options.bits / 8);
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, width);
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, height);
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, options.bits);
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, options.channels);
  TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, options.bits == 32 ? SAMPLEFORMAT_IEEEFP : SAMPLEFORMAT_UINT);
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, options.channels >= 3 ? PHOTOMETRIC_RGB : PHOTOMETRIC_MINISBLACK);
  TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, options.separate ? PLANARCONFIG_SEPARATE : PLANARCONFIG_CONTIG);
  TIFFSetField(tiff, TIFFTAG_COMPRESSION, options.compression);
  if (options.channels == 2 || options.channels == 4) {
    const uint16_t kind = EXTRASAMPLE_UNASSALPHA;
    TIFFSetField(tiff, TIFFTAG_EXTRASAMPLES, 1, &kind);
  }
  const uint32_t block_width = options.tiled ? 16 : width;
  const uint32_t block_height = options.tiled ? 16 : 5;
  if (options.tiled) {
    TIFFSetField(tiff, TIFFTAG_TILEWIDTH, block_width);
    TIFFSetField(tiff, TIFFTAG_TILELENGTH, block_height);
  } else {
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, block_height);
  }
  const FileBytes pixels = raster(width, height, pattern, options.channels, options.bits);
  const size_t all = static_cast<size_t>(options.channels);
  const size_t planes = options.separate ? all : 1;
  const size_t samples = options.separate ? 1 : all;
  for (size_t plane = 0; plane < planes; plane++) {
    for (uint32_t y0 = 0; y0 < height; y0 += block_height) {
      for (uint32_t x0 = 0; x0 < width; x0 += block_width) {
        const uint32_t rows = options.tiled ? block_height : std::min(block_height, height - y0);
        FileBytes block(static_cast<size_t>(block_width) * rows * samples * bytes, 0);
        for (uint32_t y = 0; y < rows && y0 + y < height; y++) {
          for (uint32_t x = 0; x < block_width && x0 + x < width; x++) {
            const size_t from = ((static_cast<size_t>(y0 + y) * width + x0 + x) * all + plane) * bytes;
            const size_t to = (static_cast<size_t>(y) * block_width + x) * samples * bytes;
            std::memcpy(block.data() + to, pixels.data() + from, samples * bytes);
          }
        }
        const uint16_t s = static_cast<uint16_t>(plane);
        if (options.tiled) {
          TIFFWriteEncodedTile(tiff, TIFFComputeTile(tiff, x0, y0, 0, s), block.data(),
                               static_cast<tmsize_t>(block.size()));
        } else {
          TIFFWriteEncodedStrip(tiff, TIFFComputeStrip(tiff, y0, s), block.data(), static_cast<tmsize_t>(block.size()));
        }
      }
    }
  }
  TIFFClose(tiff);
  std::ifstream file(path, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  unlink(path);
  return FileBytes(text.begin(), text.end());
}

FileBytes make_exr(uint32_t width, uint32_t height, const Pattern& pattern, const ExrOptions& options) {
  const int w = static_cast<int>(width);
  const int h = static_cast<int>(height);
  const Imath::Box2i window({options.offset_x, options.offset_y}, {options.offset_x + w - 1, options.offset_y + h - 1});
  Imf::Header header(Imath::Box2i({0, 0}, {w - 1, h - 1}), window);
  header.compression() = static_cast<Imf::Compression>(options.compression);
  header.lineOrder() = options.bottom_up ? Imf::DECREASING_Y : Imf::INCREASING_Y;
  const Imf::PixelType type = static_cast<Imf::PixelType>(options.type);
  const size_t size = type == Imf::HALF ? 2 : 4;
  const size_t count = options.channels.size();
  FileBytes pixels(static_cast<size_t>(width) * height * count * size);
  for (uint32_t y = 0; y < height; y++) {
    for (uint32_t x = 0; x < width; x++) {
      const Vec4 c = at(pattern, width, height, x, y);
      for (size_t k = 0; k < count; k++) {
        const char letter = options.channels[k];
        const float value = letter == 'G' ? c.y : letter == 'B' ? c.z : letter == 'A' ? c.w : c.x;
        uint8_t* out = pixels.data() + ((static_cast<size_t>(y) * width + x) * count + k) * size;
        if (type == Imf::HALF) {
          const uint16_t bits = Imath::half(value).bits();
          std::memcpy(out, &bits, 2);
        } else if (type == Imf::FLOAT) {
          std::memcpy(out, &value, 4);
        } else {
          const uint32_t number = static_cast<uint32_t>(value);
          std::memcpy(out, &number, 4);
        }
      }
    }
  }
  Imf::FrameBuffer buffer;
  const size_t x_stride = count * size;
  const size_t y_stride = x_stride * width;
  for (size_t k = 0; k < count; k++) {
    const std::string name = options.layer + options.channels[k];
    header.channels().insert(name, Imf::Channel(type));
    char* base = reinterpret_cast<char*>(pixels.data()) + k * size -
                 static_cast<ptrdiff_t>(x_stride) * options.offset_x -
                 static_cast<ptrdiff_t>(y_stride) * options.offset_y;
    buffer.insert(name, Imf::Slice(type, base, x_stride, y_stride));
  }
  Imf::StdOSStream stream;
  if (options.tiled) {
    header.setTileDescription(Imf::TileDescription(16, 16, Imf::MIPMAP_LEVELS));
    Imf::TiledOutputFile file(stream, header);
    file.setFrameBuffer(buffer);
    file.writeTiles(0, file.numXTiles(0) - 1, 0, file.numYTiles(0) - 1, 0);
    // Smaller levels hold garbage on purpose: only the full one is read.
    for (int level = 1; level < file.numLevels(); level++) {
      file.writeTiles(0, file.numXTiles(level) - 1, 0, file.numYTiles(level) - 1, level);
    }
  } else if (options.multipart) {
    header.setName("first");
    header.setType(Imf::SCANLINEIMAGE);
    Imf::Header second = header;
    second.setName("second");
    const Imf::Header headers[2] = {header, second};
    Imf::MultiPartOutputFile file(stream, headers, 2);
    for (int part = 0; part < 2; part++) {
      Imf::OutputPart output(file, part);
      output.setFrameBuffer(buffer);
      output.writePixels(h);
      std::fill(pixels.begin(), pixels.end(), uint8_t{0});
    }
  } else {
    Imf::OutputFile file(stream, header);
    file.setFrameBuffer(buffer);
    file.writePixels(h);
  }
  const std::string text = stream.str();
  return FileBytes(text.begin(), text.end());
}

FileBytes make_deep_exr() {
  Imf::Header header(4, 4);
  header.channels().insert("R", Imf::Channel(Imf::HALF));
  header.setType(Imf::DEEPSCANLINE);
  header.compression() = Imf::ZIPS_COMPRESSION;
  Imf::StdOSStream stream;
  {
    Imf::DeepScanLineOutputFile file(stream, header);
    std::vector<unsigned> counts(16, 0);
    std::vector<char*> pointers(16, nullptr);
    Imf::DeepFrameBuffer buffer;
    buffer.insertSampleCountSlice(
        Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data()), sizeof(unsigned), 4 * sizeof(unsigned)));
    buffer.insert(
        "R", Imf::DeepSlice(Imf::HALF, reinterpret_cast<char*>(pointers.data()), sizeof(char*), 4 * sizeof(char*), 2));
    file.setFrameBuffer(buffer);
    file.writePixels(4);
  }
  const std::string text = stream.str();
  return FileBytes(text.begin(), text.end());
}

FileBytes make_hdr(uint32_t width, uint32_t height, const Pattern& pattern, bool runs) {
  const std::string header =
      "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(height) + " +X " + std::to_string(width) + "\n";
  FileBytes out(header.begin(), header.end());
  for (uint32_t y = 0; y < height; y++) {
    FileBytes row;
    for (uint32_t x = 0; x < width; x++) {
      const Vec4 c = at(pattern, width, height, x, y);
      int exponent = 0;
      const float largest = std::max({c.x, c.y, c.z});
      const float scale = largest > 1e-32f ? std::frexp(largest, &exponent) * 256.0f / largest : 0.0f;
      row.insert(row.end(),
                 {static_cast<uint8_t>(c.x * scale), static_cast<uint8_t>(c.y * scale),
                  static_cast<uint8_t>(c.z * scale), static_cast<uint8_t>(largest > 1e-32f ? exponent + 128 : 0)});
    }
    if (!runs) {
      out.insert(out.end(), row.begin(), row.end());
      continue;
    }
    out.insert(out.end(), {2, 2, static_cast<uint8_t>(width >> 8), static_cast<uint8_t>(width & 255u)});
    for (uint32_t component = 0; component < 4; component++) {
      for (uint32_t x = 0; x < width;) {
        uint32_t n = 1;
        while (x + n < width && n < 127 && row[4 * (x + n) + component] == row[4 * x + component]) {
          n++;
        }
        if (n >= 3) {
          out.insert(out.end(), {static_cast<uint8_t>(128 + n), row[4 * x + component]});
          x += n;
        } else {
          out.insert(out.end(), {1, row[4 * x + component]});
          x += 1;
        }
      }
    }
  }
  return out;
}

}  // namespace gradus::test
