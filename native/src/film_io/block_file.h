// A file of OpenEXR with parts of scan lines, written block by block as they come packed: its own writer packs them one
// after the other.
#pragma once

#include <ImfHeader.h>

#include <vector>

#include "film_io/block_codec.h"
#include "film_io/exr_stream.h"

namespace gradus::film_io {

// All parts of ZIP compression and of one size, rows downwards. (OpenEXR, "OpenEXR File Layout": magic number, version,
// headers, where the blocks of each part lie, blocks.)
class BlockFile {
 public:
  // Headers name their parts.
  BlockFile(std::vector<Imf::Header> headers, WriterStream* stream);
  // Any block of any part, each once.
  void write(int part, int block, const Bytes& packed);
  // Where they lie, when all are written.
  void finish();

 private:
  template <class T>
  void put(const T& value) {
    stream_->write(reinterpret_cast<const char*>(&value), sizeof(T));  // little-endian, as the file
  }
  void put_places();

  WriterStream* const stream_;
  int top_;
  uint64_t table_;                             // where it lies
  std::vector<std::vector<uint64_t>> places_;  // by parts and blocks
};

}  // namespace gradus::film_io
