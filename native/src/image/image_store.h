// Images of a snapshot: loaded once each, shared by all materials and by later snapshots.
//
//   ImageSource source = copy_image_source(desc);       // at gradus_scene_set_image: deep copy
//   auto image = load_image(source, color);             // at commit, in any thread, several at once
//   store.add(key, image);
//
// u runs to the right, v up: v = 0 is the bottom edge, whatever the order of rows in a file.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "base/types.h"
#include "gradus/gradus.h"

namespace gradus::image {

class ColorManager;
class Image;  // image/image.h: pixels of one image, immutable

enum class Interpolation : uint8_t { Linear = 0, Closest = 1, Cubic = 2 };  // Blender's Smart is Cubic
enum class Extension : uint8_t { Repeat = 0, Extend = 1, Clip = 2, Mirror = 3 };

// Owning copy of a GradusImage.
struct ImageSource {
  struct Tile {
    uint32_t number = 0;  // UDIM; 0 = not tiled
    uint32_t source = GRADUS_IMAGE_FILE;
    uint32_t width = 0;
    uint32_t height = 0;
    std::string path;
    std::vector<uint8_t> data;
  };
  uint32_t alpha_mode = GRADUS_ALPHA_STRAIGHT;
  bool is_float = false;
  std::string color_space;
  std::string name;
  std::vector<Tile> tiles;
};
// Throws Error(INVALID_ARGUMENT), with the image's name, where sizes and data contradict each other.
ImageSource copy_image_source(const GradusImage& desc);

// Decodes all tiles. What cannot be read becomes magenta and is told by warnings_of(); throws nothing but
// std::bad_alloc.
std::shared_ptr<const Image> load_image(const ImageSource& source, const ColorManager& color);
// One text per tile that could not be read (fully), naming the path.
const std::vector<std::string>& warnings_of(const Image& image);

class ImageStore {
 public:
  static constexpr uint32_t kNone = UINT32_MAX;

  // Index by which look-ups name the image. The same key again: replaces, keeps the index.
  uint32_t add(uint64_t key, std::shared_ptr<const Image> image);
  // kNone for unknown keys.
  uint32_t index_of(uint64_t key) const;
  uint32_t size() const { return static_cast<uint32_t>(images_.size()); }
  const std::shared_ptr<const Image>& image(uint32_t index) const { return images_[index]; }

  // Scene-linear RGBA as Cycles' image node gives it: alpha is associated (but for CHANNEL_PACKED and NONE);
  // `unassociate` divides by it, which Cycles does where the node's Alpha output is used. Outside a clipped image, and
  // in absent UDIM tiles: 0 or magenta as in Cycles. kNone: magenta. Any uv, non-finite ones give the texel at 0.
  Vec4 lookup(uint32_t index, const Vec2& uv, Interpolation interpolation, Extension extension,
              bool unassociate = false) const;
  // Mean colour of all texels, scene-linear.
  Rgb mean(uint32_t index) const;
  // Some texel has alpha below 1.
  bool has_alpha(uint32_t index) const;
  // Size of the (first tile of the) image; 0 if it could not be read.
  uint32_t width(uint32_t index) const;
  uint32_t height(uint32_t index) const;
  // Warnings of all images; what `strict` turns into an error.
  std::vector<std::string> warnings() const;
  size_t memory_bytes() const;

 private:
  std::vector<std::shared_ptr<const Image>> images_;
  std::unordered_map<uint64_t, uint32_t> index_;
};

}  // namespace gradus::image
