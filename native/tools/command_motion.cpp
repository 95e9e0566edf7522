// gradus motion SCENE.gradus: how well the components' motion to the next frame is found, and at what price.
#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "api/recorder.h"
#include "base/bill.h"
#include "base/device.h"
#include "base/error.h"
#include "common.h"
#include "motion/flat_mirror.h"
#include "motion/specular_motion.h"
#include "path/context.h"
#include "scene/moved_snapshot.h"
#include "scene/scene.h"

namespace gradus::tool {
namespace {

using nlohmann::ordered_json;

constexpr std::array<const char*, kTrackingCauses + 1> kCauses = {"tracked", "no path",   "gone", "not converged", "occluded", "broken",
                                                                  "outside", "elsewhere", "cut"};

// Distances in pixels between two answers.
class Distances {
 public:
  void add(float pixels) { pixels_.push_back(pixels); }
  ordered_json json() {
    std::sort(pixels_.begin(), pixels_.end());
    const auto quantile = [&](double q) { return pixels_[std::min(pixels_.size() - 1, size_t(q * double(pixels_.size())))]; };
    if (pixels_.empty()) return {{"pixels", 0}};
    return {{"pixels", pixels_.size()}, {"median", quantile(0.5)}, {"quantile_95", quantile(0.95)}};
  }

 private:
  std::vector<float> pixels_;
};

// What simpler answers differ by from a motion that was found, where something moves.
ordered_json compare(const ChainView& view, const ChainTracer& next, const ChainMotion& found) {
  const SnapshotMotion surface(view.tracer().snapshot(), next.snapshot());
  const Camera& camera = next.camera();
  Distances resting, along, mirror;
  for (size_t i = 0; i < found.film.size(); ++i) {
    if (found.tracking[i] != Tracking::Tracked) continue;
    const SpecularChain& chain = view.chains[size_t(view.places[i])];
    if (chain.way.length == 0 || chain.rests) continue;
    Vec2 film;
    Vec3 position;
    if (surface.position(chain.first, &position) && camera.project(position, Moment::Now, &film))
      mirror.add(glm::length(camera.way(found.film[i], film)));
    if (flat_mirror_motion(view.tracer(), next, surface, chain, FlatMirror::Rests, &film))
      resting.add(glm::length(camera.way(found.film[i], film)));
    if (flat_mirror_motion(view.tracer(), next, surface, chain, FlatMirror::MovesAlong, &film))
      along.add(glm::length(camera.way(found.film[i], film)));
  }
  return {{"motion_of_first_surface", mirror.json()}, {"flat_resting_mirror", resting.json()}, {"flat_moving_mirror", along.json()}};
}

ordered_json count(const TrackingCounts& counts) {
  const double pixels = double(std::max<uint64_t>(counts.searched, 1));
  ordered_json causes;
  for (size_t i = 0; i < kCauses.size(); ++i) causes[kCauses[i]] = counts.pixels[i];
  return {{"pixels", causes},
          {"searched", counts.searched},
          {"steps_in_space", double(counts.search.space) / pixels},
          {"steps_in_time", double(counts.search.time) / pixels},
          {"ways_traced", double(counts.search.traced) / pixels}};
}

ordered_json measure(const Snapshot& snapshot, const GradusSettings& settings, const ComponentSet& components) {
  double wall = 0.0, cpu = 0.0;
  const auto billed = [&](const auto& work) {
    wall = cpu = 0.0;
    const Bill bill(&wall, &cpu);
    return work();
  };
  const Region region{0, 0, int32_t(settings.width), int32_t(settings.height)};
  const CentreView centres = billed([&] { return view_centres(snapshot, settings.width, settings.height, region); });
  ordered_json report{{"pixels", region.area()}, {"centres_cpu", cpu}};
  const auto moved = billed([&] { return moved_snapshot(snapshot, Moment::Next); });
  report["moved_snapshot_cpu"] = cpu;
  const Camera camera = Camera(moved->camera, settings.width, settings.height).without_lens();
  const ChainTracer next(*moved, camera, settings);
  Change change(snapshot);
  change.add(*moved);
  const int followed = components.count() - 1;  // no path stands for all that is left over
  const std::vector<ChainView> views = billed([&] {
    return view_chains(
        centres, settings, components, (1u << followed) - 1, [] { return false; }, &change);
  });
  report["chains_cpu"] = cpu;
  for (int c = 0; c < followed; ++c) {
    const ChainView& view = views[size_t(c)];
    ordered_json part{{"chains", view.chains.size()}};
    const ChainMotion motion = billed([&] { return track_chains(view, next, region); });
    part["tracking_cpu"] = cpu;
    part.update(count(motion.counts));
    part.update(compare(view, next, motion));
    report[components[c].name] = part;
  }
  return report;
}

}  // namespace

void add_motion(CLI::App* app, int* exit_code) {
  struct Arguments {
    std::string path, components;
    uint32_t threads = 1;
  };
  auto args = std::make_shared<Arguments>();
  CLI::App* command = app->add_subcommand("motion", "Measure how the motion of a scene's components to the next frame is found");
  command->add_option("scene", args->path, "FILE.gradus, saved with vectors")->required()->check(CLI::ExistingFile);
  command->add_option("--components", args->components, "Name=EXPRESSION;Name=EXPRESSION; default: the default set");
  command->add_option("--threads", args->threads, "Threads; 0: all");
  command->callback([args, exit_code] {
    GradusDeviceSettings device_settings{};
    device_settings.struct_size = sizeof(device_settings);
    device_settings.threads = args->threads;
    const auto device = std::make_shared<Device>(device_settings);
    Scene scene(device);
    const GradusSettings settings = api::load_scene(args->path, &scene);
    const ComponentSet components = ComponentSet::parse(args->components);
    scene.commit(nullptr, nullptr);
    const auto snapshot = scene.snapshot();
    if (!snapshot->has_camera) throw invalid_argument(args->path + " has no camera");
    device->arena().execute([&] { std::printf("%s\n", measure(*snapshot, settings, components).dump(1).c_str()); });
    *exit_code = 0;
  });
}

}  // namespace gradus::tool
