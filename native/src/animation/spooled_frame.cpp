#include "animation/spooled_frame.h"

#include <iterator>
#include <vector>

#include <tbb/parallel_for.h>

#include "animation/frame_window.h"
#include "base/cancel_check.h"
#include "base/fault.h"

namespace gradus::animation {

SpooledFrame::SpooledFrame(const std::shared_ptr<const TemporalFrame>& frame, TemporalContent content,
                           const CancelCheck& cancel)
    : size_(FrameWindow({frame}).size()), gradients_(!frame->fresh.values.dx.empty()), halves_(content.halves) {
  write(FrameWindow({frame}), false, cancel);
}

void SpooledFrame::write_differences(const std::shared_ptr<const TemporalFrame>& frame,
                                     const std::shared_ptr<const TemporalFrame>& next, const CancelCheck& cancel) {
  write(FrameWindow({frame, next}), true, cancel);
}

void SpooledFrame::write(const reconstruct::HalvedWindowSource& rows, bool temporal, const CancelCheck& cancel) {
  tbb::parallel_for(0, size_.height, [&](int y) {
    throw_if_cancelled(cancel);
    std::vector<float> row(size_t(size_.width) * size_t(size_.channels));
    for (const reconstruct::RowKind kind : reconstruct::kRowKinds) {
      if (reconstruct::is_temporal(kind) != temporal || !holds(kind)) continue;
      rows.read_row(kind, 0, y, row.data());
      file_.write(place_of(kind, kValues, y), row.data(), row_bytes());
      if (!halves_) continue;
      if (!GRADUS_FAULT(spooled_half_differences_are_values)) rows.read_half_differences(kind, 0, y, row.data());
      file_.write(place_of(kind, kHalfDifferences, y), row.data(), row_bytes());
    }
    if (!temporal) return;
    std::vector<int32_t> correspondence(size_t(size_.width));
    rows.read_correspondence(0, y, correspondence.data());
    file_.write(place_of_correspondence(y), correspondence.data(), correspondence.size() * sizeof(int32_t));
  });
}

size_t SpooledFrame::row_bytes() const { return size_t(size_.width) * size_t(size_.channels) * sizeof(float); }

uint64_t SpooledFrame::place_of(reconstruct::RowKind kind, Part part, int y) const {
  const uint64_t plane = uint64_t(kind) * kParts + part;
  return (plane * uint64_t(size_.height) + uint64_t(y)) * row_bytes();
}

uint64_t SpooledFrame::place_of_correspondence(int y) const {
  const uint64_t planes = std::size(reconstruct::kRowKinds) * kParts * uint64_t(size_.height) * row_bytes();
  return planes + uint64_t(y) * uint64_t(size_.width) * sizeof(int32_t);
}

void SpooledFrame::read(reconstruct::RowKind kind, Part part, int y, float* out) const {
  if (!holds(kind)) {
    throw invalid_operation("the stored frames hold no gradients, which the integrator GRADIENT samples");
  }
  if (part == kHalfDifferences && !halves_) throw invalid_operation("the noise of these rows was not requested");
  file_.read(place_of(kind, part, y), out, row_bytes());
}

void SpooledFrame::read_correspondence(int y, int32_t* out) const {
  file_.read(place_of_correspondence(y), out, size_t(size_.width) * sizeof(int32_t));
}

}  // namespace gradus::animation
