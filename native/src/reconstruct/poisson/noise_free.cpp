#include "reconstruct/poisson/noise_free.h"

#include <algorithm>

#include "base/rows.h"

namespace gradus::reconstruct {
namespace {

bool is_lit(const float* pixel, int channels) {
  return pixel[0] != 0.0f || pixel[1] != 0.0f || pixel[2] != 0.0f || (channels == 4 && pixel[3] == 0.0f);
}

// Returns 1 for each lit pixel of which neither the value nor one of the up to four differences to its neighbours shows
// a deviation. The last column and row have no differences to the right and upwards.
std::vector<uint8_t> find_quiet(const film::GradientImages& images) {
  const int w = images.width, h = images.height;
  const auto is_zero = [w](const std::vector<float>& deviation, int x, int y) {
    return deviation[size_t(y) * w + x] == 0.0f;
  };
  std::vector<uint8_t> quiet(size_t(w) * h);
  for_rows(h, [&](int y) {
    for (int x = 0; x < w; ++x) {
      const size_t i = size_t(y) * w + x;
      quiet[i] =
          is_lit(&images.primal[i * images.channels], images.channels) && is_zero(images.primal_deviation, x, y) &&
          (x + 1 == w || is_zero(images.dx_deviation, x, y)) && (x == 0 || is_zero(images.dx_deviation, x - 1, y)) &&
          (y + 1 == h || is_zero(images.dy_deviation, x, y)) && (y == 0 || is_zero(images.dy_deviation, x, y - 1));
    }
  });
  return quiet;
}

std::vector<float> crop_plane(const std::vector<float>& plane, int width, int channels, const Region& part) {
  std::vector<float> result;
  if (plane.empty()) return result;
  result.reserve(size_t(part.area()) * channels);
  for (int y = part.y0; y < part.y1; ++y) {
    const auto row = plane.begin() + (ptrdiff_t(y) * width + part.x0) * channels;
    result.insert(result.end(), row, row + ptrdiff_t(part.width()) * channels);
  }
  return result;
}

// Returns a rectangle of all images except the half-buffers.
film::GradientImages crop(const film::GradientImages& images, const Region& part) {
  film::GradientImages result;
  result.width = part.width();
  result.height = part.height();
  result.channels = images.channels;
  const auto values = [&](const std::vector<float>& plane) {
    return crop_plane(plane, images.width, images.channels, part);
  };
  const auto deviations = [&](const std::vector<float>& plane) { return crop_plane(plane, images.width, 1, part); };
  result.primal = values(images.primal);
  result.dx = values(images.dx);
  result.dy = values(images.dy);
  result.primal_deviation = deviations(images.primal_deviation);
  result.dx_deviation = deviations(images.dx_deviation);
  result.dy_deviation = deviations(images.dy_deviation);
  return result;
}

}  // namespace

std::vector<uint8_t> find_noise_free(const film::GradientImages& images) {
  const int w = images.width, h = images.height;
  const std::vector<uint8_t> quiet = find_quiet(images);
  std::vector<uint8_t> noise_free(quiet.size());
  for_rows(h, [&](int y) {
    for (int x = 0; x < w; ++x) {
      bool all = true;
      for (int j = std::max(y - 1, 0); j <= std::min(y + 1, h - 1); ++j) {
        for (int i = std::max(x - 1, 0); i <= std::min(x + 1, w - 1); ++i) all = all && quiet[size_t(j) * w + i];
      }
      noise_free[size_t(y) * w + x] = all;
    }
  });
  return noise_free;
}

Region noisy_region(const std::vector<uint8_t>& noise_free, int width, int height) {
  Region box{width, height, 0, 0};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (noise_free[size_t(y) * width + x]) continue;
      box = {std::min(box.x0, x - 1), std::min(box.y0, y - 1), std::max(box.x1, x + 2), std::max(box.y1, y + 2)};
    }
  }
  if (box.x0 >= box.x1) return {};
  return {std::max(box.x0, 0), std::max(box.y0, 0), std::min(box.x1, width), std::min(box.y1, height)};
}

std::vector<float> reconstruct_noisy_region(const film::GradientImages& images, uint32_t reconstruction, float alpha,
                                            const CancelCheck& cancel, SolveReport* report) {
  const std::vector<uint8_t> noise_free = find_noise_free(images);
  const Region part = noisy_region(noise_free, images.width, images.height);
  const bool whole = part.width() == images.width && part.height() == images.height;
  std::vector<float> result = images.primal;
  if (part.area() == 0) return result;
  const std::vector<float> solved = whole ? reconstruct(images, reconstruction, alpha, cancel, report)
                                          : reconstruct(crop(images, part), reconstruction, alpha, cancel, report);
  const int channels = images.channels;
  for (int y = part.y0; y < part.y1; ++y) {
    const float* from = solved.data() + size_t(y - part.y0) * size_t(part.width()) * channels;
    for (int x = part.x0; x < part.x1; ++x, from += channels) {
      const size_t i = size_t(y) * images.width + size_t(x);
      if (!noise_free[i]) std::copy_n(from, channels, result.data() + i * channels);
    }
  }
  return result;
}

}  // namespace gradus::reconstruct
