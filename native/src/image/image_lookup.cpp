// Look-ups in images: extension, interpolation and UDIM tiles behave as in Cycles.
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/fault.h"
#include "image/image.h"
#include "image/image_store.h"
#include "image/srgb_table.h"

namespace gradus::image {
namespace {

// Result of a look-up in an image or a UDIM tile that is absent: magenta.
const Vec4 kMissing(1.0f, 0.0f, 1.0f, 1.0f);

// Distance from a clipped image, in widths of it, at which coordinates are clamped. A look-up there is empty whatever
// the image's size, because cubic weights reach only two texels beyond the border.
constexpr float kEmpty = 3.0f;

// Maps a coordinate along one axis to an equivalent one near [0, 1], so that texel numbers fit an int. A coordinate
// that is not finite becomes 0.
float reduce(float u, Extension extension) {
  if (!is_finite(u)) {
    return 0.0f;
  }
  switch (extension) {
    case Extension::Repeat:
      return u - std::floor(u);
    case Extension::Mirror:
      return u - 2.0f * std::floor(0.5f * u);
    case Extension::Clip:
      return std::clamp(u, -kEmpty, 1.0f + kEmpty);
    default:
      return std::clamp(u, 0.0f, 1.0f);
  }
}

// Returns the texel in 0 … size - 1 that the extension assigns to texel number `i`. For Clip and Extend that is the
// nearest one.
uint32_t wrap(int i, uint32_t size, Extension extension) {
  const int n = static_cast<int>(size);
  switch (extension) {
    case Extension::Repeat:
      // After reduce(), `i` is close to the image. The loops run at most a few times and are faster than a division.
      while (i < 0) {
        i += n;
      }
      while (i >= n) {
        i -= n;
      }
      return static_cast<uint32_t>(i);
    case Extension::Mirror: {
      const int m = std::abs(i + (i < 0 ? 1 : 0)) % (2 * n);
      return static_cast<uint32_t>(m >= n ? 2 * n - m - 1 : m);
    }
    default:
      return static_cast<uint32_t>(std::clamp(i, 0, n - 1));
  }
}

// The texels that contribute to a look-up along one axis, with their weights.
template <int N>
struct Taps {
  std::array<uint32_t, N> texel;
  std::array<float, N> weight;
};

// Returns N texels from number `first` on. Texels outside a clipped image get weight 0, so that interpolation fades the
// image to 0 across its border, as in Cycles.
template <int N>
Taps<N> make_taps(int first, const std::array<float, N>& weight, uint32_t size, Extension extension) {
  Taps<N> taps{{}, weight};
  for (int k = 0; k < N; k++) {
    taps.texel[size_t(k)] = wrap(first + k, size, extension);
    if (extension == Extension::Clip && (first + k < 0 || first + k >= static_cast<int>(size))) {
      taps.weight[size_t(k)] = 0.0f;
    }
  }
  return taps;
}

Taps<1> closest_taps(float u, uint32_t size, Extension extension) {
  return make_taps<1>(static_cast<int>(std::floor(u * static_cast<float>(size))), {1.0f}, size, extension);
}

Taps<2> linear_taps(float u, uint32_t size, Extension extension) {
  const float x = u * static_cast<float>(size) - 0.5f;
  const float first = std::floor(x);
  const float t = x - first;
  return make_taps<2>(static_cast<int>(first), {1.0f - t, t}, size, extension);
}

// Returns the taps of the uniform cubic B-spline, as in Cycles. The curve is smooth and does not pass through the texel
// values.
Taps<4> cubic_taps(float u, uint32_t size, Extension extension) {
  const float x = u * static_cast<float>(size) - 0.5f;
  const float first = std::floor(x);
  const float t = x - first;
  const float t2 = t * t;
  const float t3 = t2 * t;
  return make_taps<4>(static_cast<int>(first) - 1,
                      {(1.0f - 3.0f * t + 3.0f * t2 - t3) / 6.0f, (4.0f - 6.0f * t2 + 3.0f * t3) / 6.0f,
                       (1.0f + 3.0f * t + 3.0f * t2 - 3.0f * t3) / 6.0f, t3 / 6.0f},
                      size, extension);
}

// Returns the weighted sum of the texels.
template <int N>
Vec4 gather(const ImageTile& tile, const Taps<N>& x, const Taps<N>& y) {
  Vec4 sum(0.0f);
  for (size_t j = 0; j < N; j++) {
    Vec4 row(0.0f);
    for (size_t i = 0; i < N; i++) {
      row += x.weight[i] * tile.texel(x.texel[i], y.texel[j]);
    }
    sum += y.weight[j] * row;
  }
  return sum;
}

// Returns the coarsest resolution of a tile whose texels are not longer than `extent`, in units of the tile.
const ImageTile& resolution_for(const ImageTile& full, float extent, bool is_straight) {
  const ImageTile* tile = &full;
  for (;;) {
    const ImageTile* coarser = (is_straight ? tile->coarser_straight : tile->coarser).get();
    if (!coarser || extent * static_cast<float>(std::min(coarser->width, coarser->height)) < 1.0f) {
      return *tile;
    }
    tile = coarser;
  }
}

template <int N>
float total_weight(const Taps<N>& taps) {
  return std::accumulate(taps.weight.begin(), taps.weight.end(), 0.0f);
}

// Returns the share of a look-up that is inside a clipped tile.
float coverage(const ImageTile& tile, const Vec2& uv, Interpolation interpolation) {
  const auto along = [&](float x, uint32_t size) {
    const float u = reduce(x, Extension::Clip);
    switch (interpolation) {
      case Interpolation::Closest:
        return total_weight(closest_taps(u, size, Extension::Clip));
      case Interpolation::Cubic:
        return total_weight(cubic_taps(u, size, Extension::Clip));
      default:
        return total_weight(linear_taps(u, size, Extension::Clip));
    }
  };
  return along(uv.x, tile.width) * along(uv.y, tile.height);
}

// Returns the stored value at `uv`, before conversion to scene-linear.
Vec4 interpolate(const ImageTile& tile, const Vec2& uv, Interpolation interpolation, Extension extension) {
  const float u = reduce(uv.x, extension);
  const float v = reduce(uv.y, extension);
  switch (interpolation) {
    case Interpolation::Closest:
      return gather(tile, closest_taps(u, tile.width, extension), closest_taps(v, tile.height, extension));
    case Interpolation::Cubic:
      return gather(tile, cubic_taps(u, tile.width, extension), cubic_taps(v, tile.height, extension));
    default:
      return gather(tile, linear_taps(u, tile.width, extension), linear_taps(v, tile.height, extension));
  }
}

// Returns the tile that holds *uv, or nullptr if there is none, and makes *uv relative to it. UDIM number
// 1001 + column + 10 row covers [column, column + 1) x [row, row + 1). As in Cycles, which rounds towards 0, the first
// column and row begin after -1.
const ImageTile* find_tile(const Image& image, Vec2* uv) {
  if (image.tiles.empty()) {
    return nullptr;
  }
  if (image.tiles[0].number == 0) {
    return &image.tiles[0];
  }
  const float column = std::trunc(uv->x);
  const float row = std::trunc(uv->y);
  if (!(column >= 0.0f && column < 10.0f && row >= 0.0f && row < 1000.0f)) {
    return nullptr;
  }
  const uint32_t number = 1001u + static_cast<uint32_t>(column) + 10u * static_cast<uint32_t>(row);
  const auto found =
      std::find_if(image.tiles.begin(), image.tiles.end(), [&](const ImageTile& t) { return t.number == number; });
  *uv -= Vec2(column, row);
  return found == image.tiles.end() ? nullptr : &*found;
}

}  // namespace

Vec4 decode_texel(const ImageTile& tile, const Vec4& stored) {
  static const SrgbTable& table = srgb_table();
  const auto decoded = [](float value) { return table(GRADUS_FAULT(srgb_decoded_twice) ? table(value) : value); };
  return tile.srgb ? Vec4(decoded(stored.x), decoded(stored.y), decoded(stored.z), stored.w) : stored;
}

Vec4 ImageStore::lookup(uint32_t index, const Vec2& uv, Interpolation interpolation, Extension extension,
                        bool unassociate, float extent) const {
  if (index >= size()) {
    return kMissing;
  }
  const Image& image = *images_[index];
  Vec2 local = uv;
  const ImageTile* tile = find_tile(image, &local);
  if (tile == nullptr || tile->width == 0) {
    return kMissing;
  }
  const bool is_opaque_outside = tile->is_opaque_outside;
  if (extent > 0.0f && interpolation == Interpolation::Linear) {
    tile = &resolution_for(*tile, extent, unassociate);
  }
  Vec4 value = interpolate(*tile, local, interpolation, extension);
  if (image.ignores_alpha) {
    value.w = extension == Extension::Clip ? coverage(*tile, local, interpolation) : 1.0f;
  }
  if (is_opaque_outside) {
    value.w = 1.0f;
  }
  if (unassociate && value.w != 0.0f && value.w != 1.0f) {
    const float alpha = value.w;
    value /= alpha;
    value.w = alpha;
  }
  return decode_texel(*tile, value);
}

}  // namespace gradus::image
