// The rows of a frame in a temporary file: while a window is solved, its inputs take no memory that is needed
// otherwise.
#pragma once

#include <memory>

#include "animation/temporal_frame.h"
#include "base/cancel_check.h"
#include "base/spool_file.h"
#include "reconstruct/space_time/window_source.h"

namespace gradus::animation {

class SpooledFrame {
 public:
  // Its pixels and their differences in space, as many kinds as `content` says. By the threads of the caller's arena,
  // which ask `cancel` row by row: throws the Error CANCELLED.
  SpooledFrame(const std::shared_ptr<const TemporalFrame>& frame, TemporalContent content, const CancelCheck& cancel);
  // Their differences to the next one.
  void write_differences(const std::shared_ptr<const TemporalFrame>& frame,
                         const std::shared_ptr<const TemporalFrame>& next, const CancelCheck& cancel);

  // Of this frame alone.
  const reconstruct::WindowSize& size() const { return size_; }
  // Throw invalid_operation for what the frame or `content` lacks.
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
