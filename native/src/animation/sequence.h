// Frames of an animation, sampled one after the other and reconstructed together (contract 4; Manzi et al. 2016,
// "Temporal gradient-domain path tracing"). Each frame is sampled twice, with half of its samples each time: with its
// own random numbers, and with those of the frame before, moved along to where the same surfaces are seen now.
// Differences between the two have little noise.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "animation/component_flows.h"
#include "animation/frame_record.h"
#include "animation/load_samples.h"
#include "animation/sequence_folder.h"
#include "reconstruct/space_time/sequence_pictures.h"
#include "render/loop_input.h"
#include "render/render_task.h"
#include "render/stats.h"

namespace gradus::animation {

struct SequenceSettings {
  int32_t first = 0, last = 0;  // frames that are rendered: first, first + step … not beyond last
  uint32_t step = 1;
  reconstruct::WindowShape windows;
  std::string folder;         // where raw frames are kept and found again; empty: nowhere
  bool with_flow = false;     // passes by optical flow are asked for: frames need the next one, too
  std::string flow_folder{};  // where libgradus_flow.so is; empty: beside this library
};

// Whether frames with these settings have differences over time, and why not.
bool sequence_applies(const GradusSettings& settings, std::string* why_not);

class Sequence : public std::enable_shared_from_this<Sequence> {
 public:
  // Throws invalid_argument for settings that make no sense, invalid_operation where the folder cannot be made.
  Sequence(std::shared_ptr<scene::Device> device, const SequenceSettings& settings,
           render::IntegratorFactory factory = render::make_integrator);
  Sequence(const Sequence&) = delete;
  Sequence& operator=(const Sequence&) = delete;

  // Frames of the range that must have been sampled before `frame` can be delivered.
  reconstruct::FrameRange needs(int32_t frame) const;
  // Frames beyond this one do not come after all.
  void end_at(int32_t frame);

  // Tasks to be run, one at a time: the next is asked for when the one before has ended.
  //
  // Samples settings.frame, unless the folder holds it, or nothing has changed since the frame before.
  std::unique_ptr<render::RenderTask> sample(std::shared_ptr<const scene::Snapshot> snapshot,
                                             const GradusSettings& settings);
  // The snapshot shows settings.frame, which is not sampled here: the next frame follows it. Windows end before it and
  // begin after it.
  void pass_by(std::shared_ptr<const scene::Snapshot> snapshot, const GradusSettings& settings);
  // Reconstructs and delivers a frame. settings: what it is made of otherwise than it was sampled for (reconstruction,
  // alpha, denoiser, exposure); nullptr: nothing. Frames in order.
  std::unique_ptr<render::RenderTask> deliver(int32_t frame, const GradusSettings* settings);
  const SequenceFolder& folder() const { return folder_; }

 private:
  friend class FrameSampling;
  friend class FrameDelivery;
  friend class FrameDeveloper;

  // Frames are counted in steps, so that those of one grid are next to each other whatever part of a job they are
  // rendered in.
  int place_of(int32_t frame) const;
  int32_t frame_at(int place) const;
  reconstruct::FrameRange job_places() const;
  // Warns once where the machine may have less memory, or the disk less room, than the animation takes.
  void warn_of_needs(const render::Plan& plan, std::vector<std::string>* warnings);
  // The frames that are rendered, and those beside them that the folder holds.
  reconstruct::FrameRange places_with_neighbours() const;
  // Whether the frame at `place` can share windows with the one before. Where it cannot, they are cut.
  bool shares_window_with_previous(int place, uint32_t reconstruction);
  const FrameTraits& traits_at(int place);
  // Of these components, in this order.
  LoadSamples load_samples(FrameSamples kind, const std::vector<std::string>& components) const;
  // All samples of a frame, in the place of its own half.
  void merge(int32_t frame, film::Film* fresh, const film::Film& replayed) const;
  reconstruct::SequenceSource source(const reconstruct::SequenceMethod& method,
                                     const std::vector<std::string>& components) const;
  // Of components that are reconstructed together, that have the picture of `frame`: begun anew where it was taken
  // before, or by another method.
  reconstruct::SequencePictures* pictures(const std::vector<std::string>& components,
                                          const reconstruct::SequenceMethod& method, int32_t frame);
  // Of these groups of components alone: others are of a set that has changed.
  void retain_pictures(const std::vector<std::vector<std::string>>& groups);
  // Whether flow leads from the frame before to the one at `place`; if not, why. reconstruction: of their pictures.
  motion::Tracking flows_to(int place, uint32_t reconstruction);
  // nullptr: there is none, which is told once.
  const motion::FlowLibrary* flow_library(std::vector<std::string>* warnings);
  // Those that no picture to come needs.
  void forget_before(int32_t frame);

  const std::shared_ptr<scene::Device> device_;
  const SequenceSettings settings_;
  const render::IntegratorFactory factory_;
  const SequenceFolder folder_;
  int32_t last_;
  bool needs_are_checked_ = false;
  std::unique_ptr<const PreviousFrame> before_;
  std::map<int32_t, FrameRecord> records_;
  std::map<int32_t, FrameTraits> traits_;  // of frames that were sampled or looked at
  std::set<int32_t> passed_by_;
  std::map<std::vector<std::string>, std::unique_ptr<reconstruct::SequencePictures>> pictures_;
  std::shared_ptr<DevelopedFrame> ahead_;  // made for the frame before it, by flow, and not delivered yet
  FrameFlows back_;                        // of `ahead_` to the frame before it
  std::optional<std::shared_ptr<const motion::FlowLibrary>> flow_library_;  // once it was looked for
};

}  // namespace gradus::animation
