// Frames of an animation, sampled one after the other and reconstructed together.
//
// REGULARIZED joins the independent samples of several frames (reconstruct/space_time/joint_regression.h). L2 and L1
// compare samples (Manzi et al. 2016, "Temporal gradient-domain path tracing"): half of the samples of a frame have its
// own random numbers (fresh), the other half those of the previous frame, moved to the pixels that show the same
// surfaces now (replayed). Differences between replayed samples and those that they replay have little noise. In both
// cases a frame has two films, of which the second holds its pixel correspondence.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "animation/component_flows.h"
#include "animation/frame_record.h"
#include "animation/sequence_folder.h"
#include "animation/stale_frames.h"
#include "animation/temporal_frame.h"
#include "base/warnings.h"
#include "reconstruct/space_time/sequence_pictures.h"
#include "render/loop_input.h"
#include "render/render_task.h"
#include "render/stats.h"

namespace gradus::animation {

struct SequenceSettings {
  int32_t first = 0, last = 0;  // rendered frame numbers: first, first + step … up to last
  uint32_t step = 1;
  reconstruct::WindowShape windows;
  std::string folder;         // folder of the frame store; empty: a temporary folder
  bool with_flow = false;     // whether passes by optical flow are requested, for which a frame needs the next one
  std::string flow_folder{};  // folder of libgradus_flow.so; empty: that of this library
};

// Whether frames with these settings can be reconstructed together with others. If not, sets *why_not to the reason.
bool sequence_applies(const GradusSettings& settings, std::string* why_not);

class Sequence : public std::enable_shared_from_this<Sequence> {
 public:
  // Throws invalid_argument for settings that are not valid, invalid_operation if the folder cannot be made.
  Sequence(std::shared_ptr<scene::Device> device, const SequenceSettings& settings,
           render::IntegratorFactory factory = render::make_integrator);
  Sequence(const Sequence&) = delete;
  Sequence& operator=(const Sequence&) = delete;

  // Returns the range of frames that must have been sampled before settings.frame can be delivered. Frames beyond the
  // job are among them if the folder holds them.
  reconstruct::FrameRange needs(const GradusSettings& settings) const;
  // Ends the sequence early: `frame` is its last one.
  void end_at(int32_t frame);

  // sample() and deliver() return tasks to be run one at a time: a task may only be requested when the previous one has
  // ended.
  //
  // Samples settings.frame, unless the folder holds its samples or nothing has changed since the previous frame. Stored
  // samples that do not fit are replaced. A frame beyond the job gets no samples of its own: it joins the frames of
  // the job if its stored samples fit.
  std::unique_ptr<render::RenderTask> sample(std::shared_ptr<const scene::Snapshot> snapshot,
                                             const GradusSettings& settings);
  // Passes by settings.frame, which is not sampled here. The snapshot shows that frame, so that the next one can replay
  // it. Windows end before it and begin after it, as for all frames that are not sampled.
  void pass_by(std::shared_ptr<const scene::Snapshot> snapshot, const GradusSettings& settings);
  // Reconstructs and delivers a frame. Frames must be delivered in order. settings: options that replace those with
  // which the frame was sampled (reconstruction, alpha, denoiser, exposure, threads), or nullptr.
  std::unique_ptr<render::RenderTask> deliver(int32_t frame, const GradusSettings* settings);
  // Adds a warning about the stored frames that were sampled again, and one about those beyond the job that are not
  // used. Each frame is named once.
  void warn_of_stale_frames(Warnings* warnings);
  const SequenceFolder& folder() const { return folder_; }

 private:
  friend class FrameSampling;
  friend class FrameDelivery;
  friend class FrameDeveloper;

  // Converts a frame number to a place: places count in steps, so that frames of one sequence are next to each other,
  // and do not depend on which range of frames a job renders. Throws invalid_argument between two steps.
  int place_of(int32_t frame) const;
  int32_t frame_at(int place) const;
  reconstruct::FrameRange job_places() const;
  bool is_in_job(int32_t frame) const { return frame >= settings_.first && frame <= settings_.last; }
  // The samples of a stored frame, which another process of the same job may have taken. No header: there are none that
  // can be used.
  struct StoredFrame {
    std::optional<film::FilmHeader> fresh;
    std::vector<uint32_t> counts;  // of samples per pixel, if pixels may have different ones
  };
  StoredFrame stored_frame_of(const scene::Snapshot& snapshot, const GradusSettings& settings) const;
  // Records that stored samples of a frame do not fit.
  void add_stale(int32_t frame, const std::string& why);
  // Whether windows may contain the stored frame: one that this job sampled or found to fit, or any frame if the job
  // only delivers what is stored.
  bool is_usable(int32_t frame) const;
  // Returns the first frame of all windows that contain a frame. No picture of it or of later frames needs earlier
  // ones.
  int32_t first_of_windows(int32_t frame) const;
  // Warns once if the machine has less memory, or the disk less room, than the animation is estimated to need.
  void warn_of_needs(const render::Plan& plan, std::vector<std::string>* warnings);
  // Returns the places of the job and of the frames next to it that the folder holds. Whether these fit is known when
  // they are sampled.
  reconstruct::FrameRange places_with_neighbours() const;
  // Whether the frame at `place` can share windows with the previous one. If not, windows end between the two.
  bool shares_window_with_previous(int place, uint32_t reconstruction);
  // Return the first place from `begin` on, and the last one up to `end`, between which and `place` all frames can
  // share windows with their neighbours.
  int first_connected(int place, int begin, uint32_t reconstruction);
  int last_connected(int place, int end, uint32_t reconstruction);
  const FrameTraits& traits_at(int place);
  // Returns a function that loads stored samples with these components alone, in this order.
  LoadSamples load_samples(FrameSamples kind, const std::vector<std::string>& components) const;
  // Adds the replayed samples to the fresh ones. Throws invalid_argument if the two do not belong together.
  void merge(int32_t frame, film::Film* fresh, const film::Film& replayed) const;
  reconstruct::SequenceSource source(const reconstruct::SequenceMethod& method,
                                     const std::vector<std::string>& components) const;
  // Returns the reconstruction of components that share their weights, from which the picture of `frame` can be taken.
  // It starts anew if that picture was already taken or the method has changed.
  reconstruct::SequencePictures* pictures(const std::vector<std::string>& components,
                                          const reconstruct::SequenceMethod& method, int32_t frame);
  // Returns the number of samples per pixel that REGULARIZED makes a picture from where frames like this one surround
  // it. Frames at the ends of a shot, and repeated ones, have fewer, but all of a shot are to look alike. Replayed
  // samples do not count, since they are those of the frame before.
  double joined_samples(int32_t frame);
  // Removes all reconstructions except those of these groups of components, since the component set may have changed.
  void retain_pictures(const std::vector<std::vector<std::string>>& groups);
  // Returns Tracked if flow can be estimated between the frame at `place` and the previous one, otherwise the cause.
  // reconstruction: method of both pictures.
  motion::Tracking flows_to(int place, uint32_t reconstruction);
  // Returns what is known of a frame that was sampled: how it was planned, or what its files hold. The number of its
  // samples is not among it.
  output::FilmFacts facts_of(int32_t frame);
  // Returns the flow library, or nullptr if there is none. The first call then adds a warning.
  const motion::FlowLibrary* flow_library(std::vector<std::string>* warnings);
  // Forgets frames before this one, which no later picture needs.
  void forget_before(int32_t frame);

  const std::shared_ptr<scene::Device> device_;
  const SequenceSettings settings_;
  const render::IntegratorFactory factory_;
  const SequenceFolder folder_;
  int32_t last_;
  bool needs_are_checked_ = false;
  bool samples_ = false;  // whether frames are sampled, rather than only delivered
  StaleFrames sampled_again_, unused_neighbours_;
  std::unique_ptr<const PreviousFrame> before_;
  std::map<int32_t, FrameRecord> records_;
  std::map<int32_t, FrameTraits> traits_;  // of frames that were sampled, or whose headers were read
  std::map<std::vector<std::string>, std::unique_ptr<reconstruct::SequencePictures>> pictures_;
  std::shared_ptr<DevelopedFrame> ahead_;  // next frame to deliver, if flow from the previous one needed it
  FrameFlows back_;                        // flows from `ahead_` to its previous frame
  std::optional<std::shared_ptr<const motion::FlowLibrary>> flow_library_;  // without a value until it is searched for
};

}  // namespace gradus::animation
