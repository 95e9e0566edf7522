// Wrappers that keep Embree's own allocations from being refused. When one fails in ThreadPool::add (3.13.5), Embree
// does not release a lock, and the next commit waits for ever. The tests G5_Memory cover memory that Embree's memory
// monitor refuses. The linker replaces Embree's functions with these wrappers (--wrap in tests/CMakeLists.txt).
#include <embree3/rtcore.h>

#include "memory/allocations.h"

// NOLINTBEGIN(bugprone-reserved-identifier): the linker prescribes these names
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
