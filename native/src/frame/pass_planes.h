// The planes of data and light passes that an integrator fills.
#pragma once

#include "frame/frame.h"

namespace gradus {

// Zeroed, in order of pass number. passes: what is asked for; pixels: of the frame's region.
std::vector<PassPlane> make_pass_planes(uint64_t passes, size_t pixels);
// Room for the first rough vertices of its components.
void keep_rough_vertices(Frame* frame);
// And for their motion, which is not known yet.
void keep_motion(Frame* frame);
// And for what they show.
void keep_shown(Frame* frame);
// Which passes the frame has planes of, a bit each.
uint64_t kept_passes(const Frame& frame);
// nullptr: there is none.
const PassPlane* find_plane(const Frame& frame, uint32_t pass);
// What Frame::memory_bytes() counts per pixel, with planes for these passes.
uint64_t frame_bytes_per_pixel(int components, bool gradients, uint64_t passes, bool rough = false, bool motion = false,
                               bool shown = false);

}  // namespace gradus
