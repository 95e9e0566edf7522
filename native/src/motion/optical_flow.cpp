#include "motion/optical_flow.h"

#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <stdexcept>

#include "base/error.h"
#include "motion/film_plane.h"

namespace gradus::motion {
namespace {

constexpr const char* kFileName = "libgradus_flow.so";
// The preset was chosen by comparison with others (docs/method.md, "Motion of shadows and of the rest").
constexpr GradusFlowEffort kEffort{GRADUS_FLOW_MEDIUM, 0};

using Unusable = std::runtime_error;

template <class Function>
void take(void* library, const char* name, Function** function) {
  *function = reinterpret_cast<Function*>(dlsym(library, name));
  if (!*function) throw Unusable("it has no " + std::string(name));
}

void* load(const std::string& path) {
  std::error_code none;
  if (!std::filesystem::exists(path, none)) throw Unusable("there is no such file");
  void* const library = dlopen(path.c_str(), RTLD_LAZY | RTLD_LOCAL);
  if (!library) throw Unusable(dlerror());
  return library;
}

FlowLibrary bind(void* library) {
  decltype(&gradus_flow_interface) interface_number = nullptr;
  take(library, "gradus_flow_interface", &interface_number);
  const uint32_t number = interface_number();
  if (number != GRADUS_FLOW_INTERFACE) {
    throw Unusable("it has interface " + std::to_string(number) + " in place of " +
                   std::to_string(GRADUS_FLOW_INTERFACE));
  }
  FlowLibrary result;
  take(library, "gradus_flow_version", &result.version);
  take(library, "gradus_flow_estimate", &result.estimate);
  return result;
}

std::vector<float> finite_levels(std::vector<float> levels) {
  for (float& level : levels) {
    if (!is_finite(level)) level = 0.0f;
  }
  return levels;
}

}  // namespace

std::string flow_library_folder() {
  Dl_info here;
  if (dladdr(reinterpret_cast<const void*>(&flow_library_folder), &here) == 0 || !here.dli_fname) return ".";
  std::error_code none;
  const std::filesystem::path file =
      std::filesystem::canonical(here.dli_fname, none);  // a program's name may be relative
  return none ? "." : file.parent_path().string();
}

std::shared_ptr<const FlowLibrary> find_flow_library(const std::string& folder, std::string* why_not) {
  const std::string path = std::filesystem::path(folder) / kFileName;
  try {
    return std::make_shared<FlowLibrary>(bind(load(path)));
  } catch (const Unusable& e) {
    *why_not = path + ": " + e.what();
    return nullptr;
  }
}

std::shared_ptr<const FlowLibrary> flow_library_or_warning(const std::string& folder, Warnings* warnings) {
  std::string why_not;
  auto library = find_flow_library(folder, &why_not);
  if (!library) warnings->add("no motion of shadows and of reflections on rough surfaces (" + why_not + ")");
  return library;
}

std::vector<Vec2> optical_flow(const FlowLibrary& library, const GreyImage& from, const GreyImage& to) {
  const std::vector<float> levels[] = {finite_levels(from.levels), finite_levels(to.levels)};
  const GradusFlowImages images{from.width, from.height, levels[0].data(), levels[1].data()};
  std::vector<Vec2> flow(from.levels.size(), Vec2(0.0f));
  if (flow.empty()) return flow;
  std::array<char, 500> error{};
  if (library.estimate(&images, &kEffort, &flow[0].x, error.data(), error.size()) != 0) {
    throw Error(GRADUS_ERROR_UNKNOWN, std::string("optical flow: ") + error.data());
  }
  for (Vec2& vector : flow) vector = bounded(vector, from.width, from.height);
  return flow;
}

}  // namespace gradus::motion
