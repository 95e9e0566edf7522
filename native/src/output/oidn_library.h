// Intel's Open Image Denoise as the host has it: found when it is asked for, never linked.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

namespace gradus::output {

// Those functions of its C API, version 2 (its documentation, "Open Image Denoise API"), that are used here. Integers
// stand for its enums.
struct OidnApi {
  struct Device;
  struct Filter;
  using Progress = bool (*)(void* user, double done);  // false: stop

  Device* (*new_device)(int type);
  void (*set_device_int)(Device*, const char* name, int value);
  void (*set_device_bool)(Device*, const char* name, bool value);
  int (*get_device_int)(Device*, const char* name);
  void (*commit_device)(Device*);
  int (*get_device_error)(Device*, const char** text);  // and forgets it; of a device that could not be made: nullptr
  void (*release_device)(Device*);
  Filter* (*new_filter)(Device*, const char* type);
  void (*set_shared_filter_image)(Filter*, const char* name, void* data, int format, size_t width, size_t height,
                                  size_t offset, size_t pixel_stride,
                                  size_t row_stride);  // in bytes; stride 0: no gaps
  void (*set_filter_bool)(Filter*, const char* name, bool value);
  void (*set_filter_int)(Filter*, const char* name, int value);
  void (*set_filter_progress)(Filter*, Progress, void* user);
  void (*commit_filter)(Filter*);
  void (*execute_filter)(Filter*);
  void (*release_filter)(Filter*);
};

inline constexpr int kOidnCpu = 1, kOidnFloat3 = 3, kOidnQualityHigh = 6, kOidnCancelled = 6;

struct OidnLibrary {
  OidnApi api;
  std::string version;  // "2.3.3"
  std::string name() const { return "Open Image Denoise " + version; }
};

// Where to look, in this order: what the process has loaded already under the name `soname`; `path`, which is a file or
// a folder that holds `soname`, or empty; where the system finds `soname`.
struct OidnPlaces {
  std::string path;
  std::string soname = "libOpenImageDenoise.so.2";
};

// nullptr where there is none that works, and why. What was loaded stays for the life of the process, as its threads
// may.
std::shared_ptr<const OidnLibrary> find_oidn(const OidnPlaces& places, std::string* why_not);

}  // namespace gradus::output
