// Samples a frame of a sequence: its own half, and the one that replays the frame before.
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
  // Of its own half.
  void read_pass(uint32_t pass, float* pixels) const override { fresh_.read_pass(pass, pixels); }
  void read_component(const std::string& name, uint32_t pass, float* pixels) const override {
    fresh_.read_component(name, pass, pixels);
  }
  std::string stats() const override;
  std::shared_ptr<const film::Film> film() const override;

 private:
  void render() override;
  uint64_t memory_bytes() const override { return 0; }

  // What the folder has of the frame, if it fits.
  std::optional<film::FilmHeader> stored(FrameSamples kind) const;
  std::optional<film::FilmHeader> stored_fresh() const;
  // Of a half of an earlier frame, which gets no more samples.
  bool has_enough(const film::FilmHeader& half, FrameSamples kind) const;
  // Returns the frame that was sampled, or reads the stored one. Takes the lock, but not while it reads a file.
  std::shared_ptr<const film::Film> fresh_film(const char* what) const;
  std::shared_ptr<film::Film> read(FrameSamples kind, film_io::StoredContent content, const CancelCheck& cancel) const;
  std::shared_ptr<film::Film> load(FrameSamples kind, film_io::StoredContent content = film_io::StoredContent::kAll);
  bool repeats_before() const;
  bool differs_from_before() const;
  void repeat_before();
  void sample_fresh_and_replayed();
  void resume_samples();
  // counts: the base's samples of each pixel, where pixels may differ in them.
  void sample_replayed(const film::FilmHeader& fresh, const std::vector<uint32_t>& counts, bool samples_fresh);
  void run(render::RenderLoop* loop);
  void save(const film::Film& frame, FrameSamples kind);
  bool follows_before() const;
  // Whether a stored offset is of what the frame follows now: other steps, parts or scenes of a job have other frames
  // before it. Where nobody has told what comes before, it is.
  bool replays_before(const film::FilmHeader& replayed) const;
  std::shared_ptr<const render::Replay> follow(const film::FilmHeader& fresh, const std::vector<uint32_t>& counts);
  render::LoopInput fresh_input() const;
  // From here on it is the frame before.
  void finish(const film::FilmHeader& fresh, std::vector<uint32_t> counts);

  const std::shared_ptr<Sequence> sequence_;
  const render::LoopInput input_;
  const std::optional<film::FilmHeader> stored_fresh_;
  render::RenderLoop fresh_;
  std::unique_ptr<render::RenderLoop> replayed_;
  double resumed_mean_ = 0.0;                       // samples per pixel that the base went on from
  mutable std::mutex reading_;                      // is held while a stored frame is read, so that it is read once
  mutable std::shared_ptr<const film::Film> film_;  // of one that was stored: when it is asked for
  FrameRecord record_;
};

}  // namespace gradus::animation
