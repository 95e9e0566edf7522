// Delivers a frame of a sequence: its picture from the windows that hold it, and its passes from all of its samples.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "render/light_passes.h"
#include "render/sequence/sequence.h"

namespace gradus {

class FrameDelivery final : public RenderTask {
 public:
  FrameDelivery(std::shared_ptr<Sequence> sequence, int32_t frame, const GradusSettings* settings);

  const Region& delivered() const override;
  void read_pass(uint32_t pass, float* pixels) const override;
  void read_component(const std::string& name, uint32_t pass, float* pixels) const override;
  std::string stats() const override;
  std::shared_ptr<const Frame> frame() const override;

 private:
  void render() override;
  uint64_t memory_bytes() const override;

  std::shared_ptr<Frame> load();
  void deliver_as(const GradusSettings& asked, bool is_planned, Frame* frame) const;
  void reconstruct();
  void denoise();
  // Light passes follow what the picture has become.
  void split_light();
  // Passes Gradient T and Gradient T Link, of the frame's own half.
  void read_differences_over_time(const Frame& base, const GradusSettings& asked, const CancelTest& cancel);

  const std::shared_ptr<Sequence> sequence_;
  const int32_t number_;
  const std::optional<GradusSettings> changed_;
  FrameRecord record_;
  std::shared_ptr<Frame> frame_;
  std::vector<float> combined_, error_;         // of the region: RGBA, and pass Error where it is asked for
  std::vector<std::vector<float>> components_;  // RGB of each
  LightPasses light_;
  std::vector<float> difference_, link_;  // to the next frame; three values per pixel of the region
};

}  // namespace gradus
