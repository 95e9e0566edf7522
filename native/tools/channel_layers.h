// AOVs, light groups and Cryptomattes of a film as layers of an image. They have the names of Blender's passes: Mask,
// Combined_Key, CryptoObject00.
#pragma once

#include <vector>

#include "film_io/image_exr.h"
#include "gradus/gradus.hpp"

namespace gradus::tool {

// Adds all channels of the film that belong to no pass.
void add_channel_layers(const client::Film& film, std::vector<film_io::ImageLayer>* layers);

}  // namespace gradus::tool
