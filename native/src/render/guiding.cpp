#include "render/guiding.h"

#include <algorithm>
#include <cmath>

namespace gradus::render {
namespace {

// Paths to learn from over those of the render, and their maximum number, which finds about a thousand cells.
constexpr double kShareOfPaths = 1.0 / 16.0, kMaxPaths = 1e6;
// Fewer paths learn too little.
constexpr double kMinPaths = 8192.0;
// Maximum number of paths for each second of a time limit: about a tenth of what one thread traces.
constexpr double kPathsPerSecond = 2e4;
// A region is guided if it has at least this share of the frame, from all of which the paths are taken.
constexpr double kMinRegion = 1.0 / 16.0;

}  // namespace

uint32_t guide_paths(const GradusSettings& settings, uint32_t samples, const Region& region, std::string* why_not) {
  const double pixels = double(settings.width) * settings.height;
  double paths = std::min(pixels * samples * kShareOfPaths, kMaxPaths);
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
  const std::string share = std::to_string(std::lround(100.0 * training.guided_share)) + " %";
  const std::string paths = std::to_string(training.paths) + " discarded paths";
  if (training.field)
    chosen->emplace_back("path guiding", paths + " found that it reduces the variance of " + share +
                                             " of the samples of rough surfaces");
  else
    skipped->emplace_back("path guiding", paths + " found that it would reduce the variance of only " + share +
                                              " of the samples of rough surfaces");
}

}  // namespace gradus::render
