/* A stand-in for Open Image Denoise: the functions of its C API that the library uses, with simple arithmetic instead
 * of the network. A guide that is filtered alone is halved; a picture becomes picture + 1 + albedo + 10 normal. The
 * environment variable FAKE_OIDN selects how it misbehaves: old, no_device, no_filter, refuses, fails, slow or nan.
 */
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef bool (*Progress)(void* user, double done);

static int error, live;
static const char* text;
static int threads = -1, affinity = -1, quality = -1, hdr = -1, clean = -1, runs;

static struct Filter {
  float *color, *albedo, *normal, *output;
  size_t width, height;
  Progress progress;
  void* user;
} filter;

static bool is(const char* name) {
  const char* const behaviour = getenv("FAKE_OIDN");
  return behaviour && strcmp(behaviour, name) == 0;
}
static void fail(int code, const char* what) {
  if (error == 0) error = code, text = what;
}

/* What a test asks for. */
int fake_oidn_value(const char* name) {
  if (strcmp(name, "numThreads") == 0) return threads;
  if (strcmp(name, "setAffinity") == 0) return affinity;
  if (strcmp(name, "quality") == 0) return quality;
  if (strcmp(name, "hdr") == 0) return hdr;
  if (strcmp(name, "cleanAux") == 0) return clean;
  if (strcmp(name, "runs") == 0) return runs;
  return strcmp(name, "live") == 0 ? live : -2; /* devices and filters */
}

void* oidnNewDevice(int type) {
  error = 0;
  if (is("no_device") || type != 1) return fail(5, "the fake makes no device"), NULL;
  ++live;
  return &live;
}
void oidnSetDeviceInt(void* device, const char* name, int value) {
  (void)device;
  if (strcmp(name, "numThreads") == 0) threads = value;
}
void oidnSetDeviceBool(void* device, const char* name, bool value) {
  (void)device;
  if (strcmp(name, "setAffinity") == 0) affinity = value;
}
int oidnGetDeviceInt(void* device, const char* name) {
  (void)device;
  if (strcmp(name, "versionMajor") == 0) return is("old") ? 1 : 2;
  if (strcmp(name, "versionMinor") == 0) return 7;
  return strcmp(name, "versionPatch") == 0 ? 5 : -1;
}
void oidnCommitDevice(void* device) { (void)device; }
int oidnGetDeviceError(void* device, const char** message) {
  (void)device;
  const int code = error;
  if (message) *message = code ? text : NULL;
  error = 0;
  return code;
}
void oidnReleaseDevice(void* device) { (void)device, --live; }

void* oidnNewFilter(void* device, const char* type) {
  (void)device;
  if (is("no_filter") || strcmp(type, "RT") != 0) return fail(1, "the fake makes no filter"), NULL;
  filter = (struct Filter){0};
  hdr = clean = 0;
  ++live;
  return &filter;
}
void oidnSetSharedFilterImage(void* f, const char* name, void* data, int format, size_t width, size_t height,
                              size_t offset, size_t pixel_stride, size_t row_stride) {
  (void)f;
  if (format != 3 || offset != 0 || pixel_stride != 0 || row_stride != 0) fail(2, "the fake knows packed float3 only");
  filter.width = width;
  filter.height = height;
  if (strcmp(name, "color") == 0) filter.color = data;
  if (strcmp(name, "albedo") == 0) filter.albedo = data;
  if (strcmp(name, "normal") == 0) filter.normal = data;
  if (strcmp(name, "output") == 0) filter.output = data;
}
void oidnSetFilterBool(void* f, const char* name, bool value) {
  (void)f;
  if (strcmp(name, "hdr") == 0) hdr = value;
  if (strcmp(name, "cleanAux") == 0) clean = value;
}
#ifndef FAKE_OIDN_INCOMPLETE
void oidnSetFilterInt(void* f, const char* name, int value) {
  (void)f;
  if (strcmp(name, "quality") == 0) quality = value;
}
#endif
void oidnSetFilterProgressMonitorFunction(void* f, Progress progress, void* user) {
  (void)f;
  filter.progress = progress;
  filter.user = user;
}
void oidnCommitFilter(void* f) {
  (void)f;
  if (is("refuses")) fail(3, "the fake refuses its parameters");
  if (!filter.color) fail(3, "no picture");
  if (filter.normal && !filter.albedo) fail(3, "no normals without albedo");
}
void oidnExecuteFilter(void* f) {
  (void)f;
  ++runs;
  for (size_t i = 0; i < 3 * filter.width * filter.height; ++i) {
    if (is("slow")) nanosleep(&(struct timespec){0, 1000000}, NULL);
    if (filter.progress && !filter.progress(filter.user, 0.5)) {
      fail(6, "cancelled by the user");
      return;
    }
    const float albedo = filter.albedo ? filter.albedo[i] : 0.0f, normal = filter.normal ? filter.normal[i] : 0.0f;
    filter.output[i] = filter.color[i] + 1.0f + albedo + 10.0f * normal;
    if (is("nan") && i % 2 == 1) filter.output[i] = NAN;
  }
  if (is("fails")) fail(4, "the fake has no memory");
}
void oidnReleaseFilter(void* f) { (void)f, --live; }
