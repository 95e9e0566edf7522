// gradus compare IMAGE.exr REFERENCE.exr
#include <cmath>
#include <cstdio>
#include <limits>

#include <nlohmann/json.hpp>

#include "common.h"
#include "compare/metrics.h"
#include "film_io/image_exr.h"

namespace gradus::tool {
namespace {

struct CompareArguments {
  std::string image, reference, layer;
  bool json = false;
  double fail_above = std::numeric_limits<double>::infinity();
};

// Returns an image, or a stored film, reconstructed by its settings.
compare::RgbImage load(const std::string& path, const std::string& layer) {
  if (!film_io::is_film_file(path)) {
    film_io::LoadedImage image = film_io::load_rgb(path, layer);
    return {image.width, image.height, std::move(image.rgb)};
  }
  const client::Device device;
  const client::Film film = client::Film::load(device, path);
  const std::vector<float> rgba = film.read_pass(GRADUS_PASS_COMBINED);
  compare::RgbImage image{int(film.size().first), int(film.size().second), {}};
  for (size_t i = 0; i < rgba.size(); i += 4)
    image.pixels.insert(image.pixels.end(), rgba.begin() + ptrdiff_t(i), rgba.begin() + ptrdiff_t(i + 3));
  return image;
}

nlohmann::ordered_json to_json(const compare::Metrics& m) {
  return {{"relmse", m.rel_mse},
          {"relmse_trimmed", m.rel_mse_trimmed},
          {"smape", m.smape},
          {"ssim", m.ssim},
          {"mse", m.mse},
          {"log_mse", m.log_mse},
          {"mean", m.mean},
          {"mean_reference", m.mean_reference},
          {"signed_ratio", m.signed_ratio},
          {"nonfinite", m.nonfinite}};
}

int run(const CompareArguments& args) {
  const compare::Metrics m = compare::compare_images(load(args.image, args.layer), load(args.reference, args.layer));
  const nlohmann::ordered_json report = to_json(m);
  if (args.json) {
    std::printf("%s\n", report.dump().c_str());
  } else {
    for (const auto& [name, value] : report.items()) std::printf("%-16s %.6g\n", name.c_str(), value.get<double>());
  }
  return m.nonfinite > 0 || m.rel_mse > args.fail_above ? kExitFailure : 0;
}

}  // namespace

void add_compare(CLI::App* app, int* exit_code) {
  auto args = std::make_shared<CompareArguments>();
  CLI::App* command = app->add_subcommand("compare", "Measure how far an image is from a reference");
  command->add_option("image", args->image, "Image or stored film, EXR")
      ->required()
      ->check(CLI::ExistingFile)
      ->check(exr_only);
  command->add_option("reference", args->reference, "Image or stored film that it is compared with, EXR")
      ->required()
      ->check(CLI::ExistingFile)
      ->check(exr_only);
  command->add_option("--layer", args->layer,
                      "Layer of multilayer files, as NAME in NAME.R; default: the plain image, else Combined");
  command->add_flag("--json", args->json, "Print one JSON object");
  command->add_option("--fail-above", args->fail_above, "Exit with 1 if relMSE is above this");
  command->footer(
      "relmse: mean of (x-r)^2 / (1e-3 + gray(r)^2). relmse_trimmed: without the worst 0.1 % of pixels. smape: mean "
      "|x-r| / "
      "(|x|+|r|+1e-3). "
      "ssim: of the luminance after the sRGB curve. signed_ratio: |sum of x-r| / sum of |x-r| over 5x5 blocks, near 1 "
      "for bias. Exit code "
      "1 "
      "if the image has values that are not finite.");
  command->callback([args, exit_code] { *exit_code = run(*args); });
}

}  // namespace gradus::tool
