// gradus info FILE
#include <cstdio>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "api/recorder.h"
#include "base/error.h"
#include "common.h"
#include "film_io/image_exr.h"
#include "film_io/store.h"
#include "schema/options.h"
#include "stored_sequence.h"

namespace gradus::tool {
namespace {

using nlohmann::ordered_json;

// Key of the files of a sequence that are missing or cannot be read, with the reasons. If there are any, the exit code
// is that of a failure.
constexpr const char* kDamaged = "damaged";

ordered_json scene_info(const std::string& path) {
  const api::SceneSummary s = api::summarize_scene(path);
  return {{"kind", "scene"},
          {"bytes", s.file_bytes},
          {"meshes", s.meshes},
          {"vertices", s.vertices},
          {"triangles", s.triangles},
          {"instances", s.instances},
          {"lights", s.lights},
          {"materials", s.materials},
          {"nodes", s.nodes},
          {"images", s.images},
          {"image_bytes", s.image_bytes},
          {"camera", s.has_camera},
          {"settings", schema::settings_to_json(s.settings)}};
}

ordered_json film_info(const std::string& path) {
  const auto film = film_io::load_film(path);
  uint64_t samples = 0, minimum = UINT64_MAX, maximum = 0;
  for (size_t i = 0; i < film->count[0].size(); ++i) {
    const uint64_t n = uint64_t(film->count[0][i]) + film->count[1][i];
    samples += n;
    minimum = std::min(minimum, n);
    maximum = std::max(maximum, n);
  }
  const Region& r = film->region;
  char scene_key[20];
  std::snprintf(scene_key, sizeof(scene_key), "%016llx", static_cast<unsigned long long>(film->scene_key));
  return {{"kind", "film"},
          {"resolution", {film->full_width, film->full_height}},
          {"sampled_region", {r.x0, r.y0, r.x1, r.y1}},
          {"frame", film->frame_number},
          {"samples", double(samples) / double(r.area())},
          {"samples_minimum", minimum},
          {"samples_maximum", maximum},
          {"gradients", film->gradients},
          {"components", film->components.size()},
          {"alpha", film->color_channels == 4},
          {"memory_bytes", film->memory_bytes()},
          {"scene_key", scene_key},
          {"settings", schema::settings_to_json(film->settings)}};
}

ordered_json sequence_info(const std::string& folder) {
  const FolderFaults faults = find_faults(folder);
  if (!faults.files.empty() && faults.whole_frames == 0)
    return {{"kind", "sequence"}, {"frames", 0}, {kDamaged, faults.files}};
  const StoredSequence stored(folder, faults.frames);
  const int32_t first = stored.frames().front(), last = stored.frames().back();
  ordered_json frame = film_info(stored.path(first));
  ordered_json info{{"kind", "sequence"},
                    {"first", first},
                    {"last", last},
                    {"step", stored.step()},
                    {"frames", stored.frames().size()},
                    {"missing", stored.missing(first, last)},
                    {kDamaged, faults.files}};
  for (const char* of_all : {"resolution", "sampled_region", "alpha", "settings"}) info[of_all] = frame[of_all];
  return info;
}

ordered_json describe(const std::string& path) {
  if (std::filesystem::is_directory(path)) return sequence_info(path);
  if (std::filesystem::path(path).extension() == ".gradus") return scene_info(path);
  if (std::filesystem::path(path).extension() != ".exr")
    throw invalid_argument(path + " is neither FILE.gradus nor FILE.exr");
  if (film_io::is_film_file(path)) return film_info(path);
  return {{"kind", "image"}, {"channels", film_io::image_channels(path)}};
}

void print(const ordered_json& info, const std::string& indent) {
  for (const auto& [name, value] : info.items()) {
    if (value.is_object() && !value.empty()) {
      std::printf("%s%s\n", indent.c_str(), name.c_str());
      print(value, indent + "  ");
    } else {
      std::printf("%s%-*s %s\n", indent.c_str(), int(26 - indent.size()), name.c_str(), value.dump().c_str());
    }
  }
}

}  // namespace

void add_info(CLI::App* app, int* exit_code) {
  struct Arguments {
    std::string path;
    bool json = false;
  };
  auto args = std::make_shared<Arguments>();
  CLI::App* command = app->add_subcommand(
      "info", "Describe the contents of a scene file, a stored film, a folder of films or an image");
  command->add_option("file", args->path, "FILE.gradus, FILE.exr, or a folder of a frame store")
      ->required()
      ->check(CLI::ExistingPath);
  command->add_flag("--json", args->json, "Print one JSON object");
  command->callback([args, exit_code] {
    const ordered_json info = describe(args->path);
    if (args->json) {
      std::printf("%s\n", info.dump().c_str());
    } else {
      print(info, "");
    }
    *exit_code = info.contains(kDamaged) && !info[kDamaged].empty() ? kExitFailure : 0;
  });
}

}  // namespace gradus::tool
