// Requests that Embree makes for itself are not refused: its thread pool keeps a lock when one fails (3.13.5,
// ThreadPool::add), and the next commit waits for ever. What Embree is refused by its memory monitor is tested by
// G5_Memory. The linker puts these in place of Embree's functions (--wrap in tests/CMakeLists.txt).
#include <embree3/rtcore.h>

#include "memory/allocations.h"

// NOLINTBEGIN(bugprone-reserved-identifier): names that the linker asks for
#define GRADUS_WRAP(Result, name, parameters, arguments) \
  extern "C" Result __real_##name parameters;            \
  extern "C" Result __wrap_##name parameters {           \
    const gradus::memory::Unrefused guard;               \
    return __real_##name arguments;                      \
  }

GRADUS_WRAP(RTCScene, rtcNewScene, (RTCDevice device), (device))
GRADUS_WRAP(RTCGeometry, rtcNewGeometry, (RTCDevice device, RTCGeometryType type), (device, type))
GRADUS_WRAP(void*, rtcSetNewGeometryBuffer,
            (RTCGeometry g, RTCBufferType t, unsigned s, RTCFormat f, size_t stride, size_t n), (g, t, s, f, stride, n))
GRADUS_WRAP(void, rtcSetSharedGeometryBuffer,
            (RTCGeometry g, RTCBufferType t, unsigned s, RTCFormat f, const void* p, size_t offset, size_t stride,
             size_t n),
            (g, t, s, f, p, offset, stride, n))
GRADUS_WRAP(void, rtcCommitGeometry, (RTCGeometry geometry), (geometry))
GRADUS_WRAP(unsigned, rtcAttachGeometry, (RTCScene scene, RTCGeometry geometry), (scene, geometry))
GRADUS_WRAP(void, rtcAttachGeometryByID, (RTCScene scene, RTCGeometry geometry, unsigned id), (scene, geometry, id))
GRADUS_WRAP(void, rtcCommitScene, (RTCScene scene), (scene))
// NOLINTEND(bugprone-reserved-identifier)
