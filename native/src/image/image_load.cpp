// Decodes all tiles of an image and converts them for look-ups.
#include <string>
#include <utility>
#include <vector>

#include "base/hash.h"
#include "image/color.h"
#include "image/image.h"
#include "image/image_convert.h"
#include "image/image_file.h"
#include "image/image_store.h"

namespace gradus::image {
namespace {

// The colour of an image that cannot be read: magenta, as in Cycles.
constexpr Rgb kMissingColor(1.0f, 0.0f, 1.0f);

// Copies pixels that the caller passed as float or byte RGBA with the bottom row first. Returns false, with the reason
// in *problem, if they cannot be stored.
bool wrap_pixels(const ImageSource::Tile& tile, DecodedImage* image, std::string* problem) {
  const PixelFormat format = tile.source == GRADUS_IMAGE_FLOAT ? PixelFormat::Float : PixelFormat::Byte;
  if (!allocate(image, tile.width, tile.height, 4, format, tile.data.size(), 1, problem)) {
    return false;
  }
  std::copy(tile.data.begin(), tile.data.end(), image->pixels.get());
  return true;
}

// Decodes a tile from pixels, from an encoded file in memory, or from a file on disk, and adds its content to the hash.
// Returns false, with the reason in *problem, if it cannot be read.
bool decode_tile(const ImageSource::Tile& tile, DecodedImage* image, std::string* problem, ContentHash* hash) {
  for (const uint32_t v : {tile.number, tile.width, tile.height}) hash->value(v);
  hash->array(tile.data);
  if (tile.source == GRADUS_IMAGE_FLOAT || tile.source == GRADUS_IMAGE_BYTE) {
    return wrap_pixels(tile, image, problem);
  }
  if (tile.source == GRADUS_IMAGE_ENCODED) {
    return read_image(tile.data, image, problem);
  }
  std::vector<uint8_t> bytes;
  const bool is_read = read_file(tile.path, &bytes, problem);
  hash->array(bytes);
  return is_read && read_image(bytes, image, problem);
}

// Returns how the colours of a decoded tile relate to its alpha, by the alpha mode of the image and the file itself.
AlphaRelation alpha_relation(const ImageSource& source, const DecodedImage& decoded) {
  switch (source.alpha_mode) {
    case GRADUS_ALPHA_CHANNEL_PACKED:
    case GRADUS_ALPHA_NONE:
      return AlphaRelation::None;
    case GRADUS_ALPHA_ALWAYS_STRAIGHT:
      return AlphaRelation::Straight;
    case GRADUS_ALPHA_STRAIGHT:
      return decoded.associated_alpha ? AlphaRelation::Associated : AlphaRelation::Straight;
    default:
      return AlphaRelation::Associated;
  }
}

// Converts a decoded tile for look-ups.
ImageTile convert(const ImageSource& source, DecodedImage decoded, const ColorManager& color) {
  const AlphaRelation relation = alpha_relation(source, decoded);
  return convert_tile(std::move(decoded), color, source.color_space, source.is_float, relation);
}

// Returns the values of a tile as floats of red, green, blue and alpha.
std::vector<uint8_t> float_pixels(const ImageTile& tile) {
  std::vector<uint8_t> bytes;
  bytes.reserve(size_t{tile.width} * tile.height * sizeof(Vec4));
  for (uint32_t y = 0; y < tile.height; y++) {
    for (uint32_t x = 0; x < tile.width; x++) {
      const Vec4 v = tile.texel(x, y);
      const uint8_t* first = reinterpret_cast<const uint8_t*>(&v);
      bytes.insert(bytes.end(), first, first + sizeof(v));
    }
  }
  return bytes;
}

// Returns the text of a warning, which names the image and the file.
std::string describe(const ImageSource& source, const ImageSource::Tile& tile, const std::string& problem) {
  const std::string where = tile.path.empty() ? "(packed)" : tile.path;
  return "image " + source.name + ": " + where + ": " + problem;
}

}  // namespace

std::shared_ptr<const Image> load_image(const ImageSource& source, const ColorManager& color) {
  auto image = std::make_shared<Image>();
  image->name = source.name;
  image->ignores_alpha = source.alpha_mode == GRADUS_ALPHA_NONE;
  image->associates_alpha = source.alpha_mode != GRADUS_ALPHA_CHANNEL_PACKED && !image->ignores_alpha;
  ContentHash hash;
  hash.value(source.color_space);
  for (const uint32_t v : {source.alpha_mode, uint32_t(source.is_float)}) hash.value(v);
  if (const uint64_t conversion = color.fingerprint(source.color_space, !source.is_float)) hash.value(conversion);
  Rgb sum(0.0f);
  for (const ImageSource::Tile& tile : source.tiles) {
    DecodedImage decoded;
    std::string problem;
    ImageTile stored;
    Rgb mean = kMissingColor;
    if (decode_tile(tile, &decoded, &problem, &hash)) {
      problem = decoded.warning;
      stored = convert(source, std::move(decoded), color);
      // Cycles keeps one channel of such files, and clips colours only. Packed files have four channels in Blender.
      stored.is_opaque_outside = tile.source == GRADUS_IMAGE_FILE && stored.channels == 1;
      mean = mean_color(stored);
      image->has_alpha = image->has_alpha || (!image->ignores_alpha && has_transparency(stored));
    } else {
      problem += ", which shows as pink, as in Cycles";
    }
    if (!problem.empty()) {
      image->warnings.push_back(describe(source, tile, problem));
    }
    stored.number = tile.number;
    image->tiles.push_back(std::move(stored));
    sum += mean;
  }
  image->mean = image->tiles.empty() ? kMissingColor : sum / static_cast<float>(image->tiles.size());
  image->content_hash = hash.result();
  return image;
}

ImageSource scene_linear_source(const ImageSource& source, const ColorManager& color) {
  ImageSource linear = source;
  if (color.transform(source.color_space, !source.is_float) != ColorTransform::Other) return linear;
  for (ImageSource::Tile& tile : linear.tiles) {
    DecodedImage decoded;
    std::string problem;
    ContentHash unused;
    if (!decode_tile(tile, &decoded, &problem, &unused)) continue;
    const ImageTile converted = convert(source, std::move(decoded), color);
    tile.source = GRADUS_IMAGE_FLOAT;
    tile.width = converted.width;
    tile.height = converted.height;
    tile.data = float_pixels(converted);
  }
  linear.color_space.clear();
  linear.is_float = true;
  const bool uses_alpha = source.alpha_mode != GRADUS_ALPHA_CHANNEL_PACKED && source.alpha_mode != GRADUS_ALPHA_NONE;
  if (uses_alpha) linear.alpha_mode = GRADUS_ALPHA_PREMULTIPLIED;
  return linear;
}

}  // namespace gradus::image
