// Planes of data and light passes that an integrator fills.
#pragma once

#include "film/film.h"

namespace gradus::film {

// Returns zeroed planes in order of pass number. passes: requested passes, one bit each; pixels: area of the region.
std::vector<PassPlane> make_pass_planes(uint64_t passes, size_t pixels);

// Data that a film keeps for its components beside their radiance.
struct ComponentContent {
  bool non_specular = false;  // NonSpecularVertices
  bool details = false;       // NonSpecularDetails
  bool motion = false;
  bool shown = false;  // ShownPoint
};
// Allocates the planes for `content` with initial values.
void allocate_component_content(const ComponentContent& content, Film* film);
// Returns the content that the film has planes for.
ComponentContent component_content(const Film& film);

// Returns the passes that the film has planes for, one bit each.
uint64_t film_passes(const Film& film);
// Returns the plane of a pass, or nullptr.
const PassPlane* find_plane(const Film& film, uint32_t pass);
// Returns the bytes per pixel that Film::memory_bytes() counts for a film with these passes and this content.
uint64_t film_bytes_per_pixel(int components, bool gradients, uint64_t passes, const ComponentContent& content = {});

}  // namespace gradus::film
