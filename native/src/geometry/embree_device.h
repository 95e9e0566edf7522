// Creation of the Embree device, with a check that the loaded Embree is the one that Gradus was built with.
#pragma once

#include <cstdint>
#include <memory>

struct RTCDeviceTy;

namespace gradus::geometry {

// Shared pointer to an Embree device. Every acceleration structure that was built with the device holds one.
using EmbreeDevice = std::shared_ptr<RTCDeviceTy>;

// Starts Embree with the given number of threads. Throws Error UNSUPPORTED if the Embree in this process is not the one
// that Gradus was built with, and Error OUT_OF_MEMORY.
EmbreeDevice make_embree_device(uint32_t threads);

}  // namespace gradus::geometry
