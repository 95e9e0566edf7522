// Makes a frame of a sequence: its picture from the windows that hold it, its passes from all of its samples.
#pragma once

#include <optional>

#include <tbb/task_arena.h>

#include "base/cancel_test.h"
#include "render/sequence/made_frame.h"
#include "render/sequence/sequence.h"

namespace gradus {

class FrameMaker {
 public:
  // asked: what it is made of otherwise than it was sampled for, and the number of threads that make it; nothing: what the folder knows.
  // All that is given lives as long as it.
  FrameMaker(Sequence* sequence, int32_t number, const std::optional<GradusSettings>& asked, const CancelTest& is_cancelled);

  // In this order. Both throw the Error CANCELLED.
  std::shared_ptr<MadeFrame> load();
  void make_picture(MadeFrame* made);

  // Whether it would be made the same way.
  bool would_make(const MadeFrame& made) const;

 private:
  std::shared_ptr<MadeFrame> read();
  void stop_if_asked() const;
  Delivery delivery(const FrameRecord& record, bool is_planned, const Frame& frame) const;
  void reconstruct(MadeFrame* made);
  void denoise(MadeFrame* made);
  // Light passes follow what the picture has become.
  void split_light(MadeFrame* made);
  // Passes Gradient T and Gradient T Link, of the frame's own half.
  void read_differences_over_time(const Frame& base, MadeFrame* made);

  Sequence& sequence_;
  const int32_t number_;
  const std::optional<GradusSettings> asked_;
  const CancelTest& is_cancelled_;
  const uint32_t threads_;
  tbb::task_arena arena_;
};

}  // namespace gradus
