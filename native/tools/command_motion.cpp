// gradus motion SCENE.gradus: how well the components' motion to the next frame is found, and at what price.
#include <cstdio>
#include <nlohmann/json.hpp>

#include "api/recorder.h"
#include "base/clock.h"
#include "base/error.h"
#include "common.h"
#include "motion_check.h"
#include "path/context.h"
#include "scene/device.h"
#include "scene/moved_snapshot.h"
#include "scene/scene.h"

namespace gradus::tool {
namespace {

using nlohmann::ordered_json;

constexpr std::array<const char*, motion::kTrackingCauses + 1> kCauses = {
    "tracked", "no path", "gone", "not converged", "occluded", "broken", "outside", "elsewhere", "shot change"};

// Measures how far simpler estimates differ from the tracked motion, for specular chains that are not static.
ordered_json compare(const motion::ChainView& view, const motion::ChainTracer& next, const motion::ChainMotion& found) {
  const motion::ChainTracer here = view.tracer();
  SimplerMotion simpler(here, next);
  for (size_t i = 0; i < found.film.size(); ++i) {
    if (found.tracking[i] != motion::Tracking::Tracked) continue;
    const motion::SpecularChain& chain = view.chains[size_t(view.places[i])];
    if (chain.signature.length > 0 && !chain.is_static) simpler.add(chain, found.film[i]);
  }
  return simpler.json();
}

ordered_json count(const motion::TrackingCounts& counts) {
  const double pixels = double(std::max<uint64_t>(counts.searched, 1));
  ordered_json causes;
  for (size_t i = 0; i < kCauses.size(); ++i) causes[kCauses[i]] = counts.pixels[i];
  return {{"pixels", causes},
          {"searched", counts.searched},
          {"steps_in_space", double(counts.search.space) / pixels},
          {"steps_in_time", double(counts.search.time) / pixels},
          {"chains_traced", double(counts.search.traced) / pixels}};
}

// Measures tracking. `checked` is the number of pixels per component that are compared with a brute-force search.
ordered_json measure(const scene::Snapshot& snapshot, const GradusSettings& settings,
                     const lpe::ComponentSet& components, size_t checked) {
  double wall = 0.0, cpu = 0.0;
  const auto timed = [&](const auto& work) {
    wall = cpu = 0.0;
    const ScopedTimer timer(&wall, &cpu);
    return work();
  };
  const Region region{0, 0, int32_t(settings.width), int32_t(settings.height)};
  const motion::CentreView centres =
      timed([&] { return motion::view_centres(snapshot, settings.width, settings.height, region); });
  ordered_json report{{"pixels", region.area()}, {"centres_cpu", cpu}};
  const auto moved = timed([&] { return scene::moved_snapshot(snapshot, Moment::Next); });
  report["moved_snapshot_cpu"] = cpu;
  const camera::Camera camera = camera::Camera(moved->camera, settings.width, settings.height).without_lens();
  const motion::ChainTracer next(*moved, camera, settings);
  motion::Change change(snapshot);
  change.add(*moved);
  if (!change.any())
    std::fprintf(stderr, "warning: nothing moves to the next frame; was the scene saved with passes of motion?\n");
  const int followed = components.count() - 1;  // Residual has no light paths of its own to track
  const std::vector<motion::ChainView> views = timed([&] {
    return motion::view_chains(
        centres, settings, components, (1u << followed) - 1, [] { return false; }, &change);
  });
  report["chains_cpu"] = cpu;
  std::vector<motion::ChainMotion> found;
  for (int c = 0; c < followed; ++c) {
    const motion::ChainView& view = views[size_t(c)];
    ordered_json part{{"chains", view.chains.size()}};
    found.push_back(timed([&] { return motion::track_chains(view, next, region); }));
    part["tracking_cpu"] = cpu;
    part.update(count(found.back().counts));
    part.update(compare(view, next, found.back()));
    report[components[c].name] = part;
  }
  if (checked == 0) return report;
  const StepsBetween steps(snapshot, settings, farthest_displacement(next, views, found));
  for (int c = 0; c < followed; ++c)
    report[components[c].name]["check"] = steps.check(views[size_t(c)], found[size_t(c)], checked);
  return report;
}

}  // namespace

void add_motion(CLI::App* app, int* exit_code) {
  struct Arguments {
    std::string path, components;
    uint32_t threads = 1;
    size_t checked = 0;
  };
  auto args = std::make_shared<Arguments>();
  CLI::App* command =
      app->add_subcommand("motion", "Measure how the motion of a scene's components to the next frame is found");
  command->add_option("scene", args->path, "FILE.gradus, saved with vectors")->required()->check(CLI::ExistingFile);
  command->add_option("--components", args->components, "Name=EXPRESSION;Name=EXPRESSION; default: the default set");
  command->add_option("--check", args->checked,
                      "Pixels of each component that are compared with a dense search of the film");
  command->add_option("--threads", args->threads, "Threads; 0: all");
  command->callback([args, exit_code] {
    GradusDeviceSettings device_settings{};
    device_settings.struct_size = sizeof(device_settings);
    device_settings.threads = args->threads;
    const auto device = std::make_shared<scene::Device>(device_settings);
    scene::Scene scene(device);
    const GradusSettings settings = api::load_scene(args->path, &scene);
    const lpe::ComponentSet components = lpe::ComponentSet::parse(args->components);
    scene.commit(nullptr, nullptr);
    const auto snapshot = scene.snapshot();
    if (!snapshot->has_camera) throw invalid_argument(args->path + " has no camera");
    device->arena().execute(
        [&] { std::printf("%s\n", measure(*snapshot, settings, components, args->checked).dump(1).c_str()); });
    *exit_code = 0;
  });
}

}  // namespace gradus::tool
