#include "output/oidn_library.h"

#include <dlfcn.h>

#include <array>
#include <filesystem>
#include <stdexcept>

namespace gradus::output {
namespace {

constexpr int kMajor = 2;

using Unusable = std::runtime_error;

// Looks up all functions of the API. Throws Unusable if one is missing.
OidnApi bind(void* library) {
  OidnApi api{};
  const auto take = [library](const char* name, auto** function) {
    void* const address = dlsym(library, name);
    if (!address)
      throw Unusable("it has no " + std::string(name) + ", so it is not of version " + std::to_string(kMajor));
    *function = reinterpret_cast<std::remove_pointer_t<decltype(function)>>(address);
  };
  take("oidnNewDevice", &api.new_device);
  take("oidnSetDeviceInt", &api.set_device_int);
  take("oidnSetDeviceBool", &api.set_device_bool);
  take("oidnGetDeviceInt", &api.get_device_int);
  take("oidnCommitDevice", &api.commit_device);
  take("oidnGetDeviceError", &api.get_device_error);
  take("oidnReleaseDevice", &api.release_device);
  take("oidnNewFilter", &api.new_filter);
  take("oidnSetSharedFilterImage", &api.set_shared_filter_image);
  take("oidnSetFilterBool", &api.set_filter_bool);
  take("oidnSetFilterInt", &api.set_filter_int);
  take("oidnSetFilterProgressMonitorFunction", &api.set_filter_progress);
  take("oidnCommitFilter", &api.commit_filter);
  take("oidnExecuteFilter", &api.execute_filter);
  take("oidnReleaseFilter", &api.release_filter);
  return api;
}

// Returns the version of the library. A device is created for this, because only a device reports the version. Throws
// Unusable if that fails or if the major version is not kMajor.
std::string check_version(const OidnApi& api) {
  OidnApi::Device* const device = api.new_device(kOidnCpu);
  if (!device) {
    const char* text = nullptr;
    api.get_device_error(nullptr, &text);
    throw Unusable(std::string("it cannot create a device: ") + (text ? text : "it gives no reason"));
  }
  const std::array numbers = {api.get_device_int(device, "versionMajor"), api.get_device_int(device, "versionMinor"),
                              api.get_device_int(device, "versionPatch")};
  api.release_device(device);
  std::string version =
      std::to_string(numbers[0]) + "." + std::to_string(numbers[1]) + "." + std::to_string(numbers[2]);
  if (numbers[0] != kMajor) throw Unusable("it has version " + version + " in place of " + std::to_string(kMajor));
  return version;
}

// Loads a library. If that fails, returns nullptr and sets *error to the text of the loader without the library's name.
void* load(const std::string& name, int flags, std::string* error) {
  void* const library = dlopen(name.c_str(), RTLD_LAZY | RTLD_LOCAL | flags);
  const char* const text = library ? nullptr : dlerror();
  if (text) *error = text;
  if (error->rfind(name + ": ", 0) == 0) error->erase(0, name.size() + 2);  // The caller adds the name.
  return library;
}

bool is_there(const std::string& path) {
  std::error_code none;
  return std::filesystem::exists(path, none);
}

std::string file_of(const OidnPlaces& places) {
  std::error_code none;
  const std::filesystem::path path = places.path;
  return std::filesystem::is_directory(path, none) ? path / places.soname : path;
}

}  // namespace

std::shared_ptr<const OidnLibrary> find_oidn(const OidnPlaces& places, std::string* why_not) {
  const struct Place {
    std::string name;
    int flags;
    bool is_reported;  // Whether a missing library in this place is an error to report.
  } list[] = {{places.soname, RTLD_NOLOAD, false}, {file_of(places), 0, true}, {places.soname, 0, false}};
  const std::string what = places.soname + " or the folder that holds it";
  std::string reasons;
  for (const Place& place : list) {
    if (place.name.empty()) continue;
    std::string error;
    try {
      void* const library = load(place.name, place.flags, &error);
      if (!library && place.is_reported)
        throw Unusable(is_there(place.name) ? error : "there is no such file; it should be " + what);
      if (!library) continue;
      const OidnApi api = bind(library);
      return std::make_shared<OidnLibrary>(OidnLibrary{api, check_version(api)});
    } catch (const Unusable& e) {
      reasons += (reasons.empty() ? "" : "; ") + place.name + ": " + e.what();
    }
  }
  *why_not = "no Open Image Denoise in this process or on its library path (" +
             (reasons.empty() ? places.soname : reasons) + ")";
  return nullptr;
}

}  // namespace gradus::output
