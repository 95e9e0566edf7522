// The channels of a stored frame, in one list for writing and for reading.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "frame/frame.h"

namespace gradus {

// One channel: `data` holds 32-bit values of the pixel (0, 0) of the frame's region and so on, `stride` bytes apart, row after row.
struct StoredPlane {
  std::string name;  // of the channel in the file
  bool integer = false;
  unsigned char* data = nullptr;
  size_t stride = 0;
};

// Points into the frame, which must not change its planes meanwhile.
std::vector<StoredPlane> stored_planes(Frame* frame);

}  // namespace gradus
