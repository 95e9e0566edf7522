// Embree's device, checked to be the one that Gradus was built with.
#pragma once

#include <cstdint>
#include <memory>

struct RTCDeviceTy;

namespace gradus::geometry {

// Shared by all acceleration structures that were built with it.
using EmbreeDevice = std::shared_ptr<RTCDeviceTy>;

// Starts Embree. Throws Error UNSUPPORTED if the Embree in this process is not the one that Gradus was built with, and
// OUT_OF_MEMORY.
EmbreeDevice make_embree_device(uint32_t threads);

}  // namespace gradus::geometry
