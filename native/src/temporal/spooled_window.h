// The rows of a window's frames in a temporary file: while a window is solved, its inputs take no memory that is needed otherwise.
#pragma once

#include "base/spool_file.h"
#include "reconstruct/space_time/window_source.h"
#include "temporal/temporal_frame.h"

namespace gradus {

class SpooledWindow final : public HalvedWindowSource {
 public:
  // Reads all frames, one after the other, by the threads of the caller's arena. Of those without gradients there are rows of pixels and
  // of their differences over time alone: to read others throws invalid_operation.
  SpooledWindow(int frames, const LoadPart& base, const LoadPart& replay);

  WindowSize size() const override { return size_; }
  void read_row(RowKind kind, int t, int y, float* out) const override;
  void read_half_differences(RowKind kind, int t, int y, float* out) const override;
  void read_links(int t, int y, int32_t* out) const override;

 private:
  enum Part { kValues, kHalfDifferences, kParts };

  // rows: of the frame, and of the next one where there is one.
  void write(const HalvedWindowSource& rows, int t);
  void read(RowKind kind, int t, int y, Part part, float* out) const;
  size_t row_bytes() const;
  uint64_t place_of(RowKind kind, int t, int y, Part part) const;
  uint64_t place_of_links(int t, int y) const;

  WindowSize size_;
  bool gradients_ = false;  // the frames have differences in space
  SpoolFile file_;
};

}  // namespace gradus
