// Samples a frame of a sequence: its own half, and the one that replays the frame before.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "render/loop.h"
#include "render/sequence/sequence.h"

namespace gradus {

class FrameSampling final : public RenderTask {
 public:
  FrameSampling(std::shared_ptr<Sequence> sequence, LoopInput input);

  void cancel() override;
  GradusProgress progress() const override;
  const Region& delivered() const override { return base_.delivered(); }
  // Of its own half.
  void read_pass(uint32_t pass, float* pixels) const override { base_.read_pass(pass, pixels); }
  void read_component(const std::string& name, uint32_t pass, float* pixels) const override { base_.read_component(name, pass, pixels); }
  std::string stats() const override;
  std::shared_ptr<const Frame> frame() const override;

 private:
  void render() override;
  uint64_t memory_bytes() const override { return 0; }

  // What the folder has of the frame, if it fits.
  std::optional<FrameHeader> stored(FramePart part) const;
  std::optional<FrameHeader> stored_base() const;
  // Of a half of an earlier frame, which gets no more samples.
  bool has_enough(const FrameHeader& half, FramePart part) const;
  // Returns the frame that was sampled, or reads the stored one. Takes the lock, but not while it reads a file.
  std::shared_ptr<const Frame> own_half(const char* what) const;
  std::shared_ptr<Frame> read(FramePart part, StoredContent content, const CancelTest& cancel) const;
  std::shared_ptr<Frame> load(FramePart part, StoredContent content = StoredContent::kAll);
  bool repeats_before() const;
  bool differs_from_before() const;
  void repeat_before();
  void sample_parts();
  void go_on();
  // counts: the base's samples of each pixel, where pixels may differ in them.
  void sample_offset(const FrameHeader& base, const std::vector<uint32_t>& counts, bool samples_base);
  void run(RenderLoop* loop);
  void save(const Frame& frame, FramePart part);
  bool follows_before() const;
  // Whether a stored offset is of what the frame follows now: other steps, parts or scenes of a job have other frames before it. Where
  // nobody has told what comes before, it is.
  bool replays_before(const FrameHeader& offset) const;
  std::shared_ptr<const Replay> follow(const FrameHeader& base, const std::vector<uint32_t>& counts);
  LoopInput base_input() const;
  // From here on it is the frame before.
  void finish(const FrameHeader& base, std::vector<uint32_t> counts);

  const std::shared_ptr<Sequence> sequence_;
  const LoopInput input_;
  const std::optional<FrameHeader> stored_base_;
  RenderLoop base_;
  std::unique_ptr<RenderLoop> offset_;
  double resumed_mean_ = 0.0;                   // samples per pixel that the base went on from
  mutable std::mutex reading_;                  // is held while a stored frame is read, so that it is read once
  mutable std::shared_ptr<const Frame> frame_;  // of one that was stored: when it is asked for
  FrameRecord record_;
};

}  // namespace gradus
