#include "path/camera_vertices.h"

#include "shading/material.h"

namespace gradus::path {

void CameraVertices::begin(const Vec2& filter_offset) {
  filter_offset_ = filter_offset;
  ++block_sample_;
}

// Packets always hold the same pixels, whatever part of the pixel block a tile or a border contains, so that hits have
// the same bits.
void CameraVertices::trace(int32_t x, int32_t y, Packet* packet) const {
  Ray rays[kPacketSize];
  geometry::Hit hits[kPacketSize];
  for (int i = 0; i < kPacketSize; ++i) {
    rays[i] = context_.camera.ray({pixel_centre(x + i, y) + filter_offset_});
  }
  context_.scene.intersect4(rays, GRADUS_VISIBLE_CAMERA, hits);
  for (size_t i = 0; i < kPacketSize; ++i) {
    context_.scene.prefetch(hits[i]);
    packet->vertices[i].hit = hits[i];
    packet->vertices[i].ray = camera_path_ray(context_, rays[i]);
  }
  packet->block_sample = block_sample_;
  packet->y = y;
  packet->is_traced.fill(false);
}

// Returns whether all paths see the same at a hit. Whether a ray passes a transparent surface is a random decision of
// each path, and some materials draw random numbers.
bool CameraVertices::is_shareable(const geometry::Hit& hit) const {
  if (!hit.valid()) return true;
  const shading::MaterialData& material = *context_.scene.materials[context_.scene.material_of(hit)];
  return !material.may_be_transparent && !material.draws_random;
}

CameraVertex* CameraVertices::at(int32_t x, int32_t y) {
  const int32_t column = x - film::pixel_block_of(x) * film::kPixelBlockSide;
  const size_t i = static_cast<size_t>(column % kPacketSize);
  Packet& packet = packets_[static_cast<size_t>(y & (kRows - 1))][static_cast<size_t>(column / kPacketSize)];
  if (packet.block_sample != block_sample_ || packet.y != y) {
    trace(x - column % kPacketSize, y, &packet);
  }
  CameraVertex& v = packet.vertices[i];
  if (!packet.is_traced[i]) {
    packet.is_traced[i] = true;
    v.has_emission = false;
    v.is_shared = is_shareable(v.hit);
    if (v.is_shared) {
      // The segment has no random decision, so any sampler will do.
      trace_segment(context_, Sampler(), 0, &v.hit, &v.ray, &v.vertex, &v.segment, Shading::Later);
    }
  }
  return &v;
}

}  // namespace gradus::path
