#include "image/color.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string_view>

#include <OpenColorIO/OpenColorIO.h>

#include "base/error.h"
#include "base/hash.h"

namespace OCIO = OCIO_NAMESPACE;

namespace gradus::image {
namespace {

// Names of spaces whose values need no conversion, because they are data or already scene-linear.
constexpr std::array<std::string_view, 10> kUnchanged = {
    "",       "Non-Color",      "Non-Colour Data", "Generic Data",    "Raw", "Utility - Raw",
    "Linear", "Linear Rec.709", "scene_linear",    "lin_rec709_scene"};
// Names of sRGB, as Blender's own and common OpenColorIO configurations spell it.
constexpr std::array<std::string_view, 5> kSrgb = {"sRGB", "sRGB - Texture", "Utility - sRGB - Texture", "srgb_tx",
                                                   "srgb_rec709_scene"};

// Returns the transform of a built-in space by any name that Blender has used for it, or nothing for other names.
// Built-in spaces are known without a configuration.
std::optional<ColorTransform> builtin_transform(const std::string& space) {
  if (std::find(kUnchanged.begin(), kUnchanged.end(), space) != kUnchanged.end()) {
    return ColorTransform::Data;
  }
  if (std::find(kSrgb.begin(), kSrgb.end(), space) != kSrgb.end()) {
    return ColorTransform::Srgb;
  }
  return std::nullopt;
}

}  // namespace

// A colour space whose name has been looked up. `kind` selects its conversion; `convert` applies it if it is Other. It
// is not local to this file, because ColorManager::State, which the header declares, has it as a member.
struct Space {
  ColorTransform kind = ColorTransform::Data;
  ConvertColors convert;
  uint64_t fingerprint = 0;

  // Converts pixels of four channels to scene-linear in place, by the conversion that `kind` selects.
  void apply(float* rgba, size_t count) const {
    if (kind == ColorTransform::Srgb) {
      for (size_t i = 0; i < count; i++, rgba += 4) {
        std::transform(rgba, rgba + 3, rgba, srgb_to_linear);
      }
    } else if (kind == ColorTransform::Other) {
      convert(rgba, count);
    }
  }
};

namespace {

// Colours with alpha 1. recognise() compares a conversion of those up to 1 with the identity and with the sRGB curve,
// and forms the fingerprint of all.
constexpr std::array<float, 20> kProbe = {0.0f,  0.02f, 0.03f, 1.0f, 0.04f, 0.05f, 0.18f, 1.0f, 0.3f, 0.5f,
                                          0.75f, 1.0f,  0.9f,  1.0f, 0.6f,  1.0f,  2.5f,  4.0f, 8.0f, 1.0f};

// Makes a space of its conversion. The kind is Data or Srgb if the conversion maps the probe values up to 1 as the
// identity or the sRGB curve does. The tolerance for sRGB is 1e-4, because the tables in OpenColorIO configurations
// differ from the formula by a few 1e-5.
Space recognise(ConvertColors convert) {
  std::array<float, kProbe.size()> mapped = kProbe;
  convert(mapped.data(), mapped.size() / 4);
  bool same = true;
  bool srgb = true;
  for (size_t i = 0; i < kProbe.size(); i++) {
    if (i % 4 == 3 || kProbe[i] > 1.0f) continue;
    same = same && std::abs(mapped[i] - kProbe[i]) < 1e-5f;
    srgb = srgb && std::abs(mapped[i] - srgb_to_linear(kProbe[i])) < 1e-4f;
  }
  if (same) return {};
  if (srgb) return {ColorTransform::Srgb, nullptr, 0};
  ContentHash hash;
  for (const float value : mapped) hash.value(value);
  return {ColorTransform::Other, std::move(convert), hash.result()};
}

// Returns the conversion by a processor of OpenColorIO.
ConvertColors by_processor(OCIO::ConstCPUProcessorRcPtr processor) {
  return [processor = std::move(processor)](float* rgba, size_t count) {
    // The pixels are passed in rows, because OpenColorIO counts pixels by long but indexes a row by int.
    constexpr size_t kRow = 1 << 16;
    for (size_t first = 0; first < count; first += kRow) {
      OCIO::PackedImageDesc row(rgba + first * 4, static_cast<long>(std::min(kRow, count - first)), 1, 4);
      processor->apply(row);
    }
  };
}

}  // namespace

// The configuration and the spaces found so far. `mutex` guards `spaces` and `unknown`.
struct ColorManager::State {
  Warn warn;
  OCIO::ConstConfigRcPtr config;
  mutable std::mutex mutex;
  mutable std::map<std::string, Space> spaces;
  mutable std::set<std::string> unknown;  // names that a warning has been given for

  // Reads the configuration. Keeps none, and warns, if it cannot be read or has no scene-linear role.
  void load(const std::string& path) {
    if (path.empty()) {
      return;
    }
    try {
      // Folders are refused here, because OpenColorIO's parser leaks memory when its stream cannot be read.
      if (std::filesystem::is_directory(path)) throw invalid_argument("it is a folder");
      OCIO::ConstConfigRcPtr loaded = OCIO::Config::CreateFromFile(path.c_str());
      if (!loaded->hasRole(OCIO::ROLE_SCENE_LINEAR) || !loaded->getColorSpace(OCIO::ROLE_SCENE_LINEAR)) {
        warn("colour: the configuration " + path + " has no scene-linear role; sRGB and linear are used");
        return;
      }
      config = loaded;
    } catch (const std::exception& e) {
      warn("colour: cannot read the configuration " + path + ", sRGB and linear are used: " + first_line(e.what()));
    }
  }
  static std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

  // Returns the space of the configuration, or nothing if it has no such space or cannot convert it.
  std::optional<Space> from_config(const std::string& name) const {
    if (!config || name.empty()) {
      return std::nullopt;
    }
    try {
      const OCIO::ConstColorSpaceRcPtr source = config->getColorSpace(name.c_str());
      if (!source) {
        return std::nullopt;
      }
      if (source->isData()) {
        return Space();
      }
      return recognise(
          by_processor(config->getProcessor(name.c_str(), OCIO::ROLE_SCENE_LINEAR)->getDefaultCPUProcessor()));
    } catch (const std::exception& e) {
      warn("colour: the configuration cannot convert " + name + ": " + first_line(e.what()));
      return std::nullopt;
    }
  }

  // Returns a space by name: first one whose conversion was set, then the configuration's, then a built-in one, then
  // the default for unknown names. The lock is held while a space is made, so that each warning is given once.
  Space find(const std::string& name, bool is_byte) const {
    const std::lock_guard lock(mutex);
    if (const auto found = spaces.find(name); found != spaces.end()) {
      return found->second;
    }
    std::optional<Space> space = from_config(name);
    if (!space) {
      if (const auto kind = builtin_transform(name)) {
        space = Space{*kind, nullptr, 0};
      }
    }
    if (space) {
      return spaces[name] = *space;
    }
    if (unknown.insert(name).second) {
      warn("colour: the space " + name + " is not known; byte images are taken as sRGB, float images as linear");
    }
    return Space{is_byte ? ColorTransform::Srgb : ColorTransform::Data, nullptr, 0};
  }
};

ColorManager::ColorManager(const std::string& config_path, Warn warn) : state_(std::make_unique<State>()) {
  state_->warn = warn ? std::move(warn) : [](const std::string&) {};
  state_->load(config_path);
}

ColorManager::~ColorManager() = default;

void ColorManager::set_conversion(const std::string& space, ConvertColors convert) {
  if (space.empty()) {
    throw invalid_argument("colour space: no name");
  }
  Space known = recognise(std::move(convert));
  const std::lock_guard lock(state_->mutex);
  state_->spaces[space] = std::move(known);
}

ColorTransform ColorManager::transform(const std::string& space, bool is_byte) const {
  return state_->find(space, is_byte).kind;
}

uint64_t ColorManager::fingerprint(const std::string& space, bool is_byte) const {
  return state_->find(space, is_byte).fingerprint;
}

void ColorManager::to_scene_linear(const std::string& space, bool is_byte, float* rgba, size_t pixel_count) const {
  state_->find(space, is_byte).apply(rgba, pixel_count);
}

float srgb_to_linear(float encoded) {
  if (encoded < 0.0f) {
    return 0.0f;
  }
  if (encoded <= 0.04045f) {
    return encoded * (1.0f / 12.92f);
  }
  return std::pow((encoded + 0.055f) * (1.0f / 1.055f), 2.4f);
}

float linear_to_srgb(float linear) {
  if (linear <= 0.0031308f) {
    return linear * 12.92f;
  }
  return 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
}

}  // namespace gradus::image
