// Passes of components as layers of an image, which have the names of Blender's passes: Path Reflection, Path
// Reflection Motion.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "film/film_header.h"
#include "film_io/image_exr.h"
#include "gradus/gradus.hpp"

namespace gradus::tool {

inline constexpr uint32_t kAllComponentPasses = (uint32_t{1} << GRADUS_COMPONENT_PASS_COUNT) - 1;
// parse_passes() and bad_passes() for names of component passes.
uint32_t parse_component_passes(const std::string& text);
std::string bad_component_passes(const std::string& text);

// Returns the requested passes that the film was sampled for. Throws Error with the missing ones, unless all passes
// are requested.
uint32_t available_component_passes(const film::FilmHeader& film, uint32_t requested);
// Returns whether some passes are computed from two frames of an animation by optical flow.
bool need_two_frames(uint32_t passes);

using ReadComponent = std::function<void(const char* component, uint32_t pass, std::vector<float>* pixels)>;
ReadComponent reader_of(const client::Film& film);
// Adds the passes of every component in the settings' set as layers. `pixels` is the number of pixels of the image.
void add_component_layers(const GradusSettings& settings, uint32_t passes, size_t pixels, const ReadComponent& read,
                          std::vector<film_io::ImageLayer>* layers);

}  // namespace gradus::tool
