// Writes an OpenEXR file with scan-line parts from packed blocks. OpenEXR's own writer packs one block after the other.
#pragma once

#include <vector>

#include <ImfHeader.h>

#include "film_io/block_codec.h"
#include "film_io/exr_stream.h"

namespace gradus::film_io {

// All parts have ZIP compression, one size and rows from the top down. (OpenEXR, "OpenEXR File Layout": magic number,
// version, headers, offset tables of the blocks of each part, blocks.)
class BlockFile {
 public:
  // Writes the headers, which contain the names of the parts.
  BlockFile(std::vector<Imf::Header> headers, WriterStream* stream);
  // Writes a block. Blocks may come in any order, each once.
  void write(int part, int block, const Bytes& packed);
  // Writes the offset tables after all blocks.
  void finish();

 private:
  template <class T>
  void put(const T& value) {
    stream_->write(reinterpret_cast<const char*>(&value), sizeof(T));  // little-endian, as the file
  }
  void put_places();

  WriterStream* const stream_;
  int top_;
  uint64_t table_;                             // position of the offset tables
  std::vector<std::vector<uint64_t>> places_;  // offsets by part and block
};

}  // namespace gradus::film_io
