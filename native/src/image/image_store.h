// The images of a snapshot. Each is loaded once, and shared by all materials and by later snapshots.
//
//   ImageSource source = copy_image_source(desc);       // at gradus_scene_set_image: deep copy
//   auto image = load_image(source, color);             // at commit, in any thread, several at once
//   store.add(key, image);
//
// u runs to the right, v up: v = 0 is the bottom edge, whatever the order of rows in a file.
#pragma once

#include <compare>
#include <cstdint>
#include <memory>
#include <string>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "base/types.h"
#include "gradus/gradus.h"

namespace gradus::image {

class ColorManager;
class Image;  // image/image.h: pixels of one image, immutable

enum class Interpolation : uint8_t { Linear = 0, Closest = 1, Cubic = 2 };  // Blender's Smart is Cubic
enum class Extension : uint8_t { Repeat = 0, Extend = 1, Clip = 2, Mirror = 3 };

// A deep copy of a GradusImage.
struct ImageSource {
  struct Tile {
    uint32_t number = 0;  // UDIM number; 0 if the image is not tiled
    uint32_t source = GRADUS_IMAGE_FILE;
    uint32_t width = 0;
    uint32_t height = 0;
    std::string path;
    std::vector<uint8_t> data;
    auto operator<=>(const Tile&) const = default;
  };
  uint32_t alpha_mode = GRADUS_ALPHA_STRAIGHT;
  bool is_float = false;
  std::string color_space;
  std::string name;
  std::vector<Tile> tiles;
  // Returns all that the pixels depend on, to be compared: all but the name.
  auto content() const { return std::tie(alpha_mode, is_float, color_space, tiles); }
};
// Copies an image. Throws Error(INVALID_ARGUMENT), with the image's name, if sizes and data contradict each other.
ImageSource copy_image_source(const GradusImage& desc);

// Decodes all tiles. A tile that cannot be read is magenta, and ImageStore::warnings() has the reason. Throws only
// std::bad_alloc.
std::shared_ptr<const Image> load_image(const ImageSource& source, const ColorManager& color);

// Returns a copy of an image whose tiles are scene-linear floats if its colour space is one that only `color` can
// convert, neither data nor sRGB. A tile that cannot be read stays as it is.
ImageSource scene_linear_source(const ImageSource& source, const ColorManager& color);

class ImageStore {
 public:
  static constexpr uint32_t kNone = UINT32_MAX;

  // Adds an image and returns its index for look-ups. An image with the same key is replaced and keeps its index.
  uint32_t add(uint64_t key, std::shared_ptr<const Image> image);
  // Returns the index of a key, or kNone if the key is unknown.
  uint32_t index_of(uint64_t key) const;
  uint32_t size() const { return static_cast<uint32_t>(images_.size()); }
  const std::shared_ptr<const Image>& image(uint32_t index) const { return images_[index]; }

  // Returns scene-linear RGBA as Cycles' image node does. Colours are multiplied by alpha, except for the alpha modes
  // CHANNEL_PACKED and NONE; `unassociate` divides by it, which Cycles does if the node's Alpha output is used. The
  // result is 0 outside a clipped image, but for the alpha of files with one channel, which is 1; and magenta for
  // absent UDIM tiles and for kNone. Any uv is allowed; one that is not finite counts as 0. `extent` is the length in
  // uv that the result may be a mean of, if the image has lower resolutions (image/coarser_tile.h); 0 is full
  // resolution, as are Closest, which shows the texels themselves, and Cubic, whose mean is another one if values are
  // encoded.
  Vec4 lookup(uint32_t index, const Vec2& uv, Interpolation interpolation, Extension extension,
              bool unassociate = false, float extent = 0.0f) const;
  // Returns the scene-linear mean colour of the image.
  Rgb mean(uint32_t index) const;
  // Returns whether some texel has an alpha below 1.
  bool has_alpha(uint32_t index) const;
  // Returns whether the image is large enough for look-ups at a lower resolution.
  bool can_be_coarser(uint32_t index) const;
  // Replaces an image.
  void set(uint32_t index, std::shared_ptr<const Image> image) { images_[index] = std::move(image); }
  // Return the size of the image's first tile, or 0 if it could not be read.
  uint32_t width(uint32_t index) const;
  uint32_t height(uint32_t index) const;
  // Returns the warnings of all images: a text with the path for each tile that could not be read completely. The
  // option `strict` turns them into an error.
  std::vector<std::string> warnings() const;
  size_t memory_bytes() const;

 private:
  std::vector<std::shared_ptr<const Image>> images_;
  std::unordered_map<uint64_t, uint32_t> index_;
};

}  // namespace gradus::image
