// Frames of a sequence as a space-time reconstruction reads them: pixels and differences in space are those of all
// samples of a frame, differences over time those between a frame and the replay of its random numbers in the next
// (Manzi et al. 2016, section 4).
#pragma once

#include <memory>
#include <vector>

#include "animation/temporal_frame.h"
#include "reconstruct/space_time/window_source.h"

namespace gradus::animation {

class FrameWindow final : public reconstruct::HalvedWindowSource {
 public:
  // In order. Throws invalid_argument unless they are of one size.
  explicit FrameWindow(std::vector<std::shared_ptr<const TemporalFrame>> frames);

  reconstruct::WindowSize size() const override;
  void read_row(reconstruct::RowKind kind, int t, int y, float* out) const override;
  void read_half_differences(reconstruct::RowKind kind, int t, int y, float* out) const override;
  void read_correspondence(int t, int y, int32_t* out) const override;
  void read_off_centre(int t, int y, Vec2* out) const override;

 private:
  using Part = film::GradientImages HalvedImages::*;
  // What is linear in the images: of their values, or of the differences of their halves.
  void read(reconstruct::RowKind kind, int t, int y, Part part, float* out) const;

  std::vector<std::shared_ptr<const TemporalFrame>> frames_;
  std::vector<film::PixelCorrespondence> correspondence_;  // from each frame but the last
};

}  // namespace gradus::animation
