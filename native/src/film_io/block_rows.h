// The rows of a film in the order of the file: blocks of sixteen from the top down, in each row one channel after the
// other, sorted by name.
#pragma once

#include <vector>

#include "film_io/block_codec.h"
#include "film_io/store_planes.h"

namespace gradus::film_io {

class BlockRows {
 public:
  BlockRows(std::vector<StoredPlane> planes, int width, int height);
  int blocks() const { return (height_ + kBlockRows - 1) / kBlockRows; }
  size_t bytes(int block) const { return size_t(rows(block)) * planes_.size() * row_bytes_; }
  size_t max_bytes() const { return size_t{kBlockRows} * planes_.size() * row_bytes_; }  // maximum size of a block
  // Copy the planes to the bytes of a block and back. `bytes` has bytes(block) elements.
  void gather(int block, Bytes* bytes) const;
  void scatter(const Bytes& bytes, int block) const;

 private:
  int rows(int block) const;
  // Returns the start of row `row` of the file in the plane.
  unsigned char* row_of(const StoredPlane& plane, int row) const;
  template <class Function>
  void for_each_row(int block, const Function& function) const;

  std::vector<StoredPlane> planes_;
  const int width_, height_;
  const size_t row_bytes_;
};

}  // namespace gradus::film_io
