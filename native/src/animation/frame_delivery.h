// Task that delivers a frame of a sequence: it develops the picture and its passes, and estimates optical flow to the
// neighbouring frames where a pass needs it.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <vector>

#include "animation/frame_developer.h"
#include "animation/sequence.h"

namespace gradus::animation {

class FrameDelivery final : public render::RenderTask {
 public:
  // settings: options that replace those with which the frame was sampled (see Sequence::deliver()), or nullptr.
  FrameDelivery(std::shared_ptr<Sequence> sequence, int32_t frame, const GradusSettings* settings);

  const Region& delivered() const override;
  void read_pass(uint32_t pass, float* pixels) const override;
  void read_component(const std::string& name, uint32_t pass, float* pixels) const override;
  void read_channel(uint32_t kind, const std::string& name, uint32_t layer, float* pixels) const override;
  std::string stats() const override;
  std::shared_ptr<const film::Film> film() const override;

 private:
  void render() override;
  uint64_t memory_bytes() const override;

  // Develops the frame. Returns the frame before it if that had to be developed for flow, otherwise nullptr.
  std::shared_ptr<const DevelopedFrame> make();
  // Returns the settings with which a frame was sampled.
  GradusSettings sampled_settings(int32_t number) const;
  std::shared_ptr<DevelopedFrame> develop_neighbour(int32_t number) const;
  // Returns Tracked if flow can be estimated between the frame at `place` and the one before, otherwise the cause.
  motion::Tracking leads_to(int place);
  // Estimates the flow of components. The time spent on developing the next frame is counted in that frame's stats.
  void find_flow(const DevelopedFrame* previous, double* seconds_ahead, double* cpu_ahead);
  void join(const DevelopedFrame* previous, motion::Tracking leads_here, std::shared_ptr<DevelopedFrame> next,
            motion::Tracking leads_on);
  // Returns the frame, which does not change after the end of the task. Readers do not keep the lock, because
  // progress() takes it.
  std::shared_ptr<const DevelopedFrame> developed(const char* what) const;

  const std::shared_ptr<Sequence> sequence_;
  const int32_t number_;
  const std::optional<GradusSettings> changed_;
  const CancelCheck cancel_ = [this] { return is_stopped(); };
  std::shared_ptr<DevelopedFrame> developed_;
  // Bytes of the images of `developed_`. progress() reads them while the render thread adds images.
  std::atomic<uint64_t> image_bytes_{0};
  std::vector<std::string> warnings_;  // from loading the flow library
};

}  // namespace gradus::animation
