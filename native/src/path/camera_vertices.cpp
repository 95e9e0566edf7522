#include "path/camera_vertices.h"

#include "shading/material.h"

namespace gradus::path {

void CameraVertices::begin(const Vec2& filter_offset) {
  filter_offset_ = filter_offset;
  ++block_sample_;
}

// Always the same rays together, wherever a tile or a border cuts the cell, so that hits have the same bits.
void CameraVertices::trace(int32_t x, int32_t y, Packet* packet) const {
  Ray rays[kTogether];
  geometry::Hit hits[kTogether];
  for (int i = 0; i < kTogether; ++i) {
    rays[i] = context_.camera.ray({pixel_centre(x + i, y) + filter_offset_});
  }
  context_.scene.intersect4(rays, GRADUS_VISIBLE_CAMERA, hits);
  for (size_t i = 0; i < kTogether; ++i) {
    context_.scene.prefetch(hits[i]);
    packet->vertices[i].hit = hits[i];
    packet->vertices[i].ray = PathRay{};
    packet->vertices[i].ray.ray = rays[i];
  }
  packet->block_sample = block_sample_;
  packet->y = y;
  packet->met.fill(false);
}

// Whether a ray may go on behind its nearest hit, which each path decides for itself.
bool CameraVertices::passes(const geometry::Hit& hit) const {
  return hit.valid() &&
         context_.scene.materials[context_.scene.material_of(hit)]->may_be_transparent;
}

CameraVertex* CameraVertices::at(int32_t x, int32_t y) {
  const int32_t column = x - film::pixel_block_of(x) * film::kPixelBlockSide;
  const size_t i = static_cast<size_t>(column % kTogether);
  Packet& packet = packets_[static_cast<size_t>(y & (kRows - 1))][static_cast<size_t>(column / kTogether)];
  if (packet.block_sample != block_sample_ || packet.y != y) {
    trace(x - column % kTogether, y, &packet);
  }
  CameraVertex& v = packet.vertices[i];
  if (!packet.met[i]) {
    packet.met[i] = true;
    v.looked = false;
    v.shared = !passes(v.hit);
    if (v.shared) {
      trace_segment(context_, Sampler(), 0, &v.hit, &v.ray, &v.vertex, &v.segment,
                    Shading::Later);  // nothing random is met
    }
  }
  return &v;
}

}  // namespace gradus::path
