// The planes of data and light passes that an integrator fills.
#pragma once

#include "frame/frame.h"

namespace gradus {

// Zeroed, in order of pass number. passes: what is asked for; pixels: of the frame's region.
std::vector<PassPlane> make_pass_planes(uint64_t passes, size_t pixels);

// What a frame keeps of its components beside their light.
struct KeptOfComponents {
  bool rough = false;    // the first rough vertices of their paths
  bool details = false;  // more of these
  bool motion = false;
  bool shown = false;  // what they show at the centres of pixels
};
// Room for it; nothing of it is known yet.
void keep_of_components(const KeptOfComponents& kept, Frame* frame);
KeptOfComponents kept_of_components(const Frame& frame);

// Which passes the frame has planes of, a bit each.
uint64_t kept_passes(const Frame& frame);
// nullptr: there is none.
const PassPlane* find_plane(const Frame& frame, uint32_t pass);
// What Frame::memory_bytes() counts per pixel, with planes for these passes.
uint64_t frame_bytes_per_pixel(int components, bool gradients, uint64_t passes, const KeptOfComponents& kept = {});

}  // namespace gradus
