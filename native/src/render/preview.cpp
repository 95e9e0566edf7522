#include "render/preview.h"

#include "base/clock.h"
#include "render/quarter_preview.h"
#include "render/show_combined.h"

namespace gradus::render {

Preview::Preview(const LoopInput& input, const Plan& plan, const std::atomic<bool>& stop, tbb::task_arena* arena,
                 Picture* picture, ProgressTracker* tracker)
    : input_(input), plan_(plan), stop_(stop), arena_(arena), picture_(picture), tracker_(tracker) {}

// Previews use REGULARIZED in place of the denoiser: the network takes tens of times as long as a regression on the
// denoising features, which the film has anyway.
uint32_t Preview::shown(uint32_t reconstruction) const {
  return reconstruction == GRADUS_RECONSTRUCTION_NONE && plan_.denoises ? uint32_t{GRADUS_RECONSTRUCTION_REGULARIZED}
                                                                        : reconstruction;
}

bool Preview::quarter_is_due(uint32_t reconstruction) const {
  return is_watched() && !has_quarter_ && shown(reconstruction) != GRADUS_RECONSTRUCTION_NONE;
}

bool Preview::refresh_is_due(uint32_t reconstruction, double sampled, double fraction) const {
  return is_watched() && shown(reconstruction) != GRADUS_RECONSTRUCTION_NONE && rule_.is_due(sampled, fraction);
}

void Preview::show_quarter() {
  has_quarter_ = true;
  const ScopedTimer timer(&seconds_, &cpu_seconds_);
  const auto integrator = input_.make_integrator(quarter_settings(input_.settings), GRADUS_INTEGRATOR_PATH);
  QuarterPreview quarter;
  arena_->execute([&] { quarter = render_quarter_preview(*integrator, input_.settings, plan_, stop_); });
  if (is_stopped()) return;
  rule_.expect(quarter.seconds_per_pixel * double(plan_.sampled.area()));
  picture_->show(std::move(quarter.rgba), std::move(quarter.error));
  tracker_->new_image();
}

void Preview::refresh(const film::Film& film, double sampled) {
  const double before = seconds_;
  {
    const ScopedTimer timer(&seconds_, &cpu_seconds_);
    reconstruct::SolveReport report;
    if (!show_combined(film, shown(film.settings.reconstruction), plan_, stop_, arena_, picture_, &report)) return;
  }
  tracker_->new_image();
  rule_.done(sampled, seconds_ - before);
}

}  // namespace gradus::render
