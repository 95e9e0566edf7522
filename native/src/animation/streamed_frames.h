// Reads the frames of a sequence in order, each with its temporal differences to the next frame. Each file is read
// once.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "animation/temporal_frame.h"
#include "reconstruct/space_time/window_source.h"

namespace gradus::animation {

class StreamedFrames {
 public:
  // Merges the fresh and the replayed samples of a frame.
  using Merge = std::function<std::shared_ptr<const film::Film>(int place, std::shared_ptr<film::Film> fresh,
                                                                const film::Film& replay)>;
  // fresh, replay: load samples of frames, all with the same components.
  StreamedFrames(LoadSamples fresh, LoadSamples replay, Merge merge);

  // Returns all samples of a frame. To read each file once, call merged_film() and then differences() for each place in
  // order. Uses the threads of the caller's arena. Throws Error CANCELLED.
  std::shared_ptr<const film::Film> merged_film(int place, const CancelCheck& cancel);
  // Returns for each component a window of this frame and the next one. It has pixels and their temporal differences
  // only. Throws Error CANCELLED, and invalid_argument if the two frames have different components.
  std::vector<std::unique_ptr<reconstruct::HalvedWindowSource>> differences(int place, const CancelCheck& cancel);

 private:
  using Images = std::vector<std::shared_ptr<const TemporalFrame>>;  // one for each component
  const Images& images(int place, const CancelCheck& cancel);
  void load(int place, const CancelCheck& cancel);

  const LoadSamples fresh_, replay_;
  const Merge merge_;
  std::map<int, Images> images_;                             // at most two frames
  std::map<int, std::shared_ptr<const film::Film>> merged_;  // the last frame that was read, until frame() returns it
};

}  // namespace gradus::animation
