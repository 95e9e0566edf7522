#include "output/developer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "base/fpu.h"
#include "base/rows.h"
#include "base/threads.h"
#include "film/catcher_channels.h"
#include "film/features.h"
#include "film/region_pixels.h"
#include "output/alpha_bounds.h"
#include "output/denoise_combined.h"
#include "output/light_passes.h"
#include "output/pass_read.h"
#include "output/shadow_catcher.h"
#include "schema/pass_table.h"

namespace gradus::output {
namespace {

using Images = std::vector<std::vector<float>>;

constexpr int kPixels = 4096;  // Number of pixels that one task handles.

// Returns a function of (pixel, channel) that gives a value of a reconstructed image as it is delivered: multiplied by
// the exposure, and not negative unless it keeps negative values.
auto value_of(const film::Film& film, bool keeps_negative, const std::vector<float>& image) {
  const float exposure = film.settings.film_exposure, minimum = keeps_negative ? -INFINITY : 0.0f;
  const auto channels = size_t(film.color_channels);
  return [&image, exposure, minimum, channels](size_t i, size_t c) {
    return exposure * std::max(image[i * channels + c], minimum);
  };
}

// Returns a function of a pixel that gives the alpha of a reconstructed image as it is delivered.
auto alpha_of(const film::Film& film, const std::vector<float>& image) {
  const bool has_alpha = film.color_channels == 4;
  std::vector<AlphaBounds> bounds;
  if (has_alpha) bounds = find_alpha_bounds(film);
  return [&image, has_alpha, bounds = std::move(bounds)](size_t i) {
    return has_alpha ? std::clamp(image[4 * i + 3], bounds[i].least, bounds[i].most) : 1.0f;
  };
}

// Returns RGBA of `region`. `image` is the reconstructed picture of the whole film region.
std::vector<float> crop_picture(const film::Film& film, bool keeps_negative, const std::vector<float>& image,
                                const Region& region) {
  std::vector<float> rgba(size_t(region.area()) * 4);
  const auto of_pixel = value_of(film, keeps_negative, image);
  const auto alpha = alpha_of(film, image);
  for_pixels(film, region, [&](size_t i, size_t out) {
    for (size_t c = 0; c < 3; ++c) rgba[4 * out + c] = of_pixel(i, c);
    rgba[4 * out + 3] = alpha(i);
  });
  show_shadow_catchers(film, region, rgba.data());
  return rgba;
}

// Returns RGB of `region` for each component, clamped as the whole picture is. `images` are the reconstructed
// components of the whole film region.
Images crop_components(const film::Film& film, bool keeps_negative, Images images, const Region& region) {
  if (!keeps_negative) reconstruct::clamp_components(film.color_channels, &images);
  for (std::vector<float>& image : images) {
    std::vector<float> rgb(size_t(region.area()) * 3);
    const auto of_pixel = value_of(film, keeps_negative, image);
    for_pixels(film, region, [&](size_t i, size_t out) {
      for (size_t c = 0; c < 3; ++c) rgb[3 * out + c] = of_pixel(i, c);
    });
    image = std::move(rgb);
  }
  return images;
}

// Returns the squared error of `region`, in the units of the delivered picture. `error` covers the film's region.
std::vector<float> crop_error(const film::Film& film, const std::vector<float>& error, const Region& region) {
  const double scale = double(film.settings.film_exposure) * film.settings.film_exposure;
  std::vector<float> result(size_t(region.area()));
  for_pixels(film, region,
             [&](size_t i, size_t out) { result[out] = float(std::min(double(kMaxFloat), scale * error[i])); });
  return result;
}

std::vector<float> noisy_picture(const film::Film& film, const Region& region) {
  std::vector<float> rgba(size_t(region.area()) * 4);
  read_film_pass(film, GRADUS_PASS_NOISY_IMAGE, region, rgba.data());
  return rgba;
}

// Distributes a change of one picture value over the components, in proportion to their absolute values. The last
// component takes the change where all components are 0.
void spread(float change, size_t value, Images* components) {
  float light = 0.0f;
  for (const std::vector<float>& component : *components) light += std::fabs(component[value]);
  if (light > 0.0f) {
    for (std::vector<float>& component : *components)
      component[value] += change * (std::fabs(component[value]) / light);
  } else {
    components->back()[value] += change;
  }
}

// Adapts the components to a denoised picture, so that they still add up to it. `before` and `after` are the RGBA
// pictures.
void follow_picture(const std::vector<float>& before, const std::vector<float>& after, Images* components) {
  for_pieces(
      int(before.size() / 4),
      [&](int begin, int end) {
        for (auto p = size_t(begin); p < size_t(end); ++p) {
          for (size_t c = 0; c < 3; ++c) spread(after[4 * p + c] - before[4 * p + c], 3 * p + c, components);
        }
      },
      kPixels);
}

void store_components(Images images, DevelopedFilm* developed) {
  for (size_t c = 0; c < images.size(); ++c)
    developed->component_passes[{int(c), GRADUS_COMPONENT_COLOR}] = make_image(std::move(images[c]));
}

// Returns copies of the pictures of the components.
Images copy_components(const DevelopedFilm& developed) {
  Images images;
  for (int c = 0; c < int(developed.film->components.size()); ++c) {
    const auto found = developed.component_passes.find({c, GRADUS_COMPONENT_COLOR});
    if (found != developed.component_passes.end()) images.push_back(*found->second);
  }
  return images;
}

bool has_split(const DevelopedFilm& developed) {
  if (!developed.light_groups.empty()) return true;
  return std::any_of(developed.passes.begin(), developed.passes.end(),
                     [](const auto& entry) { return schema::has_bit(schema::light_passes(), entry.first); });
}

}  // namespace

reconstruct::ReconstructionOutputs wanted_images(const GradusSettings& settings) {
  return {schema::has_bit(settings.passes, GRADUS_PASS_ERROR), schema::needs_pictures(settings)};
}

Developer::Developer(uint32_t threads, CancelCheck cancel, std::shared_ptr<const OidnLibrary> denoiser)
    : threads_(threads), cancel_(std::move(cancel)), denoiser_(std::move(denoiser)), arena_(arena_size(threads)) {}

template <class Function>
void Developer::run(const Function& function) {
  const FlushDenormals flush;  // The threads of the arena take over the state of the thread that calls it first.
  arena_.execute(function);
}

void Developer::reconstruct(DevelopedFilm* developed, const reconstruct::ReconstructionOutputs& wanted,
                            const Source& source) {
  const film::Film& film = *developed->film;
  const Options& options = developed->options;
  const uint32_t how = options.reconstruction;
  const bool is_noisy = how == GRADUS_RECONSTRUCTION_NONE,
             with_components = wanted.components && film.components.size() > 1;
  run([&] {
    reconstruct::Reconstructed images;
    if (source) {
      images = source(&developed->solve);
    } else if (!is_noisy || wanted.error || with_components) {
      images = reconstruct::reconstruct_film(film, how, options.alpha, {wanted.error, with_components}, cancel_,
                                             &developed->solve);
    }
    throw_if_cancelled(cancel_);
    developed->sampled = std::move(images.sampled);
    developed->sampled_terms = std::move(images.sampled_terms);
    const bool keeps_negative = reconstruct::keeps_negative(film, how);
    if (with_components)
      store_components(crop_components(film, keeps_negative, std::move(images.components), developed->region),
                       developed);
    if (wanted.error)
      developed->passes[GRADUS_PASS_ERROR] = make_image(crop_error(film, images.error, developed->region));
    developed->passes[GRADUS_PASS_COMBINED] =
        make_image(is_noisy ? noisy_picture(film, developed->region)
                            : crop_picture(film, keeps_negative, images.image, developed->region));
  });
}

bool Developer::denoise(DevelopedFilm* developed, std::vector<std::string>* warnings) {
  if (developed->options.denoiser == GRADUS_DENOISER_NONE) return false;
  if (denoiser_ == nullptr) throw invalid_operation("there is no denoiser");
  const FlushDenormals flush;
  const film::Film& film = *developed->film;
  if (!film::has_features(film)) warnings->emplace_back("the film holds no features to guide the denoiser");
  const Image before = developed->find(GRADUS_PASS_COMBINED);
  const std::shared_ptr<const reconstruct::SampledPicture> sampled = std::exchange(developed->sampled, nullptr);
  const CombinedPicture picture{film, developed->options.reconstruction, developed->region, *before, sampled.get()};
  std::string failure;
  std::vector<float> rgba = denoise_combined(*denoiser_, picture, threads_, cancel_, &failure);
  if (rgba.empty()) {
    developed->options.denoiser = GRADUS_DENOISER_NONE;
    warnings->push_back(failure);
    return false;
  }
  if (Images components = copy_components(*developed); !components.empty()) {
    run([&] { follow_picture(*before, rgba, &components); });
    store_components(std::move(components), developed);
  }
  if (const Image error = developed->find(GRADUS_PASS_ERROR)) {
    std::vector<float> scaled = *error;
    for (float& value : scaled) value *= denoised_error(picture);
    developed->passes[GRADUS_PASS_ERROR] = make_image(std::move(scaled));
  }
  developed->passes[GRADUS_PASS_COMBINED] = make_image(std::move(rgba));
  return true;
}

void Developer::split(DevelopedFilm* developed) {
  const film::Film& film = *developed->film;
  // Light passes leave out what shadow catchers show, so that the picture cannot be split into them.
  const bool is_sum = film.channels.find(film::kCatcherShaded) == nullptr;
  if (developed->is_noisy() || !is_sum || !has_light_passes(film) || has_split(*developed)) return;
  const Image combined = developed->find(GRADUS_PASS_COMBINED);
  const std::shared_ptr<const reconstruct::SampledTerms> joined = std::exchange(developed->sampled_terms, nullptr);
  run([&] {
    LightPasses passes = joined != nullptr ? color_passes(film, developed->region, *joined) : LightPasses();
    SplitLight light =
        split_light(film, developed->region, *combined, joined != nullptr ? *joined : read_light_terms(film), cancel_);
    passes.merge(light.passes);
    for (auto& [pass, pixels] : passes) developed->passes[pass] = make_image(std::move(pixels));
    for (auto& [name, pixels] : light.groups) developed->light_groups[name] = make_image(std::move(pixels));
  });
}

}  // namespace gradus::output
