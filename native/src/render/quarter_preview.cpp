#include "render/quarter_preview.h"

#include <tbb/parallel_for.h>

#include "base/clock.h"
#include "base/fpu.h"
#include "film/film.h"
#include "film/pixel_blocks.h"
#include "output/combine.h"
#include "output/upsample.h"
#include "schema/pass_table.h"

namespace gradus::render {
namespace {

constexpr uint32_t kShrink = 4;
constexpr uint32_t kSamples = 2;  // one sample in each half-buffer

output::ImageSize size_of(const GradusSettings& settings) { return {settings.width, settings.height}; }

void sample(const integrator::Integrator& integrator, const std::atomic<bool>& stop, film::Film* film) {
  const std::vector<Region> tiles = film::make_pixel_blocks(film->region);
  tbb::parallel_for(size_t{0}, tiles.size(), [&](size_t i) {
    if (stop.load(std::memory_order_relaxed)) return;
    const FlushDenormals flush;
    integrator::WorkUnit unit;
    unit.tile = tiles[i];
    unit.count = kSamples;
    film::Counters counters;
    integrator.sample(unit, film, &counters, stop);
  });
}

}  // namespace

GradusSettings quarter_settings(GradusSettings settings) {
  settings.width = (settings.width + kShrink - 1) / kShrink;
  settings.height = (settings.height + kShrink - 1) / kShrink;
  settings.passes = 0;
  settings.first_sample = 0;
  return settings;
}

QuarterPreview render_quarter_preview(const integrator::Integrator& integrator, const GradusSettings& settings,
                                      const Plan& plan, const std::atomic<bool>& stop) {
  const GradusSettings small = quarter_settings(settings);
  const output::ImageSize full_size = size_of(settings), size = size_of(small);
  film::Film film(small.width, small.height, output::covering(plan.delivered, full_size, size), plan.channels, 1,
                  false);
  film::add_pass_channels(schema::feature_passes(), &film);
  film.settings = small;
  sample(integrator, stop, &film);
  const WallClock clock;
  const CancelCheck cancel = [&stop] { return stop.load(std::memory_order_relaxed); };
  reconstruct::SolveReport report;
  std::vector<float> error;
  std::vector<float>* const wanted = schema::has_bit(plan.passes, GRADUS_PASS_ERROR) ? &error : nullptr;
  const std::vector<float> rgba =
      output::combine(film, GRADUS_RECONSTRUCTION_REGULARIZED, 0.0f, film.region, cancel, &report, wanted);
  const double seconds = clock.seconds();
  if (cancel()) return {};
  if (wanted) error = output::enlarge(error, 1, plan.delivered, full_size, size);
  return {output::enlarge(rgba, 4, plan.delivered, full_size, size), std::move(error),
          seconds / double(film.region.area())};
}

}  // namespace gradus::render
