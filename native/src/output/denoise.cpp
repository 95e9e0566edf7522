#include "output/denoise.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace gradus::output {
namespace {

using RgbValues = std::vector<float>;  // 3 floats per pixel.

// Largest absolute value that the network receives, so that sums over blocks of pixels stay finite, too.
constexpr float kBrightest = 1e30f;

float tamed(float value) { return std::isfinite(value) ? std::clamp(value, -kBrightest, kBrightest) : 0.0f; }

RgbValues packed(const float* pixels, size_t stride, size_t count) {
  RgbValues result(3 * count);
  for (size_t i = 0; i < count; ++i) {
    for (size_t c = 0; c < 3; ++c) result[3 * i + c] = tamed(pixels[i * stride + c]);
  }
  return result;
}

// A device and a filter of Open Image Denoise for images of one size.
class Network {
 public:
  Network(const OidnApi& api, int width, int height, uint32_t threads, const CancelCheck& cancel)
      : api_(api),
        width_(size_t(width)),
        height_(size_t(height)),
        cancel_(cancel),
        device_(api.new_device(kOidnCpu), api.release_device) {
    if (!device_) throw failure("no device");
    api_.set_device_int(device_.get(), "numThreads", int(threads));
    api_.set_device_bool(device_.get(), "setAffinity", false);  // TBB's threads do other work later.
    api_.commit_device(device_.get());
    check();
  }

  // Denoises `color` in place. An empty guide is not used.
  void denoise(RgbValues* color, RgbValues* albedo, RgbValues* normal) {
    std::vector<Parameter> images = {{"color", color}, {"output", color}};
    if (!albedo->empty()) images.emplace_back("albedo", albedo);
    if (!normal->empty()) images.emplace_back("normal", normal);
    run(images);
  }

 private:
  using Parameter = std::pair<const char*, RgbValues*>;

  void run(const std::vector<Parameter>& images) {
    const std::unique_ptr<OidnApi::Filter, void (*)(OidnApi::Filter*)> filter(api_.new_filter(device_.get(), "RT"),
                                                                              api_.release_filter);
    if (!filter) throw failure("no filter");
    for (const auto& [name, image] : images) {
      api_.set_shared_filter_image(filter.get(), name, image->data(), kOidnFloat3, width_, height_, 0, 0, 0);
    }
    api_.set_filter_bool(filter.get(), "hdr", true);
    api_.set_filter_bool(filter.get(), "cleanAux", true);
    api_.set_filter_int(filter.get(), "quality", kOidnQualityHigh);
    api_.set_filter_progress(filter.get(), &continues, const_cast<CancelCheck*>(&cancel_));
    api_.commit_filter(filter.get());
    check();
    api_.execute_filter(filter.get());
    check();
  }

  static bool continues(void* cancel, double /*done*/) { return !(*static_cast<const CancelCheck*>(cancel))(); }

  void check() const {
    const char* text = nullptr;
    const int code = api_.get_device_error(device_.get(), &text);
    if (code == kOidnCancelled || cancel_()) throw cancelled();
    if (code != 0) throw Error(GRADUS_ERROR_UNKNOWN, message_of(text));
  }
  Error failure(const char* otherwise) const {
    const char* text = nullptr;
    api_.get_device_error(device_.get(), &text);
    return Error(GRADUS_ERROR_UNKNOWN, message_of(text ? text : otherwise));
  }
  static std::string message_of(const char* text) {
    return std::string("Open Image Denoise: ") + (text ? text : "unknown error");
  }

  const OidnApi& api_;
  const size_t width_, height_;
  const CancelCheck& cancel_;
  const std::unique_ptr<OidnApi::Device, void (*)(OidnApi::Device*)> device_;
};

}  // namespace

std::vector<float> denoise(const OidnLibrary& library, const NoisyPicture& picture, uint32_t threads,
                           const CancelCheck& cancel) {
  const size_t count = size_t(picture.width) * size_t(picture.height);
  RgbValues color = packed(picture.color, picture.stride, count);
  RgbValues albedo = picture.albedo ? packed(picture.albedo, 3, count) : RgbValues();
  RgbValues normal = picture.albedo && picture.normal ? packed(picture.normal, 3, count) : RgbValues();
  Network network(library.api, picture.width, picture.height, threads, cancel);
  network.denoise(&color, &albedo, &normal);
  for (size_t i = 0; i < color.size(); ++i) {
    if (!std::isfinite(color[i])) color[i] = tamed(picture.color[i / 3 * picture.stride + i % 3]);
  }
  return color;
}

}  // namespace gradus::output
