// First vertices of the paths of one pixel block, traced once for a base path and for the offset paths of its
// neighbours.
//
// All pixels of a block share the sub-pixel jitter of a sample number. So the camera ray of a pixel's base path equals
// that of its neighbours' offset paths, unless points on the lens or times differ. Rays of adjacent pixels are traced
// in packets.
#pragma once

#include <array>

#include "film/pixel_blocks.h"
#include "path/context.h"
#include "path/segment.h"

namespace gradus::path {

// The nearest hit of a camera ray and, if it is shared, the segment up to the first vertex.
struct CameraVertex {
  geometry::Hit hit;
  // Neither the segment nor its end has a random decision, so they are the same for every path with this camera ray.
  // The members below are set only if this is true.
  bool is_shared = false;
  PathRay ray;  // ray on arrival at the vertex
  Segment segment;
  Vertex vertex;  // its closures may be missing
  // Emission that the segment shows, with alpha as in PathResult minus 1; computed for the first offset that needs it.
  bool has_emission = false;
  Radiance emission = Radiance(0.0f);
};

class CameraVertices {
 public:
  explicit CameraVertices(const PathContext& context) : context_(context) {}

  // Starts a sample number of a pixel block. `filter_offset` is the distance of its film positions from the pixel
  // centres.
  void begin(const Vec2& filter_offset);
  // Returns the camera vertex of a pixel of the block. Only the rows next to the latest base pixel are kept, so rows
  // must be visited in ascending order.
  CameraVertex* at(int32_t x, int32_t y);

 private:
  static constexpr int kRows = 4;
  static constexpr int kPacketSize = 4;
  // Adjacent pixels of a row whose rays are traced together.
  struct Packet {
    uint64_t block_sample = 0;
    int32_t y = 0;
    std::array<bool, kPacketSize> is_traced{};  // everything behind CameraVertex::hit is set, too
    std::array<CameraVertex, kPacketSize> vertices;
  };
  void trace(int32_t x, int32_t y, Packet* packet) const;
  bool is_shareable(const geometry::Hit& hit) const;

  const PathContext& context_;
  uint64_t block_sample_ = 0;
  Vec2 filter_offset_ = Vec2(0.0f);
  std::array<std::array<Packet, film::kPixelBlockSide / kPacketSize>, kRows> packets_;
};

}  // namespace gradus::path
