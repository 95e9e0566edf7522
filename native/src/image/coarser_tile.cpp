#include "image/coarser_tile.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <half.h>

#include "base/lanes.h"
#include "base/rows.h"
#include "image/srgb_table.h"

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

// A value of 4 channels in each of a row of texels or cells, channel by channel. Loads of whole registers may reach
// beyond the end.
class Row {
 public:
  explicit Row(size_t size) {
    for (std::vector<float>& channel : channels_) channel.resize(size + kLanes);
  }
  std::span<float, kLanes> lanes(size_t channel, size_t first) {
    return std::span<float, kLanes>(channels_[channel].data() + first, kLanes);
  }
  Vec4 operator[](size_t i) const { return {channels_[0][i], channels_[1][i], channels_[2][i], channels_[3][i]}; }
  void set(size_t i, const Vec4& value) {
    for (size_t c = 0; c < channels_.size(); ++c) channels_[c][i] = value[int(c)];
  }

 private:
  std::array<std::vector<float>, 4> channels_;
};

using Texels = std::array<FloatLanes, 4>;  // channels of eight texels

Texels mix(const Texels& a, const Texels& b, float s) {
  Texels mixed;
  for (size_t c = 0; c < mixed.size(); ++c) mixed[c] = a[c] * (1.0f - s) + b[c] * s;
  return mixed;
}

// The light that look-ups of a tile find between its texels, and its alpha, row by row.
class Light {
 public:
  // is_straight: colours are divided by alpha, and count by alpha.
  Light(const ImageTile& tile, bool is_straight)
      : tile_(tile), is_straight_(is_straight), upper_(tile.width + 2), lower_(tile.width + 2) {}

  // Finds the mean light of the look-ups in each cell between the rows y and y + 1 of texels. y may be -1, and cell i
  // lies between the columns i - 1 and i. The rows are those of the call before and one more, or start anew.
  void find_cells(int y, Row* cells) {
    if (!next_ || *next_ != y) load(y, &upper_);
    load(y + 1, &lower_);
    for (size_t i = 0; i <= tile_.width; i += kLanes) {
      const Texels light =
          in_cells(texels(&upper_, i), texels(&upper_, i + 1), texels(&lower_, i), texels(&lower_, i + 1));
      for (size_t c = 0; c < light.size(); ++c) store_lanes(light[c], cells->lanes(c, i));
    }
    std::swap(upper_, lower_);
    next_ = y + 1;
  }

 private:
  // Loads a row of texels, with the first and the last one twice.
  void load(int y, Row* row) const {
    const auto nearest = uint32_t(std::clamp(y, 0, int(tile_.height) - 1));
    for (uint32_t x = 0; x < tile_.width; ++x) row->set(x + 1, tile_.texel(x, nearest));
    row->set(0, (*row)[1]);
    row->set(tile_.width + 1, (*row)[tile_.width]);
  }

  static Texels texels(Row* row, size_t first) {
    Texels found;
    for (size_t c = 0; c < found.size(); ++c) found[c] = load_lanes(row->lanes(c, first));
    return found;
  }

  // Returns the mean light in eight cells, each between four texels.
  Texels in_cells(const Texels& a, const Texels& b, const Texels& c, const Texels& d) const {
    const auto at = [&](float s, float t) { return of(mix(mix(a, b, s), mix(c, d, s), t)); };
    FloatLanes range{};
    for (size_t i = 0; i < a.size(); ++i) {
      const FloatLanes high = maximum(maximum(a[i], b[i]), maximum(c[i], d[i]));
      range = maximum(range, high - minimum(minimum(a[i], b[i]), minimum(c[i], d[i])));
    }
    const SignedLanes is_flat = range < kFlat;
    const uint32_t flat = mask_of(is_flat);
    if (flat == kAllLanes) return at(0.5f, 0.5f);
    constexpr float kLow = 0.5f - kGaussPoint, kHigh = 0.5f + kGaussPoint;
    const Texels p = at(kLow, kLow), q = at(kHigh, kLow), r = at(kLow, kHigh), s = at(kHigh, kHigh);
    Texels mean;
    for (size_t i = 0; i < mean.size(); ++i) mean[i] = 0.25f * (p[i] + q[i] + r[i] + s[i]);
    if (flat == 0) return mean;
    const Texels middle = at(0.5f, 0.5f);
    for (size_t i = 0; i < mean.size(); ++i) mean[i] = is_flat ? middle[i] : mean[i];
    return mean;
  }

  // Returns the light of stored values.
  Texels of(const Texels& stored) const {
    const FloatLanes alpha = stored[3];
    const SignedLanes is_seen = alpha > 0.0f;
    Texels light;
    for (size_t c = 0; c < 3; ++c) {
      const FloatLanes encoded = is_straight_ ? (is_seen ? stored[c] / alpha : FloatLanes{}) : stored[c];
      const FloatLanes decoded = table_(encoded);
      light[c] = is_straight_ ? (is_seen ? decoded * alpha : FloatLanes{}) : decoded;
    }
    light[3] = is_straight_ ? (is_seen ? alpha : FloatLanes{}) : alpha;
    return light;
  }

  static constexpr uint32_t kAllLanes = (1u << kLanes) - 1;
  const SrgbTable& table_ = srgb_table();
  const ImageTile& tile_;
  bool is_straight_;
  Row upper_, lower_;        // texels of two rows
  std::optional<int> next_;  // the row in upper_
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

// Sets the rows begin to end of a coarser tile to the mean light of the cells between the centres of texels in the same
// area. Half of the cells at its borders belong to it.
void fill_with_light(const ImageTile& fine, bool is_straight, uint32_t begin, uint32_t end, ImageTile* coarse) {
  Light light(fine, is_straight);
  Row cells(fine.width + 1);
  std::vector<Vec4> sums(coarse->width);
  const auto add_cells = [&](float weight_of_row) {
    for (uint32_t x = 0; x < coarse->width; ++x) {
      const uint32_t first = first_of(x, fine.width, coarse->width), last = first_of(x + 1, fine.width, coarse->width);
      for (uint32_t i = first; i <= last; ++i)
        sums[x] += cells[i] * ((i == first || i == last ? 0.5f : 1.0f) * weight_of_row);
    }
  };
  for (uint32_t y = begin; y < end; ++y) {
    const uint32_t first = first_of(y, fine.height, coarse->height),
                   last = first_of(y + 1, fine.height, coarse->height);
    std::fill(sums.begin(), sums.end(), Vec4(0.0f));
    for (uint32_t j = first; j <= last; ++j) {
      // The cells at the border are those of the row of texels before, too.
      if (j != first || y == begin) light.find_cells(int(j) - 1, &cells);
      add_cells(j == first || j == last ? 0.5f : 1.0f);
    }
    for (uint32_t x = 0; x < coarse->width; ++x) {
      const uint32_t columns = first_of(x + 1, fine.width, coarse->width) - first_of(x, fine.width, coarse->width);
      store_texel(coarse, size_t{y} * coarse->width + x, sums[x] / float(columns * (last - first)));
    }
  }
}

// Sets the rows begin to end of a coarser tile to the means of texels.
void fill_with_means(const ImageTile& fine, uint32_t begin, uint32_t end, ImageTile* coarse) {
  for (uint32_t y = begin; y < end; ++y)
    for (uint32_t x = 0; x < coarse->width; ++x)
      store_texel(coarse, size_t{y} * coarse->width + x, mean_of_texels(fine, *coarse, x, y));
}

std::shared_ptr<ImageTile> coarser_tile(const ImageTile& fine, bool is_straight) {
  auto coarse = std::make_shared<ImageTile>();
  coarse->number = fine.number;
  coarse->width = fine.width / kStep;
  coarse->height = fine.height / kStep;
  coarse->channels = fine.channels;
  coarse->format = !fine.srgb || fine.format == PixelFormat::Float ? fine.format : PixelFormat::Half;
  coarse->pixels = std::make_unique_for_overwrite<uint8_t[]>(coarse->size_bytes());
  for_pieces(static_cast<int>(coarse->height), [&](int begin, int end) {
    if (fine.srgb)
      fill_with_light(fine, is_straight, uint32_t(begin), uint32_t(end), coarse.get());
    else
      fill_with_means(fine, uint32_t(begin), uint32_t(end), coarse.get());
  });
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
