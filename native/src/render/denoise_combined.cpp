#include "render/denoise_combined.h"

#include <cmath>
#include <limits>

#include "base/device.h"
#include "base/error.h"
#include "denoise/denoise.h"
#include "frame/features.h"
#include "render/pass_read.h"

namespace gradus {
namespace {

// Deviation of a guide's pixels, root mean square over the image, up to which it is taken as it is. Above, the network over it takes 2 to
// 20 % off the result's error; below, less than what its time buys in samples (docs/method.md).
constexpr double kCleanAlbedo = 0.01, kCleanNormal = 0.02;

// Of the mean of a regression on features and of what the network makes of the noisy image: they err in different places, and their mean
// errs less than either (docs/method.md).
constexpr float kShareOfNetwork = 0.5f;

double deviation(const FeatureImage& image) {
  double sum = 0.0;
  size_t count = 0;
  for (const float variance : image.variance) {
    if (std::isnan(variance)) continue;  // of one sample
    sum += double(variance);
    ++count;
  }
  return count > 0 ? std::sqrt(sum / double(count)) : std::numeric_limits<double>::infinity();
}

struct GuideImage {
  std::vector<float> pixels;
  bool is_clean = false;
  Guide guide() const { return {pixels.empty() ? nullptr : pixels.data(), is_clean}; }
};

GuideImage read_guide(const Frame& frame, uint32_t pass, const Region& region, double clean) {
  const FeatureImage image = read_feature(frame, pass);
  GuideImage result;
  result.is_clean = deviation(image) < clean;
  result.pixels.reserve(3 * size_t(region.area()));
  for (int32_t y = region.y0; y < region.y1; ++y) {
    const float* const row = image.values.data() + 3 * frame.index(region.x0, y);
    result.pixels.insert(result.pixels.end(), row, row + 3 * size_t(region.width()));
  }
  return result;
}

}  // namespace

std::shared_ptr<const OidnLibrary> choose_denoiser(uint32_t denoiser, const Device* device, std::string* why_not) {
  if (denoiser > GRADUS_DENOISER_OIDN) throw invalid_argument("there is no denoiser " + std::to_string(denoiser));
  *why_not = "denoiser is none";
  if (denoiser == GRADUS_DENOISER_NONE) return nullptr;
  auto library = find_oidn({device ? device->denoiser_path() : ""}, why_not);
  if (!library && denoiser == GRADUS_DENOISER_OIDN) throw unsupported("denoiser oidn: " + *why_not + ": use denoiser auto or none");
  return library;
}

std::string denoise_combined(const OidnLibrary& library, const Frame& frame, uint32_t reconstruction, const Region& region,
                             uint32_t threads, const std::function<bool()>& cancel, std::vector<float>* rgba) {
  GuideImage albedo, normal;
  if (has_features(frame)) {
    tbb::task_arena(arena_size(threads)).execute([&] {
      albedo = read_guide(frame, GRADUS_PASS_DENOISING_ALBEDO, region, kCleanAlbedo);
      normal = read_guide(frame, GRADUS_PASS_DENOISING_NORMAL, region, kCleanNormal);
    });
  }
  const bool blends = reconstruction == GRADUS_RECONSTRUCTION_REGULARIZED;
  std::vector<float> noisy;
  if (blends) {
    noisy.resize(rgba->size());
    read_frame_pass(frame, GRADUS_PASS_NOISY_IMAGE, region, noisy.data());
  }
  const NoisyPicture picture{region.width(), region.height(), blends ? noisy.data() : rgba->data(), 4, albedo.guide(), normal.guide()};
  const float share = blends ? kShareOfNetwork : 1.0f;
  try {
    const std::vector<float> image = denoise(library, picture, threads, cancel);
    for (size_t i = 0; i < image.size(); ++i) {
      float& value = (*rgba)[i / 3 * 4 + i % 3];
      value += share * (image[i] - value);
    }
  } catch (const Error& e) {
    if (e.code() == GRADUS_ERROR_CANCELLED) throw;
    return std::string("the picture was not denoised: ") + e.what();
  }
  return "";
}

}  // namespace gradus
