// gradus reconstruct FRAME.exr -o IMAGE.exr
#include "common.h"
#include "frame/image_exr.h"

namespace gradus::tool {
namespace {

struct ReconstructArguments {
  std::string frame, output, reconstruction = "auto", denoiser = "none", denoiser_path, passes;
  std::vector<std::string> merged;
  float alpha = 0.0f;
};

int run(const ReconstructArguments& args) {
  check_apart("--output", args.output, args.frame);
  for (const std::string& path : args.merged) check_apart("--output", args.output, path);
  const client::Device device(0, nullptr, args.denoiser_path.c_str());
  client::Frame frame = client::Frame::load(device, args.frame);
  for (const std::string& path : args.merged) frame.merge(client::Frame::load(device, path));
  const auto [width, height] = frame.size();
  const uint64_t passes = args.passes.empty() ? 1 : parse_passes(args.passes);
  const auto wanted = [passes](uint32_t pass) { return (passes >> pass & 1) != 0; };
  const uint32_t reconstruction = parse_choice("reconstruction", args.reconstruction), denoiser = parse_choice("denoiser", args.denoiser);
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
      ->capture_default_str();
  command->add_option("--alpha", args->alpha, "Weight of the noisy image against the gradients; 0: automatic")->capture_default_str();
  command->add_option("--denoiser", args->denoiser, "none, oidn (the machine's Open Image Denoise) or auto (that where there is one)")
      ->capture_default_str();
  add_denoiser_path(command, &args->denoiser_path);
  command->add_option("--merge", args->merged, "Frames of the same scene with other samples, to add")->check(CLI::ExistingFile);
  command->add_option("--passes", args->passes, "Passes to write as layers, separated by commas; they must be in the frame");
  command->callback([args, exit_code] { *exit_code = run(*args); });
}

}  // namespace gradus::tool
