// The rows of a frame in a temporary file, so that the inputs of a window take no memory while it is solved.
#pragma once

#include <memory>

#include "animation/temporal_frame.h"
#include "base/cancel_check.h"
#include "base/spool_file.h"
#include "reconstruct/space_time/window_source.h"

namespace gradus::animation {

class SpooledFrame {
 public:
  // Writes the pixels and spatial differences that `content` selects. Uses the threads of the caller's arena, which
  // poll `cancel` for each row. Throws Error CANCELLED.
  SpooledFrame(const std::shared_ptr<const TemporalFrame>& frame, TemporalContent content, const CancelCheck& cancel);
  // Writes the temporal differences from this frame to the next one. Throws Error CANCELLED.
  void write_differences(const std::shared_ptr<const TemporalFrame>& frame,
                         const std::shared_ptr<const TemporalFrame>& next, const CancelCheck& cancel);

  // Size of the frame, as a window of one frame.
  const reconstruct::WindowSize& size() const { return size_; }
  // Read row `y`, or the (A − B)/2 of its half-buffers. Throw invalid_operation for rows that were not written.
  void read_row(reconstruct::RowKind kind, int y, float* out) const { read(kind, kValues, y, out); }
  void read_half_differences(reconstruct::RowKind kind, int y, float* out) const {
    read(kind, kHalfDifferences, y, out);
  }
  void read_correspondence(int y, int32_t* out) const;

 private:
  enum Part { kValues, kHalfDifferences, kParts };

  bool holds(reconstruct::RowKind kind) const {
    return gradients_ || kind == reconstruct::RowKind::kPrimal || kind == reconstruct::RowKind::kDt;
  }
  void write(const reconstruct::HalvedWindowSource& rows, bool temporal, const CancelCheck& cancel);
  void read(reconstruct::RowKind kind, Part part, int y, float* out) const;
  size_t row_bytes() const;
  uint64_t place_of(reconstruct::RowKind kind, Part part, int y) const;
  uint64_t place_of_correspondence(int y) const;

  reconstruct::WindowSize size_;
  bool gradients_, halves_;
  SpoolFile file_;
};

}  // namespace gradus::animation
