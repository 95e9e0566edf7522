#include "animation/frame_window.h"

#include <algorithm>
#include <cmath>

#include "base/fault.h"

namespace gradus::animation {

namespace {

const std::vector<float>& plane_of(const film::GradientImages& images, reconstruct::RowKind kind) {
  if (kind == reconstruct::RowKind::kDx || kind == reconstruct::RowKind::kDxDt) return images.dx;
  if (kind == reconstruct::RowKind::kDy || kind == reconstruct::RowKind::kDyDt) return images.dy;
  return images.primal;
}

// Returns the mean over all samples. If one of the two values is missing (NaN), returns the other one.
float mixed(float fresh, float replay, float share) {
  if (std::isnan(fresh)) return replay;
  if (std::isnan(replay)) return fresh;
  return GRADUS_FAULT(windows_read_fresh_samples_alone) ? fresh : fresh + share * (replay - fresh);
}

}  // namespace

FrameWindow::FrameWindow(std::vector<std::shared_ptr<const TemporalFrame>> frames) : frames_(std::move(frames)) {
  for (size_t t = 0; t + 1 < frames_.size(); ++t) {
    const TemporalFrame &frame = *frames_[t], &next = *frames_[t + 1];
    check_same_layout(frame.fresh.values, next.replay.values, next.stream);
    correspondence_.push_back(correspondence_between(frame, next));
  }
}

reconstruct::WindowSize FrameWindow::size() const {
  const film::GradientImages& first = frames_.front()->fresh.values;
  return {first.width, first.height, first.channels, int(frames_.size())};
}

void FrameWindow::read(reconstruct::RowKind kind, int t, int y, Part part, float* out) const {
  const TemporalFrame& frame = *frames_[size_t(t)];
  const size_t width = size_t(size().width), channels = size_t(size().channels), first = size_t(y) * width;
  const float* fresh = plane_of(frame.fresh.*part, kind).data();
  if (!reconstruct::is_temporal(kind)) {
    const float* replay = plane_of(frame.replay.*part, kind).data();
    for (size_t i = first; i < first + width; ++i) {
      const float share = frame.replay_share[i];
      for (size_t k = i * channels; k < (i + 1) * channels; ++k) *out++ = mixed(fresh[k], replay[k], share);
    }
    return;
  }
  if (is_repeated(frame, *frames_[size_t(t) + 1])) {
    std::fill_n(out, width * channels, 0.0f);
    return;
  }
  const TemporalFrame& after = *frames_[size_t(t) + 1];
  const auto& related = GRADUS_FAULT(temporal_difference_takes_fresh_samples) ? after.fresh : after.replay;
  const float* next = plane_of(related.*part, kind).data();
  const float sign = GRADUS_FAULT(temporal_difference_sign_flipped) ? -1.0f : 1.0f;
  for (size_t i = first; i < first + width; ++i) {
    const int32_t correspondence = correspondence_[size_t(t)].pixel[i];
    const size_t partner = GRADUS_FAULT(temporal_difference_of_same_pixel) ? i : size_t(correspondence);
    for (size_t c = 0; c < channels; ++c) {
      *out++ = correspondence == film::kNoCorrespondence
                   ? film::kAbsentPair
                   : sign * (next[partner * channels + c] - fresh[i * channels + c]);
    }
  }
}

void FrameWindow::read_row(reconstruct::RowKind kind, int t, int y, float* out) const {
  read(kind, t, y, &HalvedImages::values, out);
}

void FrameWindow::read_half_differences(reconstruct::RowKind kind, int t, int y, float* out) const {
  read(kind, t, y, &HalvedImages::half_differences, out);
}

void FrameWindow::read_correspondence(int t, int y, int32_t* out) const {
  const auto first = correspondence_[size_t(t)].pixel.begin() + ptrdiff_t(y) * size().width;
  std::copy(first, first + size().width, out);
}

}  // namespace gradus::animation
