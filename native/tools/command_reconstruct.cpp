// gradus reconstruct FRAME.exr -o IMAGE.exr
#include <filesystem>

#include "api/objects.h"
#include "channel_layers.h"
#include "component_layers.h"
#include "denoiser_place.h"
#include "film_io/image_exr.h"
#include "output/options.h"
#include "output/pass_read.h"
#include "reconstruct.h"
#include "schema/pass_table.h"

namespace gradus::tool {
namespace {

bool is_sequence(const ReconstructArguments& args) { return std::filesystem::is_directory(args.input); }

// Refuses arguments that would be ignored, and outputs that would overwrite an input, before any file is read.
void check_usage(const ReconstructArguments& args, uint32_t reconstruction, uint32_t denoiser) {
  check_apart("--output", args.output, args.input);
  for (const std::string& path : args.merged) check_apart("--output", args.output, path);
  check_denoiser_path(args.denoiser_path, denoiser);
  const bool weighs = reconstruction == GRADUS_RECONSTRUCTION_L2 || reconstruction == GRADUS_RECONSTRUCTION_L1;
  const bool as_sampled = is_sequence(args) && reconstruction == GRADUS_RECONSTRUCTION_AUTO;
  if (args.alpha != 0.0f && !weighs && !as_sampled) {
    throw CLI::ValidationError("--alpha", "is for --reconstruction l2 or l1; others find their weights themselves");
  }
  const auto refuse = [](const char* option, const char* what) {
    throw CLI::ValidationError(option, std::string("is for ") + what);
  };
  if (is_sequence(args)) {
    if (!args.merged.empty()) refuse("--merge", "single frames");
    return;
  }
  if (!args.frames.empty()) refuse("--frames", "folders of frames");
  if (args.window_size) refuse("--window-size", "folders of frames");
  if (args.window_overlap) refuse("--window-overlap", "folders of frames");
  if (args.exposure >= 0.0) refuse("--film-exposure", "folders of frames");
  if (const std::string bad = exr_only(args.output); !bad.empty()) throw CLI::ValidationError("--output", bad);
}

bool holds(const film::Film& film, uint32_t pass) {
  if (schema::pass_info(pass).kind == schema::PassKind::Sequence) return schema::has_bit(film.settings.passes, pass);
  if (pass == GRADUS_PASS_GRADIENT_X || pass == GRADUS_PASS_GRADIENT_Y) return film.gradients;
  return pass == GRADUS_PASS_ERROR || output::has_pass(film, pass);  // the error is estimated by the reconstruction
}

// Says on stderr why the picture is not denoised, if a denoiser that is missing would have denoised it.
void note_missing_denoiser(const film::Film& film, const output::Options& options, const std::string& place) {
  if (options.denoiser != GRADUS_DENOISER_AUTO ||
      output::resolve_auto(options, output::facts_of(film, true)).denoiser == GRADUS_DENOISER_NONE)
    return;
  if (const std::string why = missing_denoiser(place); !why.empty()) print_not_denoised(why);
}

int run(const ReconstructArguments& args) {
  const uint32_t reconstruction = parse_choice("reconstruction", args.reconstruction),
                 denoiser = parse_choice("denoiser", args.denoiser);
  check_usage(args, reconstruction, denoiser);
  if (is_sequence(args)) return reconstruct_sequence(args);
  const std::string place = denoiser_place(args.denoiser_path);
  const client::Device device(0, nullptr, place.c_str());
  client::Film film = client::Film::load(device, args.input);
  for (const std::string& path : args.merged) film.merge(client::Film::load(device, path));
  const auto [width, height] = film.size();
  const uint64_t passes = args.passes.empty() ? 1
                                              : available_passes(*api::find_handle<api::FilmObject>(film.id())->get(),
                                                                 parse_passes(args.passes));
  const auto wanted = [passes](uint32_t pass) { return (passes >> pass & 1) != 0; };
  std::vector<float> error;  // that of this reconstruction, which may differ from the stored setting
  std::vector<film_io::ImageLayer> layers = {
      {"", "RGBA",
       film.reconstruct(reconstruction, args.alpha, denoiser, wanted(GRADUS_PASS_ERROR) ? &error : nullptr)}};
  for (uint32_t pass = 1; pass < GRADUS_PASS_COUNT; ++pass) {
    if (!wanted(pass)) continue;
    const schema::PassInfo& info = schema::pass_info(pass);
    layers.push_back({info.name, info.letters, pass == GRADUS_PASS_ERROR ? error : film.read_pass(pass)});
  }
  if (!args.passes.empty() && parse_passes(args.passes) == kAllPasses) add_channel_layers(film, &layers);
  const uint32_t of_components = parse_component_passes(args.component_passes);
  if (of_components != 0) {
    const auto content = api::find_handle<api::FilmObject>(film.id())->get();
    const uint32_t held = available_component_passes(film::header_of(*content), of_components);
    add_component_layers(content->settings, held, size_t(width) * height, reader_of(film), &layers);
  }
  film_io::save_image(args.output, int(width), int(height), layers);
  note_missing_denoiser(*api::find_handle<api::FilmObject>(film.id())->get(), {reconstruction, args.alpha, denoiser},
                        place);
  print_warnings(device);
  return 0;
}

}  // namespace

uint64_t available_passes(const film::Film& film, uint64_t requested) {
  const AvailablePasses held =
      find_available(pass_names(), requested, [&](uint32_t pass) { return holds(film, pass); });
  if (requested == kAllPasses || held.missing.empty()) return requested & held.mask;
  throw client::Error(GRADUS_ERROR_INVALID_OPERATION,
                      "the film was sampled without " + held.missing + "; it holds " + held.names);
}

void add_reconstruct(CLI::App* app, int* exit_code) {
  auto args = std::make_shared<ReconstructArguments>();
  CLI::App* command =
      app->add_subcommand("reconstruct", "Reconstruct a stored film, or those of an animation, into images");
  command
      ->add_option("frame", args->input,
                   "Stored film, as gradus render writes it, or a folder of a frame store with those of an animation")
      ->required()
      ->check(CLI::ExistingPath);
  command
      ->add_option("-o,--output", args->output,
                   "Image to write, FILE.exr; of an animation the folder for 0001.exr and so on")
      ->required();
  command->add_option(
      "--frames", args->frames,
      "Of an animation: FIRST-LAST; all if not given. Stored frames beside them contribute as in the whole");
  command
      ->add_option("--window-size", args->window_size,
                   "Of an animation: frames that are reconstructed together (10 if not given)")
      ->check(CLI::Range(1, 1000));
  command
      ->add_option("--window-overlap", args->window_overlap,
                   "Of an animation: those of them that are reconstructed with the next ones, too (half if not given)")
      ->check(CLI::Range(0, 500));
  command->add_option("--film-exposure", args->exposure, "Of an animation: factor on all radiance")
      ->check(CLI::NonNegativeNumber);
  command
      ->add_option("--reconstruction", args->reconstruction,
                   "auto, none, l2 (unbiased), regularized (by features) or l1 (robust)")
      ->capture_default_str()
      ->check([](const std::string& value) { return bad_value("reconstruction", value); });
  command
      ->add_option("--alpha", args->alpha,
                   "Weight of the noisy image against the gradients, for l2 and l1; 0: automatic")
      ->capture_default_str()
      ->check([](const std::string& value) { return bad_value("reconstruction_alpha", value); });
  command
      ->add_option("--denoiser", args->denoiser,
                   "none, oidn (the machine's Open Image Denoise) or auto (that with regularized, where there is one "
                   "and a pixel has enough samples)")
      ->capture_default_str()
      ->check([](const std::string& value) { return bad_value("denoiser", value); });
  add_denoiser_path(command, &args->denoiser_path);
  command->add_option("--merge", args->merged, "Frames of the same scene with other samples, to add")
      ->check(CLI::ExistingFile);
  command
      ->add_option("--passes", args->passes,
                   "Passes to write as layers, separated by commas, or all that the film holds")
      ->check(bad_passes);
  command
      ->add_option("--component-passes", args->component_passes,
                   "Passes of components to write as layers, separated by commas, or all that the film holds: color, "
                   "reflectance and so on")
      ->check(bad_component_passes);
  command->callback([args, exit_code] { *exit_code = run(*args); });
}

}  // namespace gradus::tool
