// Loads the host's copy of Intel's Open Image Denoise at run time. Gradus does not link to it.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

namespace gradus::output {

// The functions of the C API of Open Image Denoise, version 2, that Gradus uses (source: its documentation, "Open Image
// Denoise API"). Its enums are declared as integers.
struct OidnApi {
  struct Device;
  struct Filter;
  using Progress = bool (*)(void* user, double done);  // Returns false to cancel the filter.

  Device* (*new_device)(int type);
  void (*set_device_int)(Device*, const char* name, int value);
  void (*set_device_bool)(Device*, const char* name, bool value);
  int (*get_device_int)(Device*, const char* name);
  void (*commit_device)(Device*);
  // Returns and clears the error of a device. nullptr stands for a device that could not be created.
  int (*get_device_error)(Device*, const char** text);
  void (*release_device)(Device*);
  Filter* (*new_filter)(Device*, const char* type);
  // The offset and the strides are in bytes. A stride of 0 means that there are no gaps.
  void (*set_shared_filter_image)(Filter*, const char* name, void* data, int format, size_t width, size_t height,
                                  size_t offset, size_t pixel_stride, size_t row_stride);
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
  std::string version;  // For example "2.3.3".
  std::string name() const { return "Open Image Denoise " + version; }
};

// Places where find_oidn() looks for the library, in this order: a library that the process has already loaded under
// the name `soname`; then `path`, which is a file, a folder that holds `soname`, or empty; then the library path of the
// system.
struct OidnPlaces {
  std::string path;
  std::string soname = "libOpenImageDenoise.so.2";
};

// Returns the first library that works, or nullptr with the reason in *why_not. A loaded library is never unloaded,
// because its threads may live as long as the process.
std::shared_ptr<const OidnLibrary> find_oidn(const OidnPlaces& places, std::string* why_not);

}  // namespace gradus::output
