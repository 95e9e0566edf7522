// Sequences of images, and windows that measure them with noise.
#pragma once

#include "reconstruct/solver_planes.h"
#include "reconstruct/space_time/system.h"
#include "reconstruct/space_time/window.h"
#include "reconstruct/test_images.h"

namespace gradus::test {

using Images = std::vector<std::vector<float>>;

inline Images changing_images(const reconstruct::WindowSize& size) {
  Images images;
  for (int t = 0; t < size.frames; ++t) {
    images.push_back(make_image(size.width, size.height, size.channels, [t](int x, int y, int c) {
      return 1.0f + 0.3f * std::sin(0.2f * float(x) + 0.4f * float(t)) +
             0.2f * std::cos(0.17f * float(y) - 0.3f * float(t * c)) + (x > 3 * t ? 0.5f : 0.0f);
    }));
  }
  return images;
}

// Returns rows without noise.
inline Window measured(int width, int height, int channels, int frames, Motion motion) {
  Window window(width, height, channels, frames);
  set_correspondences(&window, motion);
  window.measure(changing_images(window.size_));
  return window;
}

// Returns two half-buffers with independent noise in every row, and the deviations that they show. sigma(kind, pixel):
// of a half-buffer.
template <class Sigma>
void add_noise_of_halves(Window* window, const Sigma& sigma, unsigned seed) {
  for (const reconstruct::RowKind kind : reconstruct::kRowKinds) {
    for (int t = 0; t < window->size_.frames; ++t) {
      average_noisy_halves(
          &window->plane(kind, t), &window->deviations[size_t(kind)][size_t(t)], window->size_.channels,
          [&](size_t pixel) { return sigma(kind, pixel); }, seed++);
    }
  }
}

// Returns the images of a single frame, with deviations.
inline film::GradientImages frame_of(const Window& window, int t) {
  const auto deviation = [&](reconstruct::RowKind kind) { return window.deviations[size_t(kind)][size_t(t)]; };
  film::GradientImages images;
  images.width = window.size_.width;
  images.height = window.size_.height;
  images.channels = window.size_.channels;
  images.primal = window.plane(reconstruct::RowKind::kPrimal, t);
  images.dx = window.plane(reconstruct::RowKind::kDx, t);
  images.dy = window.plane(reconstruct::RowKind::kDy, t);
  images.primal_deviation = deviation(reconstruct::RowKind::kPrimal);
  images.dx_deviation = deviation(reconstruct::RowKind::kDx);
  images.dy_deviation = deviation(reconstruct::RowKind::kDy);
  return images;
}

// Returns all frames, one after another.
inline std::vector<float> joined(const reconstruct::Frames& frames) {
  std::vector<float> all;
  for (const reconstruct::Field& field : frames) {
    const std::vector<float> image = reconstruct::interleave(field);
    all.insert(all.end(), image.begin(), image.end());
  }
  return all;
}
inline std::vector<float> joined(const Images& images) {
  std::vector<float> all;
  for (const auto& image : images) all.insert(all.end(), image.begin(), image.end());
  return all;
}

inline constexpr Motion kMotions[] = {Motion::kNone, Motion::kStatic, Motion::kPan, Motion::kTurn, Motion::kRandom};

}  // namespace gradus::test
