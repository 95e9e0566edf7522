// The loop of one render.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include <tbb/task_arena.h>

#include "base/clock.h"
#include "film/film.h"
#include "output/light_passes.h"
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
  // Goes on from the samples of a frame; before run(). Throws invalid_argument if its keys or planes differ.
  void resume(std::shared_ptr<const film::Film> film);
  // When it has ended.
  const RenderStats& what_it_took() const { return stats_; }

  const Region& delivered() const override { return plan_.delivered; }
  void read_pass(uint32_t pass, float* pixels) const override;
  void read_component(const std::string& name, uint32_t pass, float* pixels) const override;
  std::string stats() const override;
  std::shared_ptr<const film::Film> film() const override;

 private:
  void render() override;
  void ending(GradusError code) override;
  uint64_t memory_bytes() const override;
  void prepare();
  // Whether gradients pay, and where; all of the picture if that is not asked.
  GradientMap choose_gradients();
  // Those of the plan, but for the small ones.
  lpe::ComponentSet choose_components();
  void sample();
  void reconstruct_film();
  // Of components, from what the scene knows of the frames around.
  void find_motion();
  void denoise_film();
  // Light passes follow what the picture has become.
  void split_light();
  // False: nothing more to do.
  bool next_batch(uint32_t begin, uint32_t* end) const;
  uint32_t affordable_samples(uint32_t begin) const;
  // Finds out which cells are done and where the next samples go.
  void judge();
  void run_batch(uint32_t begin, uint32_t end);
  void tile_done(const Region& tile, uint64_t pixel_samples);
  // What a watcher is shown (render/preview.h), before the samples from `begin` on are taken or between two of their
  // tiles.
  bool show_is_due(uint32_t begin) const;
  void show(uint32_t begin);
  bool is_done() const { return adaptive_ && adaptive_->all_done(); }  // by noise
  bool is_sampling() const { return phase_ < GRADUS_PHASE_RECONSTRUCTING; }
  void set_phase(GradusPhase phase);

  LoopInput input_;
  std::string why_no_denoiser_;
  const std::shared_ptr<const output::OidnLibrary> denoiser_;
  const Plan plan_;
  mutable tbb::task_arena arena_;
  Picture picture_;
  mutable Preview live_view_;  // readers are its watchers

  // Set by prepare(), before the phase becomes SAMPLING; the frame's content is the samplers' alone until that phase
  // ends.
  std::shared_ptr<film::Film> film_;
  std::unique_ptr<integrator::Integrator> integrator_;
  GradientMap gradients_;
  lpe::ComponentSet components_;
  std::unique_ptr<AdaptiveSampling> adaptive_;  // where the plan is

  std::unique_ptr<TileSampler> sampler_;

  std::atomic<uint64_t> work_done_{0};  // pixel samples
  std::atomic<int64_t> last_image_ms_{0};
  Stopwatch sampling_;        // without what a watcher is shown meanwhile
  uint32_t first_begin_ = 0;  // samples that were resumed
  RenderStats stats_;
  std::shared_ptr<const output::LightPasses> light_;  // of the picture; nullptr where it has none
};

}  // namespace gradus::render
