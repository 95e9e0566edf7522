// Makes a frame of a sequence: its picture from the windows that hold it, its passes from all of its samples.
#pragma once

#include <optional>

#include <tbb/task_arena.h>

#include "animation/developed_frame.h"
#include "animation/sequence.h"
#include "base/cancel_check.h"

namespace gradus::animation {

class FrameDeveloper {
 public:
  // asked: what it is made of otherwise than it was sampled for, and the number of threads that make it; nothing: what
  // the folder knows. All that is given lives as long as it.
  FrameDeveloper(Sequence* sequence, int32_t number, const std::optional<GradusSettings>& requested,
                 const CancelCheck& is_cancelled);

  // In this order. Both throw the Error CANCELLED.
  std::shared_ptr<DevelopedFrame> load();
  void develop_picture(DevelopedFrame* developed);

  // Whether it would be made the same way.
  bool would_develop(const DevelopedFrame& developed) const;

 private:
  std::shared_ptr<DevelopedFrame> read();
  void check_cancelled() const;
  Delivery delivery(const FrameRecord& record, bool is_planned, const film::Film& film) const;
  void reconstruct(DevelopedFrame* developed);
  void denoise(DevelopedFrame* developed);
  // Light passes follow what the picture has become.
  void split_light(DevelopedFrame* developed);
  // Passes Gradient T and Gradient T Link, of the frame's own half.
  void read_differences_over_time(const film::Film& fresh, DevelopedFrame* developed);

  Sequence& sequence_;
  const int32_t number_;
  const std::optional<GradusSettings> requested_;
  const CancelCheck& is_cancelled_;
  const uint32_t threads_;
  tbb::task_arena arena_;
};

}  // namespace gradus::animation
