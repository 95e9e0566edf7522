#include "render/guiding.h"

#include <algorithm>
#include <cmath>

namespace gradus::render {
namespace {

// Paths to learn from over those of the render, and their maximum number, for each pixel and in all. A million finds
// about a thousand cells.
constexpr double kShareOfPaths = 1.0 / 16.0, kMaxPerPixel = 2.0, kMaxPaths = 1e6;
// Fewer paths learn too little.
constexpr double kMinPaths = 8192.0;
// Maximum number of paths for each second of a time limit: about a tenth of what one thread traces.
constexpr double kPathsPerSecond = 2e4;
// A region is guided if it has at least this share of the frame, from all of which the paths are taken.
constexpr double kMinRegion = 1.0 / 2.0;

}  // namespace

uint32_t guide_paths(const GradusSettings& settings, uint32_t samples, const Region& region, std::string* why_not) {
  const double pixels = double(settings.width) * settings.height;
  double paths = std::min({pixels * samples * kShareOfPaths, pixels * kMaxPerPixel, kMaxPaths});
  if (settings.time_limit > 0.0f) paths = std::min(paths, settings.time_limit * kPathsPerSecond);
  if (settings.use_guiding == 0)
    *why_not = "the setting use_guiding is off";
  else if (settings.max_bounces == 0)
    *why_not = "paths do not bounce";
  else if (double(region.area()) < kMinRegion * pixels)
    *why_not = "the region is a small part of the frame";
  else if (paths < kMinPaths)
    *why_not = "the render has too few samples to learn from a part of them";
  return why_not->empty() ? uint32_t(paths) : 0;
}

void explain(const integrator::GuideTraining& training, Reasons* chosen, Reasons* skipped) {
  const auto percent = [](double ratio) { return std::to_string(std::lround(100.0 * ratio)) + " %"; };
  const std::string found = std::to_string(training.paths) + " discarded paths found that it ";
  const std::string measured = "takes a sample's variance to " + percent(training.noise_ratio) + " and its time to " +
                               percent(training.time_ratio);
  if (training.pays)
    chosen->emplace_back("path guiding", found + measured);
  else if (!training.field)
    skipped->emplace_back("path guiding", found + "would reduce the variance of only " +
                                              percent(training.guided_share) + " of the samples of rough surfaces");
  else
    skipped->emplace_back("path guiding", found + measured + ", which does not pay");
}

}  // namespace gradus::render
