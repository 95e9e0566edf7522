#include "film_io/block_rows.h"

#include <algorithm>
#include <cstring>

namespace gradus::film_io {
namespace {

constexpr size_t kValue = sizeof(uint32_t);

// Copies 32-bit values. The steps between neighbouring values are in bytes.
void copy_values(const unsigned char* from, size_t from_step, unsigned char* to, size_t to_step, size_t count) {
  for (size_t i = 0; i < count; ++i) std::memcpy(to + to_step * i, from + from_step * i, kValue);
}

}  // namespace

BlockRows::BlockRows(std::vector<StoredPlane> planes, int width, int height)
    : planes_(std::move(planes)), width_(width), height_(height), row_bytes_(kValue * size_t(width)) {
  std::sort(planes_.begin(), planes_.end(), [](const StoredPlane& a, const StoredPlane& b) { return a.name < b.name; });
}

int BlockRows::rows(int block) const { return std::min(kBlockRows, height_ - kBlockRows * block); }

unsigned char* BlockRows::row_of(const StoredPlane& plane, int row) const {
  return plane.data + size_t(height_ - 1 - row) * size_t(width_) * plane.stride;
}

// Calls function(plane, row, offset) for each row of the block: the start of the row in the plane, and its offset in
// the bytes of the block.
template <class Function>
void BlockRows::for_each_row(int block, const Function& function) const {
  size_t place = 0;
  for (int row = kBlockRows * block; row < kBlockRows * block + rows(block); ++row) {
    for (const StoredPlane& plane : planes_) {
      function(plane, row_of(plane, row), place);
      place += row_bytes_;
    }
  }
}

void BlockRows::gather(int block, Bytes* bytes) const {
  for_each_row(block, [&](const StoredPlane& plane, const unsigned char* from, size_t place) {
    copy_values(from, plane.stride, bytes->data() + place, kValue, size_t(width_));
  });
}

void BlockRows::scatter(const Bytes& bytes, int block) const {
  for_each_row(block, [&](const StoredPlane& plane, unsigned char* to, size_t place) {
    copy_values(bytes.data() + place, kValue, to, plane.stride, size_t(width_));
  });
}

}  // namespace gradus::film_io
