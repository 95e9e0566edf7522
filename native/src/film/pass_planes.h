// The planes of data and light passes that an integrator fills.
#pragma once

#include "film/film.h"

namespace gradus::film {

// Zeroed, in order of pass number. passes: what is asked for; pixels: of the frame's region.
std::vector<PassPlane> make_pass_planes(uint64_t passes, size_t pixels);

// What a frame keeps of its components beside their light.
struct ComponentContent {
  bool non_specular = false;  // the first rough vertices of their paths
  bool details = false;       // more of these
  bool motion = false;
  bool shown = false;  // what they show at the centres of pixels
};
// Room for it; nothing of it is known yet.
void allocate_component_content(const ComponentContent& content, Film* film);
ComponentContent component_content(const Film& film);

// Which passes the frame has planes of, a bit each.
uint64_t film_passes(const Film& film);
// nullptr: there is none.
const PassPlane* find_plane(const Film& film, uint32_t pass);
// What Film::memory_bytes() counts per pixel, with planes for these passes.
uint64_t film_bytes_per_pixel(int components, bool gradients, uint64_t passes, const ComponentContent& content = {});

}  // namespace gradus::film
