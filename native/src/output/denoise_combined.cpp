#include "output/denoise_combined.h"

#include <algorithm>
#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "base/error.h"
#include "base/fault.h"
#include "base/threads.h"
#include "base/types.h"
#include "film/catcher_channels.h"
#include "film/features.h"
#include "output/denoise.h"
#include "output/pass_read.h"
#include "reconstruct/reconstruct_film.h"
#include "reconstruct/regression/feature_filter.h"
#include "reconstruct/solver_planes.h"
#include "scene/device.h"

namespace gradus::output {
namespace {

// Weight of the network in the mean of the regression on features and the denoised noisy image. The two err in
// different places, so that their mean errs less than either. The mean is geometric, because the larger of two values
// is more often the wrong one. An offset of kDark times the median is added to both values before (docs/method.md).
// Where frames are joined the noisy image is that of all of them.
constexpr float kShareOfNetwork = 0.7f, kShareOfNetworkJoined = 0.85f, kDark = 0.1f;
// Squared error of that mean, relative to REGULARIZED alone. Measured: 0.68 at 8 samples, 0.76 at 32; of joined frames
// 0.42 to 0.76 in five animations at 4 samples, more where no other frame shows a pixel.
constexpr float kErrorOfMean = 0.7f, kErrorOfMeanJoined = 0.6f;

// Returns the pixels of an RGB picture of the region `whole` that lie in `region`.
std::vector<float> crop(const std::vector<float>& rgb, const Region& whole, const Region& region) {
  std::vector<float> part;
  part.reserve(3 * size_t(region.area()));
  for (int32_t y = region.y0; y < region.y1; ++y) {
    const auto row = rgb.begin() + 3 * (ptrdiff_t(y - whole.y0) * whole.width() + (region.x0 - whole.x0));
    part.insert(part.end(), row, row + 3 * ptrdiff_t(region.width()));
  }
  return part;
}

// Reads a feature pass, filters its noise, and returns the pixels of `region`.
std::vector<float> read_guide(const film::Film& film, uint32_t pass, const Region& region) {
  return crop(
      reconstruct::filter_feature(film::read_feature(film, pass), film.region.width(), film.region.height()).values,
      film.region, region);
}

// Denoises light that lights of negative strength make negative in places. The network reads no negative values, so
// that it denoises what is above and what is below zero by itself.
std::vector<float> denoise_signed(const OidnLibrary& library, const NoisyPicture& noisy, uint32_t threads,
                                  const CancelCheck& cancel) {
  const size_t count = size_t(noisy.width) * size_t(noisy.height);
  std::vector<float> part(3 * count);
  const auto denoise_part = [&](float sign) {
    for (size_t i = 0; i < part.size(); ++i) part[i] = std::max(sign * noisy.color[i / 3 * noisy.stride + i % 3], 0.0f);
    NoisyPicture picture = noisy;
    picture.color = part.data();
    picture.stride = 3;
    return denoise(library, picture, threads, cancel);
  };
  std::vector<float> image = denoise_part(1.0f);
  const std::vector<float> below = denoise_part(-1.0f);
  for (size_t i = 0; i < image.size(); ++i) image[i] -= below[i];
  return image;
}

// Replaces the colours of `combined`, RGBA, by their mean with `image`, RGB, which has the weight `share`.
void blend_signed(const std::vector<float>& image, float share, std::vector<float>* combined) {
  for (size_t i = 0; i < image.size(); ++i) {
    float& value = (*combined)[i / 3 * 4 + i % 3];
    if (is_finite(value)) value += share * (image[i] - value);
  }
}

// Replaces the colours of `combined`, RGBA, by their geometric mean with `image`, RGB, which has the weight `share`.
// The threads of the caller's TBB arena share the work.
void blend(const std::vector<float>& image, float share, std::vector<float>* combined) {
  std::vector<float> light;
  light.reserve(image.size() / 3);
  for (size_t i = 0; i < combined->size(); i += 4) {
    const float sum = (*combined)[i] + (*combined)[i + 1] + (*combined)[i + 2];
    if (sum > 0.0f && is_finite(sum)) light.push_back(sum / 3.0f);
  }
  const float dark = kDark * reconstruct::median_or_one(&light), minimum = 1e-3f * dark;
  constexpr size_t kValuesPerTask = 4096;
  tbb::parallel_for(tbb::blocked_range<size_t>(0, image.size(), kValuesPerTask), [&](const auto& range) {
    for (size_t i = range.begin(); i < range.end(); ++i) {
      float& value = (*combined)[i / 3 * 4 + i % 3];
      if (!is_finite(value)) continue;
      const float regressed = std::max(value + dark, minimum), denoised = std::max(image[i] + dark, minimum);
      value = std::max(regressed * std::pow(denoised / regressed, share) - dark, 0.0f);
    }
  });
}

// Replaces the colours of `combined`, RGBA, by those of `image`, RGB.
void replace(const std::vector<float>& image, std::vector<float>* combined) {
  for (size_t i = 0; i < image.size(); ++i) (*combined)[i / 3 * 4 + i % 3] = image[i];
}

}  // namespace

std::shared_ptr<const OidnLibrary> choose_denoiser(uint32_t denoiser, const scene::Device* device,
                                                   std::string* why_not) {
  if (denoiser > GRADUS_DENOISER_OIDN) throw invalid_argument("there is no denoiser " + std::to_string(denoiser));
  *why_not = "denoiser is none";
  if (denoiser == GRADUS_DENOISER_NONE) return nullptr;
  auto library = find_oidn({device ? device->denoiser_path() : ""}, why_not);
  if (!library && denoiser == GRADUS_DENOISER_OIDN)
    throw unsupported("denoiser oidn: " + *why_not + ": use denoiser auto or none");
  return library;
}

namespace {

// Images that the network reads, unless those of `joined` frames serve as they are.
struct NetworkInput {
  std::vector<float> light{};
  size_t stride = 4;  // floats per pixel of `light`
  std::vector<float> albedo{}, normal{};
};

// Returns the light of the region `seen` that the network reads: as sampled, unless it denoises the picture itself.
NetworkInput read_light(const CombinedPicture& picture, const Region& seen, bool as_sampled) {
  if (!as_sampled) return {picture.rgba};
  NetworkInput input{std::vector<float>(4 * size_t(seen.area()))};
  read_film_pass(picture.film, GRADUS_PASS_NOISY_IMAGE, seen, input.light.data());
  return input;
}

// Returns the light that several frames have sampled, with the exposure of the picture.
NetworkInput read_joined_light(const CombinedPicture& picture) {
  NetworkInput input{picture.joined->light, 3};
  for (float& value : input.light) value *= picture.film.settings.film_exposure;
  return input;
}

std::vector<float> denoise_or_throw(const OidnLibrary& library, const CombinedPicture& picture, uint32_t threads,
                                    const CancelCheck& cancel) {
  // The noisy image exists for the whole film region, and the network profits from pixels around `region`. The
  // reconstruction exists for `region` only.
  const bool blends = picture.reconstruction == GRADUS_RECONSTRUCTION_REGULARIZED,
             sampled = blends || picture.reconstruction == GRADUS_RECONSTRUCTION_NONE;
  const Region& seen = sampled ? picture.film.region : picture.region;
  // Joined light has holes in place of shadow catchers, so that the network reads the frame alone there.
  const bool has_catchers = picture.film.channels.find(film::kCatcherShaded) != nullptr;
  const bool joins = picture.joined != nullptr && !has_catchers && !GRADUS_FAULT(network_reads_one_frame);
  tbb::task_arena arena(arena_size(threads));
  NetworkInput input;
  arena.execute([&] {
    input = joins ? read_joined_light(picture) : read_light(picture, seen, sampled);
    if (joins || !film::has_features(picture.film)) return;
    input.albedo = read_guide(picture.film, GRADUS_PASS_DENOISING_ALBEDO, seen);
    input.normal = read_guide(picture.film, GRADUS_PASS_DENOISING_NORMAL, seen);
  });
  const std::vector<float>&albedo = joins ? picture.joined->albedo : input.albedo,
        &normal = joins ? picture.joined->normal : input.normal;
  NoisyPicture noisy{seen.width(), seen.height(), input.light.data(), input.stride};
  if (!albedo.empty()) noisy.albedo = albedo.data();
  if (!normal.empty()) noisy.normal = normal.data();
  const bool has_negative_light = sampled && reconstruct::has_negative_light(picture.film);
  const auto denoise_light = has_negative_light ? denoise_signed : denoise;
  const std::vector<float> image = crop(denoise_light(library, noisy, threads, cancel), seen, picture.region);
  std::vector<float> result = picture.rgba;
  if (blends) {
    const float share = picture.joined != nullptr ? kShareOfNetworkJoined : kShareOfNetwork;
    arena.execute([&] { (has_negative_light ? blend_signed : blend)(image, share, &result); });
  } else {
    replace(image, &result);
  }
  return result;
}

}  // namespace

float denoised_error(const CombinedPicture& picture) {
  if (picture.reconstruction != GRADUS_RECONSTRUCTION_REGULARIZED) return 1.0f;
  return picture.joined != nullptr ? kErrorOfMeanJoined : kErrorOfMean;
}

std::vector<float> denoise_combined(const OidnLibrary& library, const CombinedPicture& picture, uint32_t threads,
                                    const CancelCheck& cancel, std::string* failure) {
  const char* const what = "the picture was not denoised: ";
  try {
    return denoise_or_throw(library, picture, threads, cancel);
  } catch (const Error& e) {
    if (e.code() == GRADUS_ERROR_CANCELLED) throw;
    *failure = std::string(what) + e.what();
  } catch (const std::bad_alloc&) {
    *failure = std::string(what) + "out of memory";
  }
  return {};
}

}  // namespace gradus::output
