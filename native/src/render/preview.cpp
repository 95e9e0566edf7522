#include "render/preview.h"

#include <tbb/parallel_for.h>

#include "base/clock.h"
#include "base/error.h"
#include "base/fpu.h"
#include "film/film.h"
#include "film/pixel_blocks.h"
#include "output/upsample.h"
#include "schema/pass_table.h"

namespace gradus::render {
namespace {

constexpr uint32_t kShrink = 4;
constexpr uint32_t kQuarterSamples = 2;  // one sample in each half-buffer

output::ImageSize size_of(const GradusSettings& settings) { return {settings.width, settings.height}; }

// Returns the settings of the quarter preview.
GradusSettings quarter_settings(GradusSettings settings) {
  settings.width = (settings.width + kShrink - 1) / kShrink;
  settings.height = (settings.height + kShrink - 1) / kShrink;
  settings.passes = 0;
  settings.first_sample = 0;
  return settings;
}

void sample(const integrator::Integrator& integrator, const std::atomic<bool>& stop, film::Film* film) {
  const std::vector<Region> tiles = film::make_pixel_blocks(film->region);
  tbb::parallel_for(size_t{0}, tiles.size(), [&](size_t i) {
    if (stop.load(std::memory_order_relaxed)) return;
    const FlushDenormals flush;
    integrator::WorkUnit unit;
    unit.tile = tiles[i];
    unit.count = kQuarterSamples;
    film::Counters counters;
    integrator.sample(unit, film, &counters, stop);
  });
}

}  // namespace

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
  const std::shared_ptr<const film::Film> film = sample_quarter();
  const WallClock clock;
  const auto developed = develop(film, GRADUS_RECONSTRUCTION_REGULARIZED, film->region,
                                 {.error = schema::has_bit(plan_.passes, GRADUS_PASS_ERROR)});
  if (!developed) return;
  rule_.expect(clock.seconds() / double(film->region.area()) * double(plan_.sampled.area()));
  arena_->execute([&] { picture_->show(enlarge_quarter(*developed)); });
  tracker_->new_image();
}

void Preview::refresh(const std::shared_ptr<const film::Film>& film, double sampled) {
  const double before = seconds_;
  {
    const ScopedTimer timer(&seconds_, &cpu_seconds_);
    auto developed =
        develop(film, shown(film->settings.reconstruction), plan_.delivered, output::wanted_images(film->settings));
    if (!developed) return;
    developed->film = nullptr;  // readers must not look into a film that is being sampled
    picture_->show(std::move(*developed));
  }
  tracker_->new_image();
  rule_.done(sampled, seconds_ - before);
}

std::shared_ptr<const film::Film> Preview::sample_quarter() const {
  const GradusSettings small = quarter_settings(input_.settings);
  const Region region = output::covering(plan_.delivered, size_of(input_.settings), size_of(small));
  auto film = std::make_shared<film::Film>(small.width, small.height, region, plan_.channels, 1, false);
  film::add_pass_channels(schema::feature_passes(), film.get());
  film->settings = small;
  const auto integrator = input_.make_integrator(small, GRADUS_INTEGRATOR_PATH);
  arena_->execute([&] { sample(*integrator, stop_, film.get()); });
  return film;
}

std::optional<output::DevelopedFilm> Preview::develop(std::shared_ptr<const film::Film> film, uint32_t reconstruction,
                                                      const Region& region,
                                                      const reconstruct::ReconstructionOutputs& wanted) const {
  output::Options options = output::options_of(film->settings);
  options.reconstruction = reconstruction;
  options.denoiser = GRADUS_DENOISER_NONE;
  output::DevelopedFilm developed{std::move(film), region, input_.threads, options};
  try {
    output::Developer(input_.threads, [this] { return is_stopped(); }).reconstruct(&developed, wanted);
    return developed;
  } catch (const Error& error) {
    if (error.code() != GRADUS_ERROR_CANCELLED) throw;
    return std::nullopt;
  }
}

output::DevelopedFilm Preview::enlarge_quarter(const output::DevelopedFilm& quarter) const {
  const output::ImageSize full = size_of(input_.settings), small = size_of(quarter.film->settings);
  output::DevelopedFilm enlarged{nullptr, plan_.delivered, quarter.threads, quarter.options};
  for (const auto& [pass, image] : quarter.passes) {
    enlarged.passes[pass] =
        output::make_image(output::enlarge(*image, schema::pass_info(pass).channels, plan_.delivered, full, small));
  }
  return enlarged;
}

}  // namespace gradus::render
