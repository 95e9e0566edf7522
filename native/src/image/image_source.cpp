// Deep copies of the image descriptions that the caller passes, with checks of their sizes.
#include "base/error.h"
#include "image/image_store.h"
#include "image/readers/decoded.h"

namespace gradus::image {
namespace {

std::string text_of(const char* text) { return text ? text : ""; }

// Throws if the size of a tile of raw pixels is out of range or does not match its data.
void check_pixels(const GradusImageTile& tile, size_t bytes_per_pixel, const std::string& name) {
  if (tile.width == 0 || tile.height == 0 || tile.width > kMaxSide || tile.height > kMaxSide ||
      static_cast<uint64_t>(tile.width) * tile.height > kMaxPixels) {
    throw invalid_argument("image " + name + ": impossible size");
  }
  if (tile.data_size != static_cast<size_t>(tile.width) * tile.height * bytes_per_pixel) {
    throw invalid_argument("image " + name + ": data_size does not fit width and height");
  }
}

// Returns a deep copy of a tile. Throws, with the image's name, if the tile is invalid.
ImageSource::Tile copy_tile(const GradusImageTile& tile, const std::string& name) {
  ImageSource::Tile copy;
  copy.number = tile.number;
  copy.source = tile.source;
  copy.width = tile.width;
  copy.height = tile.height;
  copy.path = text_of(tile.path);
  if (tile.source > GRADUS_IMAGE_BYTE) {
    throw invalid_argument("image " + name + ": unknown source");
  }
  if (tile.source == GRADUS_IMAGE_FILE) {
    return copy;
  }
  if (tile.data == nullptr && tile.data_size > 0) {
    throw invalid_argument("image " + name + ": no data");
  }
  if (tile.source == GRADUS_IMAGE_FLOAT || tile.source == GRADUS_IMAGE_BYTE) {
    check_pixels(tile, tile.source == GRADUS_IMAGE_FLOAT ? 16 : 4, name);
  }
  const uint8_t* data = static_cast<const uint8_t*>(tile.data);
  copy.data.assign(data, data + tile.data_size);
  return copy;
}

}  // namespace

ImageSource copy_image_source(const GradusImage& desc) {
  ImageSource source;
  source.name = text_of(desc.name);
  source.color_space = text_of(desc.color_space);
  source.alpha_mode = desc.alpha_mode;
  source.is_float = desc.is_float != 0;
  if (desc.alpha_mode > GRADUS_ALPHA_ALWAYS_STRAIGHT) {
    throw invalid_argument("image " + source.name + ": unknown alpha mode");
  }
  if (desc.tile_count == 0 || desc.tile_count > 10000 || desc.tiles == nullptr) {
    throw invalid_argument("image " + source.name + ": impossible number of tiles");
  }
  for (uint32_t i = 0; i < desc.tile_count; i++) {
    source.tiles.push_back(copy_tile(desc.tiles[i], source.name));
  }
  return source;
}

}  // namespace gradus::image
