// The loop of one render: plan, batches of samples, reconstruction, denoiser.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include <tbb/task_arena.h>

#include "base/clock.h"
#include "film/film.h"
#include "output/oidn_library.h"
#include "render/adaptive_sampling.h"
#include "render/loop_input.h"
#include "render/picture.h"
#include "render/pilot.h"
#include "render/plan.h"
#include "render/preview.h"
#include "render/render_task.h"
#include "render/stats.h"
#include "render/tile_sampler.h"

namespace gradus::render {

class RenderLoop final : public RenderTask {
 public:
  explicit RenderLoop(LoopInput input);

  const Plan& plan() const { return plan_; }
  // Continues from the samples of a film. Must be called before run(). Throws `invalid_argument` if the keys or planes
  // of the film differ.
  void resume(std::shared_ptr<const film::Film> film);
  // Returns the statistics. Valid after the render has ended.
  const RenderStats& what_it_took() const { return stats_; }

  const Region& delivered() const override { return plan_.delivered; }
  void read_pass(uint32_t pass, float* pixels) const override;
  void read_component(const std::string& name, uint32_t pass, float* pixels) const override;
  void read_channel(uint32_t kind, const std::string& name, uint32_t layer, float* pixels) const override;
  std::string stats() const override;
  std::shared_ptr<const film::Film> film() const override;

 private:
  void render() override;
  void ending(GradusError code) override;
  uint64_t memory_bytes() const override;
  void prepare();
  // Returns whether the quarter preview is due before the film takes samples.
  bool quarter_is_due() const;
  // Learns by discarded paths where the light comes from, and guides all further paths by it if that pays.
  void learn_guide();
  // Returns the pixels with gradients, as a pilot finds them; all or no pixels if the plan has no pilot.
  GradientMap choose_gradients();
  // Returns the components of the plan, with the small ones merged into the remainder.
  lpe::ComponentSet choose_components();
  void sample();
  // Makes the delivered picture and its passes from the film.
  void develop_film(bool denoises);
  // Computes the motion of components from the snapshot, which knows the frames before and after.
  void find_motion();
  // Sets the end of the batch that begins at `begin`. Returns false if there is no further batch.
  bool next_batch(uint32_t begin, uint32_t* end) const;
  // Returns how many more samples per pixel the time limit allows.
  uint32_t affordable_samples(uint32_t begin) const;
  // Estimates the noise of the blocks, stops those below the threshold and updates how the others share samples.
  void judge();
  // Finds the pixels at edges of emitters, whose paths take further camera rays.
  void find_edges();
  void run_batch(uint32_t begin, uint32_t end);
  // Returns how many samples of a pixel one net of points has (path/sampler.h); 0: pixels have points of their own.
  uint32_t net_samples() const;
  // Returns whether edges take further samples (render/edge_sampling.h) behind the batch that ends at `end`.
  bool refines_edges(uint32_t end) const;
  // Returns whether the render is of a kind whose edges may take further samples.
  bool may_refine_edges() const;
  // Takes them. They have numbers of their own, so that a render that is resumed from the film takes the same ones.
  void sample_edges(uint32_t end);
  // Runs the batch that the sampler has started, and makes previews in between.
  void finish_batch(uint32_t begin);
  void tile_done(const Region& tile, uint64_t pixel_samples);
  // Returns whether the preview (render/preview.h) has a new image to show, before the samples from `begin` on are
  // taken or between two of their tiles.
  bool show_is_due(uint32_t begin) const;
  void show(uint32_t begin);
  bool is_done() const { return adaptive_ && adaptive_->all_done(); }  // whether all blocks are below the threshold
  bool is_sampling() const { return phase_ < GRADUS_PHASE_RECONSTRUCTING; }
  void set_phase(GradusPhase phase);

  LoopInput input_;
  std::string why_no_denoiser_;
  const std::shared_ptr<const output::OidnLibrary> denoiser_;
  const Plan plan_;
  mutable tbb::task_arena arena_;
  Picture picture_;
  mutable Preview live_view_;  // readers of passes register as its viewers

  // Set by prepare() before the phase becomes SAMPLING. Until that phase ends, only the samplers access the content of
  // the film.
  std::shared_ptr<film::Film> film_;
  std::unique_ptr<integrator::Integrator> integrator_;
  GradientMap gradients_;
  std::vector<uint8_t> edges_;  // WorkUnit::edge_map
  lpe::ComponentSet components_;
  std::unique_ptr<AdaptiveSampling> adaptive_;  // nullptr if the render is not adaptive

  std::unique_ptr<TileSampler> sampler_;

  std::atomic<uint64_t> work_done_{0};  // finished samples, summed over pixels
  std::atomic<int64_t> last_image_ms_{0};
  Stopwatch sampling_;        // time of sampling, without previews
  uint32_t first_begin_ = 0;  // samples per pixel of the resumed film
  RenderStats stats_;
};

}  // namespace gradus::render
