// Task that samples a frame of a sequence: fresh samples with random numbers of its own, and replayed samples with
// those of the previous frame. Both are written to the sequence's folder.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "animation/sequence.h"
#include "render/loop.h"

namespace gradus::animation {

class FrameSampling final : public render::RenderTask {
 public:
  FrameSampling(std::shared_ptr<Sequence> sequence, render::LoopInput input);

  void cancel() override;
  GradusProgress progress() const override;
  const Region& delivered() const override { return fresh_.delivered(); }
  // Passes, while the frame is sampled, are those of the fresh samples.
  void read_pass(uint32_t pass, float* pixels) const override { fresh_.read_pass(pass, pixels); }
  void read_channel(uint32_t kind, const std::string& name, uint32_t layer, float* pixels) const override {
    fresh_.read_channel(kind, name, layer, pixels);
  }
  void read_component(const std::string& name, uint32_t pass, float* pixels) const override {
    fresh_.read_component(name, pass, pixels);
  }
  std::string stats() const override;
  std::shared_ptr<const film::Film> film() const override;

 private:
  void render() override;
  uint64_t memory_bytes() const override { return 0; }

  bool is_in_job() const { return sequence_->is_in_job(input_.settings.frame); }
  // Finds the stored samples of the frame that can be used.
  void find_stored();
  // Returns the header of stored samples of one kind if they can be used. If not, and there are any, tells the sequence
  // why.
  std::optional<film::FilmHeader> find_stored(FrameSamples kind);
  // Returns how stored samples differ from those of this frame, or "".
  std::string difference_of(const film::FilmHeader& header, FrameSamples kind) const;
  // Whether the samples of an identical earlier frame, to which none are added, suffice for this frame.
  bool has_enough(const film::FilmHeader& header, FrameSamples kind) const;
  // Returns the frame that was sampled, or reads the stored one. Takes the lock, but not while it reads a file.
  std::shared_ptr<const film::Film> fresh_film(const char* what) const;
  std::shared_ptr<film::Film> read(FrameSamples kind, film_io::StoredContent content, const CancelCheck& cancel) const;
  // Finds damage in the stored samples.
  void check(FrameSamples kind);
  std::shared_ptr<film::Film> load(FrameSamples kind, film_io::StoredContent content = film_io::StoredContent::kAll);
  // Whether the frame is identical to the previous one, so that it can use its files.
  bool repeats_before() const;
  bool differs_from_before() const;
  void repeat_before();
  void sample_fresh_and_replayed();
  void resume_samples();
  // counts: number of fresh samples of each pixel; empty unless has_counts(). samples_fresh: whether fresh samples were
  // taken, rather than read.
  void sample_replayed(const film::FilmHeader& fresh, const std::vector<uint32_t>& counts, bool samples_fresh);
  void run(render::RenderLoop* loop);
  void save(const film::Film& film, FrameSamples kind);
  bool follows_before() const;
  // Whether stored replayed samples replay the frame that is the previous one now: a job with another step, range or
  // scene has another previous frame. True if the previous frame is not known.
  bool replays_before(const film::FilmHeader& replayed) const;
  // Plans the replay of the previous frame: which pixels it replays, and how many samples each pixel takes.
  std::shared_ptr<const render::Replay> follow(const film::FilmHeader& fresh, const std::vector<uint32_t>& counts);
  render::LoopInput fresh_input() const;
  // Records how the frame was sampled and makes it the sequence's previous frame.
  void finish(const film::FilmHeader& fresh, std::vector<uint32_t> counts);

  const std::shared_ptr<Sequence> sequence_;
  const render::LoopInput input_;
  std::optional<film::FilmHeader> stored_fresh_, stored_replayed_;  // without a value: there are none that can be used
  render::RenderLoop fresh_;
  std::unique_ptr<render::RenderLoop> replayed_;
  std::shared_ptr<const motion::CentreView> centres_;  // view of the snapshot, if the frame before is followed
  double resumed_mean_ = 0.0;                          // stored fresh samples per pixel, to which new ones are added
  mutable std::mutex reading_;                         // is held while a stored film is read, so that it is read once
  mutable std::shared_ptr<const film::Film> film_;     // fresh samples; if stored, they are read on first use
  FrameRecord record_;
};

}  // namespace gradus::animation
