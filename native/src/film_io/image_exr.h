// Reads and writes plain images in OpenEXR for the command-line tool.
#pragma once

#include <string>
#include <vector>

namespace gradus::film_io {

// Interleaved channels, bottom row first.
struct ImageLayer {
  std::string name;     // "" for the main image, whose channels are the letters alone; the others are NAME.LETTER
  std::string letters;  // one for each channel
  std::vector<float> pixels;
};

// Writes a 32-bit float image with ZIP compression, atomically. Throws Error with path and cause.
void save_image(const std::string& path, int width, int height, const std::vector<ImageLayer>& layers);

struct LoadedImage {
  int width = 0, height = 0;
  std::vector<float> rgb;  // bottom row first
};
// Reads the first three channels of the layer whose channel names end with `layer` and one of the letters RGB, XYZ or
// UVA; a layer with the one letter V, X, Y or Z gets three equal channels. "": the plain RGB, else a layer Combined.
// Throws invalid_argument with path and cause, naming the channels there are.
LoadedImage load_rgb(const std::string& path, const std::string& layer);
// Returns the names of all channels.
std::vector<std::string> image_channels(const std::string& path);
// Returns whether the file is a stored film of Gradus instead of an image.
bool is_film_file(const std::string& path);

}  // namespace gradus::film_io
