// A scan-line file of OpenEXR, written block by block as they come packed: its own writer packs them one after the other.
#pragma once

#include <ImfHeader.h>

#include <vector>

#include "frame/block_codec.h"
#include "frame/exr_stream.h"

namespace gradus {

// Of ZIP compression, rows downwards. (OpenEXR, "OpenEXR File Layout": magic number, version, header, where the blocks lie, blocks.)
class BlockFile {
 public:
  BlockFile(const Imf::Header& header, WriterStream* stream);
  // The next one.
  void write(const Bytes& packed);
  // Where they lie, when all are written.
  void finish();

 private:
  template <class T>
  void put(const T& value) {
    stream_->write(reinterpret_cast<const char*>(&value), sizeof(T));  // little-endian, as the file
  }

  WriterStream* const stream_;
  int row_;
  uint64_t table_;  // where it lies
  std::vector<uint64_t> places_;
};

}  // namespace gradus
