#include <cmath>

#include "frame/frame.h"

namespace gradus {

namespace {

// Which halves an image is read from: [first, last).
struct HalfRange {
  int first = 0;
  int last = kHalves;
};

std::vector<float> read_primal(const Frame& frame, const ComponentPlanes& planes, HalfRange halves) {
  const auto pixels = static_cast<size_t>(frame.region.area());
  std::vector<float> image(pixels * frame.channels, 0.0f);
  for (size_t i = 0; i < pixels; ++i) {
    Radiance sum(0.0f);
    uint32_t count = 0;
    for (int h = halves.first; h < halves.last; ++h) {
      sum += planes.primal[h][i];
      count += frame.count[h][i];
    }
    for (int c = 0; c < frame.channels && count > 0; ++c) {
      image[i * frame.channels + c] = sum[c] / static_cast<float>(count);
    }
  }
  return image;
}

// Differences towards `offset` (kRight or kUp): own samples of the pair with +, the neighbour's of the way back with −. A pair with
// samples at one end alone is absent.
std::vector<float> read_difference(const Frame& frame, const ComponentPlanes& planes, Offset offset, HalfRange halves) {
  const Region& region = frame.region;
  std::vector<float> image(static_cast<size_t>(region.area()) * frame.channels, 0.0f);
  for (int32_t y = region.y0; y < region.y1; ++y) {
    for (int32_t x = region.x0; x < region.x1; ++x) {
      const int32_t nx = x + kOffsetX[offset];
      const int32_t ny = y + kOffsetY[offset];
      if (!region.contains(nx, ny)) {
        continue;
      }
      const size_t i = frame.index(x, y);
      const size_t n = frame.index(nx, ny);
      Radiance own(0.0f), other(0.0f);
      float own_count = 0.0f, other_count = 0.0f;
      for (int h = halves.first; h < halves.last; ++h) {
        own += planes.gradient[h][offset][i];
        own_count += frame.pair_count[h][offset][i];
        other += planes.gradient[h][offset + 2][n];
        other_count += frame.pair_count[h][offset + 2][n];
      }
      for (int c = 0; c < frame.channels && own_count > 0.0f && other_count > 0.0f; ++c) {
        image[i * frame.channels + c] = own[c] / own_count - other[c] / other_count;
      }
    }
  }
  return image;
}

}  // namespace

GradientImages read_images(const Frame& frame, int component, bool with_halves) {
  const ComponentPlanes& planes = frame.components.at(static_cast<size_t>(component));
  GradientImages images;
  images.width = frame.region.width();
  images.height = frame.region.height();
  images.channels = frame.channels;
  images.primal = read_primal(frame, planes, {});
  if (frame.gradients) {
    images.dx = read_difference(frame, planes, kRight, {});
    images.dy = read_difference(frame, planes, kUp, {});
  }
  for (int h = 0; h < kHalves && with_halves; ++h) {
    const HalfRange half{h, h + 1};
    images.primal_half[h] = read_primal(frame, planes, half);
    if (frame.gradients) {
      images.dx_half[h] = read_difference(frame, planes, kRight, half);
      images.dy_half[h] = read_difference(frame, planes, kUp, half);
    }
  }
  return images;
}

std::vector<float> read_variance(const Frame& frame) {
  const auto pixels = static_cast<size_t>(frame.region.area());
  std::vector<float> variance(pixels * frame.channels, 0.0f);
  for (size_t i = 0; i < pixels; ++i) {
    if (frame.count[0][i] == 0 || frame.count[1][i] == 0) {
      continue;  // unknown; one half alone says nothing
    }
    Radiance difference(0.0f);
    for (const ComponentPlanes& planes : frame.components) {
      difference +=
          planes.primal[0][i] / static_cast<float>(frame.count[0][i]) - planes.primal[1][i] / static_cast<float>(frame.count[1][i]);
    }
    for (int c = 0; c < frame.channels; ++c) {
      const float half = 0.5f * difference[c];
      variance[i * frame.channels + c] = half * half;
    }
  }
  return variance;
}

}  // namespace gradus
