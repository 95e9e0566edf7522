// gradus render SCENE.gradus -o STORE
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "channel_layers.h"
#include "common.h"
#include "component_layers.h"
#include "denoiser_place.h"
#include "film_io/image_exr.h"
#include "film_io/store.h"
#include "progress_line.h"
#include "schema/pass_table.h"

namespace gradus::tool {
namespace {

namespace fs = std::filesystem;

std::atomic<bool> interrupted{false};

struct RenderArguments {
  std::string scene, output, image, stats, denoiser_path;
  bool resume = false;
  OptionFlags options;
};

// Returns the file to write: FILE.exr itself, or STORE/<scene>/ViewLayer/f<frame>.exr in a frame store. Frames of
// animations have other names.
fs::path frame_path(const RenderArguments& args, int32_t frame) {
  const fs::path output = args.output;
  if (output.extension() == ".exr") return output;
  return output / fs::path(args.scene).stem() / "ViewLayer" / film_io::frame_name(frame, "exr");
}

void append_line(const std::string& path, const std::string& line) {
  std::ofstream file(path, std::ios::app);
  if (!(file << line << std::endl)) throw client::Error(GRADUS_ERROR_INVALID_OPERATION, "cannot write " + path);
}

client::Film render_film(const client::Device& device, const client::Scene& scene, const GradusSettings& settings,
                         const fs::path& target, const RenderArguments& args) {
  const bool resumed = args.resume && fs::exists(target);
  client::Render render = resumed ? client::Render(scene, settings, client::Film::load(device, target.string()))
                                  : client::Render(scene, settings);
  {
    ProgressLine line;
    while (!render.wait(0.1)) {
      line.show(render.poll(), settings.samples);
      if (interrupted) render.cancel();
    }
  }
  if (!args.stats.empty()) append_line(args.stats, render.stats());
  return render.film();
}

void write_image(const client::Film& film, const GradusSettings& settings, const std::string& path) {
  const auto [width, height] = film.size();
  std::vector<film_io::ImageLayer> layers;
  for (uint32_t pass = 0; pass < GRADUS_PASS_COUNT; ++pass) {
    if (pass != GRADUS_PASS_COMBINED && (settings.passes >> pass & 1) == 0) continue;
    const schema::PassInfo& info = schema::pass_info(pass);
    layers.push_back({pass == GRADUS_PASS_COMBINED ? "" : info.name, info.letters, film.read_pass(pass)});
  }
  add_channel_layers(film, &layers);
  if (settings.use_decomposition != 0) {
    add_component_layers(settings, settings.component_passes, size_t(width) * height, reader_of(film), &layers);
  }
  film_io::save_image(path, int(width), int(height), layers);
}

int run(const RenderArguments& args) {
  GradusSettings settings = client::default_settings();
  const client::Device device(0, nullptr, denoiser_place(args.denoiser_path).c_str());
  const client::Scene scene = client::Scene::load(device, args.scene, &settings);
  args.options.apply(&settings);
  check_denoiser_path(args.denoiser_path, settings.denoiser);
  const fs::path target = frame_path(args, settings.frame);
  check_apart("--output", target.string(), args.scene);
  if (!args.image.empty()) check_apart("--image", args.image, target.string());
  if (target.has_parent_path()) fs::create_directories(target.parent_path());
  std::signal(SIGINT, [](int) { interrupted = true; });
  const client::Film film = render_film(device, scene, settings, target, args);
  film.save(target.string());
  if (!args.image.empty()) write_image(film, settings, args.image);
  print_warnings(device, scene);
  std::printf("%s\n", target.c_str());
  return 0;
}

}  // namespace

void add_render(CLI::App* app, int* exit_code) {
  auto args = std::make_shared<RenderArguments>();
  CLI::App* command = app->add_subcommand("render", "Render a saved scene into a frame store");
  command->add_option("scene", args->scene, "Scene file, FILE.gradus")->required()->check(CLI::ExistingFile);
  command->add_option("-o,--output", args->output, "Folder of the frame store, or FILE.exr for one frame")->required();
  command->add_option("--image", args->image, "Also write the reconstruction and the passes as an image, FILE.exr")
      ->check(exr_only);
  command->add_option("--stats", args->stats, "Append one JSON object about the render to this file");
  command->add_flag("--resume", args->resume, "Continue from the samples of the film that is already in the store");
  add_denoiser_path(command, &args->denoiser_path);
  args->options.add_to(command);
  command->footer("Options not given are those the scene was saved with.");
  command->callback([args, exit_code] { *exit_code = run(*args); });
}

}  // namespace gradus::tool
