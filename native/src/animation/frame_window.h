// Frames of a sequence as a space-time reconstruction reads them. Pixels and spatial differences come from all samples
// of a frame. Temporal differences are those between the fresh samples of a frame and the samples of the next frame
// that replay their random numbers (Manzi et al. 2016, section 4).
#pragma once

#include <memory>
#include <vector>

#include "animation/temporal_frame.h"
#include "reconstruct/space_time/window_source.h"

namespace gradus::animation {

class FrameWindow final : public reconstruct::HalvedWindowSource {
 public:
  // frames: consecutive frames, at least one. Throws invalid_argument unless all have the same size and planes.
  explicit FrameWindow(std::vector<std::shared_ptr<const TemporalFrame>> frames);

  reconstruct::WindowSize size() const override;
  void read_row(reconstruct::RowKind kind, int t, int y, float* out) const override;
  void read_half_differences(reconstruct::RowKind kind, int t, int y, float* out) const override;
  void read_correspondence(int t, int y, int32_t* out) const override;

 private:
  using Part = film::GradientImages HalvedImages::*;
  // Reads a row, either of values or of half the differences of the half-buffers: both are linear in the images.
  void read(reconstruct::RowKind kind, int t, int y, Part part, float* out) const;

  std::vector<std::shared_ptr<const TemporalFrame>> frames_;
  std::vector<film::PixelCorrespondence> correspondence_;  // from each frame except the last to the next one
};

}  // namespace gradus::animation
