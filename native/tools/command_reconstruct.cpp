// gradus reconstruct FRAME.exr -o IMAGE.exr
#include "api/objects.h"
#include "common.h"
#include "frame/image_exr.h"
#include "render/pass_read.h"

namespace gradus::tool {
namespace {

struct ReconstructArguments {
  std::string frame, output, reconstruction = "auto", denoiser = "none", denoiser_path, passes;
  std::vector<std::string> merged;
  float alpha = 0.0f;
};

// What would be ignored, or lost, is refused before anything is read.
void check_usage(const ReconstructArguments& args, uint32_t reconstruction, uint32_t denoiser) {
  check_apart("--output", args.output, args.frame);
  for (const std::string& path : args.merged) check_apart("--output", args.output, path);
  check_denoiser_path(args.denoiser_path, denoiser);
  const bool weighs = reconstruction == GRADUS_RECONSTRUCTION_L2 || reconstruction == GRADUS_RECONSTRUCTION_WEIGHTED ||
                      reconstruction == GRADUS_RECONSTRUCTION_L1;
  if (args.alpha != 0.0f && !weighs) {
    throw CLI::ValidationError("--alpha", "is for --reconstruction l2, weighted or l1; others find their weights themselves");
  }
}

bool holds(const Frame& frame, uint32_t pass) {
  if (pass == GRADUS_PASS_GRADIENT_X || pass == GRADUS_PASS_GRADIENT_Y) return frame.gradients;
  return pass == GRADUS_PASS_ERROR || has_pass(frame, pass);  // that of the reconstruction
}

// Those of `asked` that are there: all of them, unless it is everything.
uint64_t held_passes(const client::Frame& frame, uint64_t asked) {
  const std::shared_ptr<const Frame> content = api::find_handle<api::FrameObject>(frame.id())->get();
  uint64_t held = 0;
  std::string names, missing;
  for (uint32_t pass = 0; pass < GRADUS_PASS_COUNT; ++pass) {
    if (holds(*content, pass)) {
      held |= uint64_t{1} << pass;
      names += (names.empty() ? "" : ", ") + typed_name(pass);
    } else if ((asked >> pass & 1) != 0) {
      missing += (missing.empty() ? "" : ", ") + typed_name(pass);
    }
  }
  if (asked == kAllPasses || missing.empty()) return asked & held;
  throw client::Error(GRADUS_ERROR_INVALID_OPERATION, "the frame was rendered without " + missing + "; it holds " + names);
}

int run(const ReconstructArguments& args) {
  const uint32_t reconstruction = parse_choice("reconstruction", args.reconstruction), denoiser = parse_choice("denoiser", args.denoiser);
  check_usage(args, reconstruction, denoiser);
  const client::Device device(0, nullptr, args.denoiser_path.c_str());
  client::Frame frame = client::Frame::load(device, args.frame);
  for (const std::string& path : args.merged) frame.merge(client::Frame::load(device, path));
  const auto [width, height] = frame.size();
  const uint64_t passes = args.passes.empty() ? 1 : held_passes(frame, parse_passes(args.passes));
  const auto wanted = [passes](uint32_t pass) { return (passes >> pass & 1) != 0; };
  std::vector<float> error;  // of this reconstruction, not of the one that the frame was rendered for
  std::vector<ImageLayer> layers = {
      {"", 4, frame.reconstruct(reconstruction, args.alpha, denoiser, wanted(GRADUS_PASS_ERROR) ? &error : nullptr)}};
  for (uint32_t pass = 1; pass < GRADUS_PASS_COUNT; ++pass) {
    if (!wanted(pass)) continue;
    layers.push_back(
        {client::pass_name(pass), int(client::pass_channels(pass)), pass == GRADUS_PASS_ERROR ? error : frame.read_pass(pass)});
  }
  save_image(args.output, int(width), int(height), layers);
  print_warnings(device);
  return 0;
}

}  // namespace

void add_reconstruct(CLI::App* app, int* exit_code) {
  auto args = std::make_shared<ReconstructArguments>();
  CLI::App* command = app->add_subcommand("reconstruct", "Reconstruct a stored frame into an image");
  command->add_option("frame", args->frame, "Stored frame, as gradus render writes it")->required()->check(CLI::ExistingFile);
  command->add_option("-o,--output", args->output, "Image to write, FILE.exr")->required()->check(exr_only);
  command
      ->add_option("--reconstruction", args->reconstruction,
                   "auto, none, l2 (unbiased), regularized (by features), weighted (by the measured noise) or l1 (robust)")
      ->capture_default_str()
      ->check([](const std::string& value) { return bad_value("reconstruction", value); });
  command->add_option("--alpha", args->alpha, "Weight of the noisy image against the gradients, for l2, weighted and l1; 0: automatic")
      ->capture_default_str()
      ->check([](const std::string& value) { return bad_value("reconstruction_alpha", value); });
  command->add_option("--denoiser", args->denoiser, "none, oidn (the machine's Open Image Denoise) or auto (that where there is one)")
      ->capture_default_str()
      ->check([](const std::string& value) { return bad_value("denoiser", value); });
  add_denoiser_path(command, &args->denoiser_path);
  command->add_option("--merge", args->merged, "Frames of the same scene with other samples, to add")->check(CLI::ExistingFile);
  command->add_option("--passes", args->passes, "Passes to write as layers, separated by commas, or all that the frame holds")
      ->check(bad_passes);
  command->callback([args, exit_code] { *exit_code = run(*args); });
}

}  // namespace gradus::tool
