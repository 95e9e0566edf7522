// First vertices of the paths of one cell of the lattice, traced once for a base path and for the offsets of its
// neighbours.
//
// All pixels of a cell share the sub-pixel jitter of a sample number (contract 1.6). The camera ray of a pixel's base
// path is then that of its neighbours' offsets, too, where neither lens nor time set them apart; and rays of neighbours
// are traced together.
#pragma once

#include <array>

#include "film/pixel_blocks.h"
#include "path/camera_vertex.h"
#include "path/context.h"

namespace gradus::path {

class CameraVertices {
 public:
  explicit CameraVertices(const PathContext& context) : context_(context) {}

  // A sample number of a cell. filter_offset: from the centres of its pixels.
  void begin(const Vec2& filter_offset);
  // What the camera ray of a pixel of the cell meets. Rows are asked for in ascending order, from one below to one
  // above that of the base: no more are kept.
  CameraVertex* at(int32_t x, int32_t y);

 private:
  static constexpr int kRows = 4;
  static constexpr int kTogether = 4;  // rays of a packet
  // Pixels of a row whose rays are traced together.
  struct Packet {
    uint64_t block_sample = 0;
    int32_t y = 0;
    std::array<bool, kTogether> met{};  // the segment is known, not the hit alone
    std::array<CameraVertex, kTogether> vertices;
  };
  void trace(int32_t x, int32_t y, Packet* packet) const;
  bool passes(const geometry::Hit& hit) const;

  const PathContext& context_;
  uint64_t block_sample_ = 0;
  Vec2 filter_offset_ = Vec2(0.0f);
  std::array<std::array<Packet, film::kPixelBlockSide / kTogether>, kRows> packets_;
};

}  // namespace gradus::path
