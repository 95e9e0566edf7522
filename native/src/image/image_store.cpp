#include "image/image_store.h"

#include <set>

#include "image/coarser_tile.h"
#include "image/image.h"

namespace gradus::image {
namespace {

// Returns the memory of a tile and of all coarser ones.
size_t chain_bytes(const ImageTile* tile) {
  return tile == nullptr ? 0 : tile->size_bytes() + chain_bytes(tile->coarser.get());
}

}  // namespace

uint32_t ImageStore::add(uint64_t key, std::shared_ptr<const Image> image) {
  const auto [entry, is_new] = index_.try_emplace(key, size());
  if (is_new) {
    images_.push_back(std::move(image));
  } else {
    images_[entry->second] = std::move(image);
  }
  return entry->second;
}

uint32_t ImageStore::index_of(uint64_t key) const {
  const auto found = index_.find(key);
  return found == index_.end() ? kNone : found->second;
}

Rgb ImageStore::mean(uint32_t index) const { return index < size() ? images_[index]->mean : Rgb(1.0f, 0.0f, 1.0f); }

bool ImageStore::has_alpha(uint32_t index) const { return index < size() && images_[index]->has_alpha; }

bool ImageStore::can_be_coarser(uint32_t index) const {
  return index < size() && image::can_be_coarser(*images_[index]);
}

uint32_t ImageStore::width(uint32_t index) const {
  return index < size() && !images_[index]->tiles.empty() ? images_[index]->tiles[0].width : 0;
}

uint32_t ImageStore::height(uint32_t index) const {
  return index < size() && !images_[index]->tiles.empty() ? images_[index]->tiles[0].height : 0;
}

std::vector<std::string> ImageStore::warnings() const {
  std::vector<std::string> all;
  for (const auto& image : images_) {
    all.insert(all.end(), image->warnings.begin(), image->warnings.end());
  }
  return all;
}

size_t ImageStore::memory_bytes() const {
  size_t sum = 0;
  // Several keys may share an image.
  for (const auto& image : std::set(images_.begin(), images_.end())) {
    for (const ImageTile& tile : image->tiles) {
      sum += tile.size_bytes() + chain_bytes(tile.coarser.get());
      if (tile.coarser_straight != tile.coarser) {
        sum += chain_bytes(tile.coarser_straight.get());
      }
    }
  }
  return sum;
}

}  // namespace gradus::image
