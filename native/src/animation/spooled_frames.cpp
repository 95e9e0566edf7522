#include "animation/spooled_frames.h"

#include <utility>
#include <vector>

#include "animation/frame_window.h"
#include "base/cancel_check.h"

namespace gradus::animation {
namespace {

// A window whose rows are read from temporary files. Each read polls for cancelling, because a solver reads the rows of
// all frames many times.
class SpooledWindow final : public reconstruct::HalvedWindowSource {
 public:
  SpooledWindow(std::vector<std::shared_ptr<const SpooledFrame>> frames, CancelCheck cancel)
      : frames_(std::move(frames)), cancel_(std::move(cancel)) {}

  reconstruct::WindowSize size() const override {
    reconstruct::WindowSize size = frames_.front()->size();
    size.frames = int(frames_.size());
    return size;
  }
  void read_row(reconstruct::RowKind kind, int t, int y, float* out) const override { frame(t).read_row(kind, y, out); }
  void read_half_differences(reconstruct::RowKind kind, int t, int y, float* out) const override {
    frame(t).read_half_differences(kind, y, out);
  }
  void read_correspondence(int t, int y, int32_t* out) const override { frame(t).read_correspondence(y, out); }

 private:
  const SpooledFrame& frame(int t) const {
    throw_if_cancelled(cancel_);
    return *frames_[size_t(t)];
  }

  const std::vector<std::shared_ptr<const SpooledFrame>> frames_;
  const CancelCheck cancel_;
};

// Calls function(plane) for every plane of the images.
template <class Images, class Function>
void for_planes(Images* images, const Function& function) {
  for (auto* part : {&images->values, &images->half_differences}) {
    for (auto* plane : {&part->primal, &part->dx, &part->dy}) function(plane);
  }
}

}  // namespace

// The fresh samples of a window's last frame in a temporary file, until the next window needs them for the temporal
// differences to the frame after.
class SpooledFrames::SpooledFresh {
 public:
  SpooledFresh(int place, const TemporalFrame& frame, const CancelCheck& cancel)
      : place_(place), shape_(shape_of(frame)) {
    uint64_t at = 0;
    for_planes(&frame.fresh, [&](const std::vector<float>* plane) {
      throw_if_cancelled(cancel);
      file_.write(at, plane->data(), plane->size() * sizeof(float));
      sizes_.push_back(plane->size());
      at += plane->size() * sizeof(float);
    });
  }

  int place() const { return place_; }
  std::shared_ptr<const TemporalFrame> read(const CancelCheck& cancel) const {
    auto frame = std::make_shared<TemporalFrame>(shape_);
    uint64_t at = 0;
    auto size = sizes_.begin();
    for_planes(&frame->fresh, [&](std::vector<float>* plane) {
      throw_if_cancelled(cancel);
      plane->resize(*size++);
      file_.read(at, plane->data(), plane->size() * sizeof(float));
      at += plane->size() * sizeof(float);
    });
    return frame;
  }

 private:
  static TemporalFrame shape_of(const TemporalFrame& frame) {
    TemporalFrame shape;
    shape.stream = frame.stream;
    shape.scene_key = frame.scene_key;
    const film::GradientImages& images = frame.fresh.values;
    for (film::GradientImages* to : {&shape.fresh.values, &shape.fresh.half_differences}) {
      to->width = images.width;
      to->height = images.height;
      to->channels = images.channels;
    }
    return shape;
  }

  int place_;
  TemporalFrame shape_;
  std::vector<size_t> sizes_;
  SpoolFile file_;
};

SpooledFrames::SpooledFrames(LoadSamples fresh, LoadSamples replay, TemporalContent content)
    : fresh_(std::move(fresh)), replay_(std::move(replay)), content_(content) {}
SpooledFrames::~SpooledFrames() = default;

std::shared_ptr<const TemporalFrame> SpooledFrames::load(int place, const CancelCheck& cancel) const {
  const std::shared_ptr<const film::Film> fresh = fresh_(place, cancel), replay = replay_(place, cancel);
  return std::make_shared<TemporalFrame>(make_temporal_frame(*fresh, *replay, content_));
}

std::shared_ptr<const TemporalFrame> SpooledFrames::fresh_of(int place, const CancelCheck& cancel) const {
  if (end_ && end_->place() == place) return end_->read(cancel);
  return std::make_shared<TemporalFrame>(make_fresh(*fresh_(place, cancel), content_));
}

std::unique_ptr<reconstruct::HalvedWindowSource> SpooledFrames::window(int first, int last, const CancelCheck& cancel) {
  frames_.erase(frames_.begin(), frames_.lower_bound(first));
  std::shared_ptr<const TemporalFrame> before;  // the frame at place - 1
  for (int place = first; place <= last; ++place) {
    if (frames_.count(place) > 0) continue;
    throw_if_cancelled(cancel);
    const auto frame = load(place, cancel);
    if (place > first) {
      if (!before) before = fresh_of(place - 1, cancel);
      frames_.at(place - 1)->write_differences(before, frame, cancel);
    }
    frames_[place] = std::make_shared<SpooledFrame>(frame, content_, cancel);
    before = frame;
  }
  if (before) end_ = std::make_unique<SpooledFresh>(last, *before, cancel);
  std::vector<std::shared_ptr<const SpooledFrame>> frames;
  for (int place = first; place <= last; ++place) frames.push_back(frames_.at(place));
  return std::make_unique<SpooledWindow>(std::move(frames), cancel);
}

}  // namespace gradus::animation
