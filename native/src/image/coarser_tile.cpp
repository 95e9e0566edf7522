#include "image/coarser_tile.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <half.h>

#include "base/rows.h"
#include "image/color.h"

namespace gradus::image {
namespace {

// Rows and columns of the fine tile for one of the coarse.
constexpr uint32_t kStep = 4;
// Shorter side from which a tile has a coarser one.
constexpr uint32_t kMinSide = 64;

// Returns the first fine row or column of a coarse one. If the fine size is no multiple of the step, some coarse ones
// cover one more than others.
uint32_t first_of(uint32_t coarse, uint32_t fine_size, uint32_t coarse_size) {
  return static_cast<uint32_t>(uint64_t{coarse} * fine_size / coarse_size);
}

// Offset of the two points of a Gauss rule from the middle of an interval of length 1.
constexpr float kGaussPoint = 0.288675f;
// Difference of encoded values up to which the mean of a cell is the value in its middle.
constexpr float kFlat = 0.016f;

// The light that look-ups of a tile find, and its alpha.
class Light {
 public:
  // is_straight: colours are divided by alpha, and count by alpha.
  Light(const ImageTile& tile, bool is_straight) : tile_(tile), is_straight_(is_straight) {}

  // Returns the mean light of the look-ups in the cell between four texels, whose lowest column and row may be -1.
  Vec4 in_cell(int x, int y) const {
    const Vec4 a = texel(x, y), b = texel(x + 1, y), c = texel(x, y + 1), d = texel(x + 1, y + 1);
    const auto at = [&](float s, float t) { return of(glm::mix(glm::mix(a, b, s), glm::mix(c, d, s), t)); };
    const Vec4 range = glm::max(glm::max(a, b), glm::max(c, d)) - glm::min(glm::min(a, b), glm::min(c, d));
    if (std::max({range.x, range.y, range.z, range.w}) < kFlat) return at(0.5f, 0.5f);
    constexpr float kLow = 0.5f - kGaussPoint, kHigh = 0.5f + kGaussPoint;
    return 0.25f * (at(kLow, kLow) + at(kHigh, kLow) + at(kLow, kHigh) + at(kHigh, kHigh));
  }

 private:
  Vec4 texel(int x, int y) const {
    return tile_.texel(uint32_t(std::clamp(x, 0, int(tile_.width) - 1)),
                       uint32_t(std::clamp(y, 0, int(tile_.height) - 1)));
  }

  Vec4 of(const Vec4& stored) const {
    if (!is_straight_ || stored.w == 1.0f) return decode_texel(tile_, stored);
    if (!(stored.w > 0.0f)) return Vec4(0.0f);
    return Vec4(Rgb(decode_texel(tile_, Vec4(Rgb(stored) / stored.w, 1.0f))) * stored.w, stored.w);
  }

  const ImageTile& tile_;
  bool is_straight_;
};

// Stores a value in a channel, as the format has it.
void store(PixelFormat format, uint8_t* pixels, size_t index, float value) {
  const auto integer = [&](float largest) { return std::clamp(value, 0.0f, 1.0f) * largest + 0.5f; };
  switch (format) {
    case PixelFormat::Byte:
      pixels[index] = static_cast<uint8_t>(integer(255.0f));
      break;
    case PixelFormat::Short: {
      const auto v = static_cast<uint16_t>(integer(65535.0f));
      std::memcpy(pixels + index * 2, &v, 2);
      break;
    }
    case PixelFormat::Half: {
      const uint16_t v = Imath::half(value).bits();
      std::memcpy(pixels + index * 2, &v, 2);
      break;
    }
    case PixelFormat::Float:
      std::memcpy(pixels + index * 4, &value, 4);
      break;
  }
}

// Stores a texel of 1 to 4 channels.
void store_texel(ImageTile* tile, size_t index, const Vec4& v) {
  const size_t first = index * tile->channels;
  store(tile->format, tile->pixels.get(), first, v.x);
  if (tile->channels >= 3) {
    store(tile->format, tile->pixels.get(), first + 1, v.y);
    store(tile->format, tile->pixels.get(), first + 2, v.z);
  }
  if (tile->channels == 2 || tile->channels == 4)
    store(tile->format, tile->pixels.get(), first + tile->channels - 1, v.w);
}

// Returns the mean of the texels of `fine` that the texel (x, y) of `coarse` covers.
Vec4 mean_of_texels(const ImageTile& fine, const ImageTile& coarse, uint32_t x, uint32_t y) {
  const uint32_t x_begin = first_of(x, fine.width, coarse.width), x_end = first_of(x + 1, fine.width, coarse.width);
  const uint32_t y_begin = first_of(y, fine.height, coarse.height), y_end = first_of(y + 1, fine.height, coarse.height);
  Vec4 sum(0.0f);
  for (uint32_t j = y_begin; j < y_end; ++j)
    for (uint32_t i = x_begin; i < x_end; ++i) sum += fine.texel(i, j);
  return sum / float((x_end - x_begin) * (y_end - y_begin));
}

// Returns the mean light of the cells between the centres of texels in the same area. Half of the cells at its borders
// belong to it.
Vec4 mean_of_light(const Light& light, const ImageTile& fine, const ImageTile& coarse, uint32_t x, uint32_t y) {
  const int x_begin = int(first_of(x, fine.width, coarse.width)),
            x_end = int(first_of(x + 1, fine.width, coarse.width));
  const int y_begin = int(first_of(y, fine.height, coarse.height)),
            y_end = int(first_of(y + 1, fine.height, coarse.height));
  Vec4 sum(0.0f);
  for (int j = y_begin - 1; j < y_end; ++j)
    for (int i = x_begin - 1; i < x_end; ++i) {
      const bool is_half_x = i == x_begin - 1 || i == x_end - 1, is_half_y = j == y_begin - 1 || j == y_end - 1;
      sum += light.in_cell(i, j) * ((is_half_x ? 0.5f : 1.0f) * (is_half_y ? 0.5f : 1.0f));
    }
  return sum / float((x_end - x_begin) * (y_end - y_begin));
}

// Sets the texels of a coarser tile to mean(x, y).
template <class MeanAt>
void fill(const MeanAt& mean, ImageTile* coarse) {
  for_rows(static_cast<int>(coarse->height), [&](int row) {
    const auto y = static_cast<uint32_t>(row);
    for (uint32_t x = 0; x < coarse->width; ++x) store_texel(coarse, size_t{y} * coarse->width + x, mean(x, y));
  });
}

std::shared_ptr<ImageTile> coarser_tile(const ImageTile& fine, bool is_straight) {
  auto coarse = std::make_shared<ImageTile>();
  coarse->number = fine.number;
  coarse->width = fine.width / kStep;
  coarse->height = fine.height / kStep;
  coarse->channels = fine.channels;
  coarse->format = !fine.srgb || fine.format == PixelFormat::Float ? fine.format : PixelFormat::Half;
  coarse->pixels = std::make_unique_for_overwrite<uint8_t[]>(coarse->size_bytes());
  if (fine.srgb) {
    const Light light(fine, is_straight);
    fill([&](uint32_t x, uint32_t y) { return mean_of_light(light, fine, *coarse, x, y); }, coarse.get());
  } else {
    fill([&](uint32_t x, uint32_t y) { return mean_of_texels(fine, *coarse, x, y); }, coarse.get());
  }
  return coarse;
}

bool is_large(const ImageTile& tile) { return std::min(tile.width, tile.height) >= kMinSide; }

// Returns a quarter of the resolution of a tile, with all further ones, or null if the tile is small.
std::shared_ptr<const ImageTile> coarser_tiles(const ImageTile& fine, bool is_straight) {
  if (!is_large(fine)) return nullptr;
  std::shared_ptr<ImageTile> coarse = coarser_tile(fine, is_straight);
  coarse->coarser = coarse->coarser_straight = coarser_tiles(*coarse, is_straight);
  return coarse;
}

}  // namespace

bool can_be_coarser(const Image& image) { return std::ranges::any_of(image.tiles, is_large); }

std::shared_ptr<const Image> with_coarser_tiles(const Image& image) {
  auto copy = std::make_shared<Image>(image);
  for (ImageTile& tile : copy->tiles) {
    // Light that is multiplied by alpha serves both kinds of look-ups. Encoded values do not.
    const bool differs = tile.srgb && image.has_alpha && image.associates_alpha;
    tile.coarser = coarser_tiles(tile, false);
    tile.coarser_straight = differs ? coarser_tiles(tile, true) : tile.coarser;
  }
  return copy;
}

}  // namespace gradus::image
