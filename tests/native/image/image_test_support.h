// One image in a store, from bytes or a path.
#pragma once

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "gradus/gradus_nodes.h"
#include "image/coarser_tile.h"
#include "image/color.h"
#include "image/image_store.h"
#include "support/image_files.h"

namespace gradus::test {

// A material whose emission is an image.
class ImageMaterial {
 public:
  explicit ImageMaterial(uint64_t image) {
    nodes_[0].resource = image;
    desc_.struct_size = sizeof(desc_);
    desc_.nodes = nodes_;
    desc_.node_count = 2;
    desc_.inputs = inputs_;
    desc_.input_count = 3;
    desc_.surface = 1;
    desc_.name = "image";
  }
  ImageMaterial(const ImageMaterial&) = delete;
  const GradusMaterial& desc() const { return desc_; }

 private:
  GradusNode nodes_[2] = {{GRADUS_OP_IMAGE, 0, 0, 1, 0, 0, 0}, {GRADUS_OP_EMISSION, 0, 1, 2, 0, 0, 0}};
  const GradusInput inputs_[3] = {{-1, 0, {}}, {0, 0, {}}, {-1, 0, {1, 1, 1, 1}}};
  GradusMaterial desc_{};
};

struct StoredImage {
  image::ImageStore store;
  uint32_t index = 0;

  Vec4 at(float u, float v, image::Interpolation interpolation = image::Interpolation::Closest,
          image::Extension extension = image::Extension::Repeat) const {
    return store.lookup(index, Vec2(u, v), interpolation, extension);
  }
};

inline StoredImage store_source(const image::ImageSource& source) {
  const image::ColorManager color("", nullptr);
  StoredImage result;
  result.index = result.store.add(7, image::load_image(source, color));
  return result;
}

// Adds the lower resolutions of the image, as a commit does for images that a material averages.
inline StoredImage with_coarser(StoredImage image) {
  image.store.set(image.index, image::with_coarser_tiles(*image.store.image(image.index)));
  return image;
}

inline image::ImageSource encoded_source(const FileBytes& bytes, const std::string& space = "sRGB") {
  image::ImageSource source;
  source.name = "test";
  source.color_space = space;
  source.tiles.resize(1);
  source.tiles[0].source = GRADUS_IMAGE_ENCODED;
  source.tiles[0].data = bytes;
  return source;
}

inline StoredImage store_encoded(const FileBytes& bytes, const std::string& space = "sRGB") {
  return store_source(encoded_source(bytes, space));
}

inline StoredImage store_file(const std::string& path) {
  image::ImageSource source;
  source.name = "test";
  source.color_space = "sRGB";
  source.tiles.resize(1);
  source.tiles[0].path = path;
  return store_source(source);
}

inline std::string write_temporary(const std::string& name, const FileBytes& bytes) {
  const std::string path = (std::filesystem::temp_directory_path() / ("gradus_test_" + name)).string();
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  return path;
}

}  // namespace gradus::test
