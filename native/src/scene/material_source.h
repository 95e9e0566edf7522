// Owning copy of a GradusMaterial. The commit compiles it, because only then its images are known.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "gradus/gradus.h"

namespace gradus::scene {

class MaterialSource {
 public:
  // Throws Error INVALID_ARGUMENT, with the material's name, if arrays are missing or the ranges of a node exceed them.
  explicit MaterialSource(const GradusMaterial& desc);
  MaterialSource(const MaterialSource&) = delete;
  MaterialSource& operator=(const MaterialSource&) = delete;
  // Returns a description with pointers to this object, which must outlive their use.
  GradusMaterial view() const;
  uint64_t content_hash() const { return content_hash_; }
  // Returns the content hash with the hashes of the images instead of their keys.
  uint64_t hash_with(const std::function<uint64_t(uint64_t key)>& image) const;
  // Returns whether the compiled material depends on images.
  bool depends_on_images() const;
  const std::string& name() const { return name_; }

 private:
  GradusMaterial desc_{};
  std::vector<GradusNode> nodes_;
  std::vector<GradusInput> inputs_;
  std::vector<float> floats_;
  std::vector<std::string> names_;
  std::vector<const char*> name_pointers_;
  std::string name_;
  uint64_t content_hash_ = 0;
};

}  // namespace gradus::scene
