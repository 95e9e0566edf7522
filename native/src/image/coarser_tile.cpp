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

// Sums texels as light.
class Mean {
 public:
  Mean(const ImageTile& tile, bool is_associated)
      : tile_(tile), weighs_alpha_(is_associated && tile.srgb && tile.channels == 4) {}

  void add(const Vec4& stored) {
    ++count_;
    alpha_ += stored.w;
    if (!weighs_alpha_ || stored.w == 1.0f) {
      color_ += Rgb(decode_texel(tile_, stored));
    } else if (stored.w > 0.0f) {
      color_ += Rgb(decode_texel(tile_, Vec4(Rgb(stored) / stored.w, stored.w))) * stored.w;
    }
  }

  // Returns the mean in the form that the tile stores.
  Vec4 stored() const {
    const float alpha = alpha_ / static_cast<float>(count_);
    if (!tile_.srgb) return Vec4(color_ / static_cast<float>(count_), alpha);
    const float weight = weighs_alpha_ ? alpha_ : static_cast<float>(count_);
    if (!(weight > 0.0f)) return Vec4(0.0f, 0.0f, 0.0f, alpha);
    const Rgb c = color_ / weight;
    const Rgb encoded(linear_to_srgb(c.x), linear_to_srgb(c.y), linear_to_srgb(c.z));
    return Vec4(weighs_alpha_ ? encoded * alpha : encoded, alpha);
  }

 private:
  const ImageTile& tile_;
  const bool weighs_alpha_;
  Rgb color_ = Rgb(0.0f);
  float alpha_ = 0.0f;
  uint32_t count_ = 0;
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
Vec4 mean_of(const ImageTile& fine, const ImageTile& coarse, uint32_t x, uint32_t y, bool is_associated) {
  Mean mean(fine, is_associated);
  const uint32_t x_end = first_of(x + 1, fine.width, coarse.width);
  const uint32_t y_end = first_of(y + 1, fine.height, coarse.height);
  for (uint32_t j = first_of(y, fine.height, coarse.height); j < y_end; ++j)
    for (uint32_t i = first_of(x, fine.width, coarse.width); i < x_end; ++i) mean.add(fine.texel(i, j));
  return mean.stored();
}

std::unique_ptr<ImageTile> coarser_tile(const ImageTile& fine, bool is_associated) {
  auto coarse = std::make_unique<ImageTile>();
  coarse->number = fine.number;
  coarse->width = fine.width / kStep;
  coarse->height = fine.height / kStep;
  coarse->channels = fine.channels;
  coarse->format = fine.format;
  coarse->srgb = fine.srgb;
  coarse->pixels = std::make_unique_for_overwrite<uint8_t[]>(coarse->size_bytes());
  for_rows(static_cast<int>(coarse->height), [&](int row) {
    const auto y = static_cast<uint32_t>(row);
    for (uint32_t x = 0; x < coarse->width; ++x)
      store_texel(coarse.get(), size_t{y} * coarse->width + x, mean_of(fine, *coarse, x, y, is_associated));
  });
  return coarse;
}

}  // namespace

void add_coarser_tiles(ImageTile* tile, bool is_associated) {
  if (std::min(tile->width, tile->height) < kMinSide) return;
  auto coarse = coarser_tile(*tile, is_associated);
  add_coarser_tiles(coarse.get(), is_associated);
  tile->coarser = std::move(coarse);
}

}  // namespace gradus::image
