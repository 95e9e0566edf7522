#include "render/noise_stop.h"

#include <cmath>

#include "frame/cells.h"

namespace gradus {
namespace {

// Keeps the relative error of black areas finite; radiance² at display exposure (the measures' constant).
constexpr double kEpsilon = 1e-3;

// Two independent estimates of what will be delivered; their mean is the estimate, half their difference its standard deviation.
struct HalfImages {
  std::array<std::vector<float>, kHalves> half;
  int channels = 3;
};

std::vector<float> solve_half(const GradientImages& images, int half, float alpha, const CancelTest& cancel) {
  GradientImages part;
  part.width = images.width;
  part.height = images.height;
  part.channels = images.channels;
  part.primal = images.primal_half[half];
  part.dx = images.dx_half[half];
  part.dy = images.dy_half[half];
  SolveReport report;
  return reconstruct(part, GRADUS_RECONSTRUCTION_L2, alpha, cancel, &report);
}

HalfImages estimate(const Frame& frame, bool solves, float alpha, const CancelTest& cancel) {
  HalfImages result;
  result.channels = frame.channels;
  for (int component = 0; component < int(frame.components.size()); ++component) {
    GradientImages images = read_images(frame, component, true);
    for (int half = 0; half < kHalves; ++half) {
      std::vector<float> image = solves ? solve_half(images, half, alpha, cancel) : std::move(images.primal_half[half]);
      if (component == 0) {
        result.half[half] = std::move(image);
      } else {
        for (size_t i = 0; i < image.size(); ++i) result.half[half][i] += image[i];
      }
    }
  }
  return result;
}

struct CellError {
  double error = 0.0;   // mean squared error per channel
  double signal = 0.0;  // mean of gray² + epsilon
};

CellError judge(const Frame& frame, const HalfImages& images, const Region& cell) {
  const double exposure = frame.settings.film_exposure;
  CellError sum;
  for (int32_t y = cell.y0; y < cell.y1; ++y) {
    for (int32_t x = cell.x0; x < cell.x1; ++x) {
      const size_t i = frame.index(x, y) * size_t(images.channels);
      double gray = 0.0;
      for (int c = 0; c < 3; ++c) {
        const double a = exposure * images.half[0][i + c], b = exposure * images.half[1][i + c];
        sum.error += (a - b) * (a - b) / (4.0 * 3.0);
        gray += (a + b) / (2.0 * 3.0);
      }
      sum.signal += gray * gray + kEpsilon;
    }
  }
  return sum;
}

}  // namespace

NoiseStop::NoiseStop(const Region& region, float threshold)
    : region_(region), threshold_(threshold), cells_(make_cells(region)), done_(cells_.size(), false), active_(cells_.size()) {}

void NoiseStop::update(const Frame& frame, bool solves, float alpha, const CancelTest& cancel) {
  const HalfImages images = estimate(frame, solves, alpha, cancel);
  for (size_t i = 0; i < cells_.size(); ++i) {
    if (done_[i]) continue;
    const CellError e = judge(frame, images, cells_[i]);
    if (!(std::sqrt(e.error / e.signal) < threshold_)) continue;  // NaN goes on
    done_[i] = true;
    --active_;
  }
}

std::vector<uint32_t> NoiseStop::count_map(uint32_t count) const {
  std::vector<uint32_t> map(size_t(region_.area()), count);
  for (size_t i = 0; i < cells_.size(); ++i) {
    if (!done_[i]) continue;
    const Region& cell = cells_[i];
    for (int32_t y = cell.y0; y < cell.y1; ++y) {
      const size_t row = size_t(y - region_.y0) * size_t(region_.width());
      std::fill_n(map.begin() + ptrdiff_t(row + size_t(cell.x0 - region_.x0)), cell.width(), 0u);
    }
  }
  return map;
}

}  // namespace gradus
