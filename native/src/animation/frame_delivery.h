// Delivers a frame of a sequence: as it is made, and with what flow tells of it and the frames beside it.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "animation/frame_developer.h"
#include "animation/sequence.h"

namespace gradus::animation {

class FrameDelivery final : public render::RenderTask {
 public:
  FrameDelivery(std::shared_ptr<Sequence> sequence, int32_t frame, const GradusSettings* settings);

  const Region& delivered() const override;
  void read_pass(uint32_t pass, float* pixels) const override;
  void read_component(const std::string& name, uint32_t pass, float* pixels) const override;
  std::string stats() const override;
  std::shared_ptr<const film::Film> film() const override;

 private:
  void render() override;
  uint64_t memory_bytes() const override;

  // The frame before it, where flow needs it.
  std::shared_ptr<const DevelopedFrame> make();
  // What a frame was sampled for.
  GradusSettings sampled_settings(int32_t number) const;
  std::shared_ptr<DevelopedFrame> develop_neighbour(int32_t number) const;
  // Whether flow leads from the frame before `place` to that; if not, why.
  motion::Tracking leads_to(int place);
  // Of components. What is made ahead is billed to the frame that it is for.
  void find_flow(const DevelopedFrame* previous, double* seconds_ahead, double* cpu_ahead);
  void join(const DevelopedFrame* previous, motion::Tracking leads_here, std::shared_ptr<DevelopedFrame> next,
            motion::Tracking leads_on);
  // False: there is none.
  bool read_flow(size_t component, uint32_t pass, float* pixels) const;
  // Returns the frame, which does not change after the end: readers do not keep the lock, which progress() takes.
  std::shared_ptr<const DevelopedFrame> developed(const char* what) const;

  const std::shared_ptr<Sequence> sequence_;
  const int32_t number_;
  const std::optional<GradusSettings> changed_;
  const CancelCheck cancel_ = [this] { return is_stopped(); };
  std::shared_ptr<DevelopedFrame> developed_;
  std::vector<FlowPass> flows_;
  std::vector<std::string> warnings_;  // of looking for flow
};

}  // namespace gradus::animation
