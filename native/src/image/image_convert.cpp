#include "image/image_convert.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include <half.h>

#include "image/color.h"

namespace gradus::image {
namespace {

float half_to_float(uint16_t bits) {
  Imath::half h;
  h.setBits(bits);
  return h;
}
// Converts to half precision. Values beyond its range become its largest number, not infinity.
uint16_t float_to_half(float x) { return Imath::half(std::clamp(x, -65504.0f, 65504.0f)).bits(); }

bool has_alpha_channel(uint32_t channels) { return channels == 2 || channels == 4; }

// Pixels that are converted by one call. A call of the host's OpenColorIO costs as much as a thousand pixels.
constexpr uint32_t kPixelsPerCall = 1 << 16;

// Converts rows of any format, from row `first` on, to floats of red, green, blue and alpha.
void unpack_rows(const ImageTile& tile, uint32_t first, uint32_t count, std::vector<Vec4>* pixels) {
  pixels->clear();
  for (uint32_t y = first; y < first + count; y++)
    for (uint32_t x = 0; x < tile.width; x++) pixels->push_back(tile.texel(x, y));
}

void scale_colors(Vec4* v, float factor) { *v = Vec4(v->x * factor, v->y * factor, v->z * factor, v->w); }

bool is_translucent(float alpha) { return alpha > 0.0f && alpha != 1.0f; }

// Rounds a texel to half precision.
void round_to_half(Vec4* v) {
  for (int c = 0; c < 4; c++) (*v)[c] = half_to_float(float_to_half((*v)[c]));
}

// Converts pixels to scene-linear as Cycles does: colours are multiplied by alpha, converted without it, and multiplied
// again. Where alpha is 0, straight colours are black before the conversion, which need not map black to black. If
// `is_half`, what Cycles stores in between is rounded, which logarithmic spaces magnify.
void transform_pixels(const ColorManager& color, const std::string& space, bool is_byte, bool is_half,
                      AlphaRelation relation, std::vector<Vec4>* pixels, std::vector<float>* alphas) {
  alphas->resize(pixels->size());
  for (size_t i = 0; i < pixels->size(); i++) {
    Vec4& v = (*pixels)[i];
    if (is_half) round_to_half(&v);
    if (relation == AlphaRelation::Straight) {
      scale_colors(&v, v.w);
      if (is_half) round_to_half(&v);
    }
    (*alphas)[i] = v.w;
    if (relation != AlphaRelation::None && is_translucent(v.w)) scale_colors(&v, 1.0f / v.w);
  }
  color.to_scene_linear(space, is_byte, &pixels->front().x, pixels->size());
  for (size_t i = 0; i < pixels->size(); i++) {
    Vec4& v = (*pixels)[i];
    v.w = (*alphas)[i];
    if (relation != AlphaRelation::None && is_translucent(v.w)) scale_colors(&v, v.w);
  }
}

// Stores a value at position `index`, as half if the format is Half, else as float.
void store_value(uint8_t* pixels, PixelFormat format, size_t index, float value) {
  if (format == PixelFormat::Half) {
    const uint16_t bits = float_to_half(value);
    std::memcpy(pixels + index * 2, &bits, 2);
  } else {
    std::memcpy(pixels + index * 4, &value, 4);
  }
}

// Returns a copy of the tile, converted to scene-linear a few rows at a time, with associated alpha unless there is no
// relation. It has 3 or 4 channels, and stores floats if the source does, else halves.
ImageTile transform_tile(const ImageTile& source, const ColorManager& color, const std::string& space, bool is_byte,
                         AlphaRelation relation) {
  ImageTile tile;
  tile.number = source.number;
  tile.width = source.width;
  tile.height = source.height;
  tile.channels = has_alpha_channel(source.channels) ? 4 : 3;
  tile.format = source.format == PixelFormat::Float ? PixelFormat::Float : PixelFormat::Half;
  tile.pixels = std::make_unique_for_overwrite<uint8_t[]>(tile.size_bytes());
  const uint32_t rows = std::max(kPixelsPerCall / tile.width, 1u);
  std::vector<Vec4> pixels;
  std::vector<float> alphas;
  size_t stored = 0;
  for (uint32_t y = 0; y < tile.height; y += rows) {
    unpack_rows(source, y, std::min(rows, tile.height - y), &pixels);
    transform_pixels(color, space, is_byte, tile.format == PixelFormat::Half, relation, &pixels, &alphas);
    for (const Vec4& v : pixels) {
      for (int c = 0; c < static_cast<int>(tile.channels); c++) {
        store_value(tile.pixels.get(), tile.format, stored++, v[c]);
      }
    }
  }
  return tile;
}

// Converts a tile of 16-bit sRGB values, integers or halves, to linear halves in place. A table of all 65,536 values
// replaces the formula. Values that are not finite become 0.
void linearise_shorts(ImageTile* tile) {
  const bool half = tile->format == PixelFormat::Half;
  std::vector<uint16_t> table(65536);
  std::vector<uint16_t> alpha_table(65536);
  for (uint32_t i = 0; i < 65536; i++) {
    const float value = half ? half_to_float(static_cast<uint16_t>(i)) : static_cast<float>(i) * (1.0f / 65535.0f);
    table[i] = float_to_half(is_finite(value) ? srgb_to_linear(value) : 0.0f);
    alpha_table[i] = float_to_half(is_finite(value) ? value : 0.0f);
  }
  const uint32_t alpha = has_alpha_channel(tile->channels) ? tile->channels - 1 : UINT32_MAX;
  uint16_t* values = reinterpret_cast<uint16_t*>(tile->pixels.get());
  const size_t count = static_cast<size_t>(tile->width) * tile->height;
  for (size_t i = 0; i < count; i++, values += tile->channels) {
    for (uint32_t c = 0; c < tile->channels; c++) {
      values[c] = c == alpha ? alpha_table[values[c]] : table[values[c]];
    }
  }
  tile->format = PixelFormat::Half;
}

// Multiplies the colours of `count` pixels by alpha, which is the last of `channels`, with multiply(colour, alpha).
template <typename T, typename Multiply>
void associate(T* values, size_t count, uint32_t channels, Multiply multiply) {
  for (size_t i = 0; i < count; i++, values += channels) {
    for (uint32_t c = 0; c + 1 < channels; c++) {
      values[c] = multiply(values[c], values[channels - 1]);
    }
  }
}

// Multiplies the colours of a tile by alpha. Bytes and shorts are rounded down, as in Cycles.
void associate_alpha(ImageTile* tile) {
  const size_t count = static_cast<size_t>(tile->width) * tile->height;
  uint8_t* pixels = tile->pixels.get();
  switch (tile->format) {
    case PixelFormat::Byte:
      associate(pixels, count, tile->channels, [](uint8_t c, uint8_t a) { return static_cast<uint8_t>(c * a / 255); });
      break;
    case PixelFormat::Short:
      associate(reinterpret_cast<uint16_t*>(pixels), count, tile->channels,
                [](uint16_t c, uint16_t a) { return static_cast<uint16_t>(static_cast<uint32_t>(c) * a / 65535u); });
      break;
    case PixelFormat::Half:
      associate(reinterpret_cast<uint16_t*>(pixels), count, tile->channels,
                [](uint16_t c, uint16_t a) { return float_to_half(half_to_float(c) * half_to_float(a)); });
      break;
    case PixelFormat::Float:
      associate(reinterpret_cast<float*>(pixels), count, tile->channels, [](float c, float a) { return c * a; });
      break;
  }
}

// Sets all channels of a texel to 0 if one of them is not finite, as Cycles does.
template <typename T, typename Finite>
void clean(T* values, size_t count, uint32_t channels, Finite finite) {
  for (size_t i = 0; i < count; i++, values += channels) {
    if (!std::all_of(values, values + channels, finite)) {
      std::fill(values, values + channels, T(0));
    }
  }
}

// Encoded values beyond it would become infinite when they are decoded.
constexpr float kMaximumEncoded = 1e12f;

// Removes infinities and NaN from a tile of halves or floats, before and after decoding; integers have none. A half is
// infinite or NaN if all bits of its exponent are set.
void clean_tile(ImageTile* tile) {
  const size_t count = static_cast<size_t>(tile->width) * tile->height;
  if (tile->format == PixelFormat::Half) {
    clean(reinterpret_cast<uint16_t*>(tile->pixels.get()), count, tile->channels,
          [](uint16_t h) { return (h & 0x7c00) != 0x7c00; });
  } else if (tile->format == PixelFormat::Float) {
    const float maximum = tile->srgb ? kMaximumEncoded : std::numeric_limits<float>::max();
    clean(reinterpret_cast<float*>(tile->pixels.get()), count, tile->channels,
          [maximum](float x) { return std::fabs(x) <= maximum; });
  }
}

template <class T>
const T* as(const uint8_t* pixels) {
  return reinterpret_cast<const T*>(pixels);
}

// Expands a texel of 1 to 4 channels to RGBA. Grey fills all colours, and a missing alpha is 1. There is no loop over
// the channels, because every texture look-up runs through this function.
template <class T, class ToFloat>
Vec4 expand(const T* v, uint32_t channels, ToFloat&& to_float) {
  const float first = to_float(v[0]);
  if (channels <= 2) return Vec4(first, first, first, channels == 2 ? to_float(v[1]) : 1.0f);
  return Vec4(first, to_float(v[1]), to_float(v[2]), channels == 4 ? to_float(v[3]) : 1.0f);
}

using DecodedBytes = std::array<float, 256>;

// Returns the scene-linear values of all bytes.
DecodedBytes decoded_bytes(const ImageTile& tile) {
  DecodedBytes decoded;
  for (size_t i = 0; i < decoded.size(); ++i)
    decoded[i] = decode_texel(tile, Vec4(static_cast<float>(i) * (1.0f / 255.0f))).x;
  return decoded;
}

// Returns the scene-linear colour of a texel of bytes. Grey fills all colours.
Rgb byte_color(const ImageTile& tile, const DecodedBytes& decoded, size_t index) {
  const uint8_t* v = tile.pixels.get() + index * tile.channels;
  return tile.channels <= 2 ? Rgb(decoded[v[0]]) : Rgb(decoded[v[0]], decoded[v[1]], decoded[v[2]]);
}

// Returns the mean of color(index) over at most about a million texels of a tile.
template <class ColorAt>
Rgb mean_of_texels(const ImageTile& tile, const ColorAt& color) {
  const uint64_t count = static_cast<uint64_t>(tile.width) * tile.height;
  // The step is odd, so that images with a power of two as width are not sampled in the same columns of each row.
  const uint64_t step = (count >> 20) | 1u;
  glm::dvec3 sum(0.0);
  uint64_t n = 0;
  for (uint64_t i = 0; i < count; i += step, n++) sum += glm::dvec3(color(i));
  return Rgb(sum * (n > 0 ? 1.0 / static_cast<double>(n) : 0.0));
}

}  // namespace

Vec4 ImageTile::texel(uint32_t x, uint32_t y) const {
  const size_t first = (static_cast<size_t>(y) * width + x) * channels;
  switch (format) {
    case PixelFormat::Byte:
      return expand(pixels.get() + first, channels, [](uint8_t v) { return static_cast<float>(v) * (1.0f / 255.0f); });
    case PixelFormat::Short:
      return expand(as<uint16_t>(pixels.get()) + first, channels,
                    [](uint16_t v) { return static_cast<float>(v) * (1.0f / 65535.0f); });
    case PixelFormat::Half:
      return expand(as<uint16_t>(pixels.get()) + first, channels, half_to_float);
    case PixelFormat::Float:
      return expand(as<float>(pixels.get()) + first, channels, [](float v) { return v; });
  }
  return Vec4(0.0f);
}

ImageTile convert_tile(DecodedImage decoded, const ColorManager& color, const std::string& space, bool is_float,
                       AlphaRelation relation) {
  ImageTile tile;
  tile.width = decoded.width;
  tile.height = decoded.height;
  tile.channels = decoded.channels;
  // Cycles does not multiply grey, yet divides and multiplies it where it converts colours.
  if (relation == AlphaRelation::Straight && decoded.channels != 4) relation = AlphaRelation::Associated;
  tile.format = decoded.format;
  tile.pixels = std::move(decoded.pixels);
  const bool integer = tile.format == PixelFormat::Byte || tile.format == PixelFormat::Short;
  const ColorTransform transform = color.transform(space, integer);
  if (transform == ColorTransform::Srgb && (tile.format == PixelFormat::Byte || !is_float)) {
    tile.srgb = true;
  } else if (transform == ColorTransform::Srgb && tile.format != PixelFormat::Float) {
    linearise_shorts(&tile);
  } else if (transform == ColorTransform::Srgb) {
    tile = transform_tile(tile, color, space, integer, AlphaRelation::None);
  } else if (transform == ColorTransform::Other) {
    tile = transform_tile(tile, color, space, integer, relation);
  }
  if (relation == AlphaRelation::Straight && transform != ColorTransform::Other) {
    associate_alpha(&tile);
  }
  clean_tile(&tile);
  return tile;
}

Rgb mean_color(const ImageTile& tile) {
  return tile.format == PixelFormat::Byte
             ? mean_of_texels(tile,
                              [&, decoded = decoded_bytes(tile)](size_t i) { return byte_color(tile, decoded, i); })
             : mean_of_texels(tile, [&](size_t i) {
                 return Rgb(decode_texel(tile, tile.texel(uint32_t(i % tile.width), uint32_t(i / tile.width))));
               });
}

bool has_transparency(const ImageTile& tile) {
  if (!has_alpha_channel(tile.channels)) {
    return false;
  }
  for (uint32_t y = 0; y < tile.height; y++) {
    for (uint32_t x = 0; x < tile.width; x++) {
      if (tile.texel(x, y).w < 1.0f) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace gradus::image
