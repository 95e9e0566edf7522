// Reads and writes plain images in OpenEXR for the command-line tool.
#pragma once

#include <string>
#include <vector>

namespace gradus::film_io {

// Interleaved channels, bottom row first.
struct ImageLayer {
  std::string name;  // "" for the main image; else channels are called NAME.R …
  int channels = 0;  // 1 (V), 3 (RGB) or 4 (RGBA)
  std::vector<float> pixels;
};

// Writes a 32-bit float image with ZIP compression, atomically. Throws Error with path and cause.
void save_image(const std::string& path, int width, int height, const std::vector<ImageLayer>& layers);

struct LoadedImage {
  int width = 0, height = 0;
  std::vector<float> rgb;  // bottom row first
};
// Reads R, G, B of the layer whose channel names end with `layer` (".R" and so on); "": the plain RGB, else a layer
// Combined. Throws invalid_argument with path and cause, naming the layers there are.
LoadedImage load_rgb(const std::string& path, const std::string& layer);
// Returns the names of all channels.
std::vector<std::string> image_channels(const std::string& path);
// Returns whether the file is a stored film of Gradus instead of an image.
bool is_film_file(const std::string& path);

}  // namespace gradus::film_io
