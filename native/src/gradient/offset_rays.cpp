#include "gradient/offset_rays.h"

#include <algorithm>

#include "base/fault.h"

namespace gradus::gradient {

namespace {

// Returns the camera vertex of the pixel of offset k, or null if it is not known. In the base's pixel block, an
// offset's camera ray equals that of the base path of its own pixel.
path::CameraVertex* find_camera_vertex(const integrator::PixelSample& sample, int k, path::CameraVertices* vertices) {
  const int32_t x = sample.x + film::kOffsetX[k], y = sample.y + film::kOffsetY[k];
  const bool same_block = film::pixel_block_of(x) == film::pixel_block_of(sample.x) &&
                          film::pixel_block_of(y) == film::pixel_block_of(sample.y);
  return sample.first != nullptr && same_block ? vertices->at(x, y) : nullptr;
}

void use_camera_vertex(path::CameraVertex* v, OffsetPath* offset) {
  offset->vertex = &v->vertex;
  offset->segment = &v->segment;
  offset->camera_vertex = v;
  offset->state.ray = v->ray;
  offset->has_own_segment = true;
}

}  // namespace

geometry::Points4 offset_points(const OffsetPaths& offsets, float time) {
  return geometry::gather(offsets[0].vertex->point, offsets[1].vertex->point, offsets[2].vertex->point,
                          offsets[3].vertex->point, time);
}

// With a lens the four rays are traced together. Without one most rays are known, and a packet for the one that leaves
// the pixel block would take as long as three single rays.
void trace_camera_rays(const BasePath& base, const integrator::PixelSample& sample, path::CameraVertices* vertices,
                       OffsetPaths* offsets, film::Counters* counters) {
  const uint32_t visibility = base.state.ray.visibility;
  Ray rays[film::kOffsets];
  geometry::Hit hits[film::kOffsets];
  bool unknown[film::kOffsets];
  bool any = false;
  for (int k = 0; k < film::kOffsets; ++k) {
    OffsetPath& o = (*offsets)[k];
    rays[k] = kNoRay;
    unknown[k] = false;
    if (o.stage != OffsetStage::Coupled) {
      continue;
    }
    path::CameraVertex* known = find_camera_vertex(sample, k, vertices);
    if (known != nullptr && known->is_shared) {
      use_camera_vertex(known, &o);
      continue;
    }
    camera::CameraSample moved = base.camera_sample.moved(Vec2(film::kOffsetX[k], film::kOffsetY[k]));
    if (GRADUS_FAULT(offset_rays_lose_time)) moved.time = 0.0f;
    if (GRADUS_FAULT(offset_rays_lose_lens)) moved.lens = Vec2(0.0f);
    o.state.ray = path::camera_path_ray(base.context, base.context.camera.ray(moved));
    o.state.ray.visibility = visibility;
    o.state.ray.state.random = base.state.ray.state.random;
    if (sample.first != nullptr) {
      trace_own_segment(base, known != nullptr ? &known->hit : nullptr, &o, counters);
    } else {
      rays[k] = o.state.ray.ray;
      any = unknown[k] = true;
    }
  }
  if (any) {
    base.context.scene.intersect4(rays, visibility, hits);
  }
  for (int k = 0; k < film::kOffsets; ++k) {
    if (unknown[k]) {
      trace_own_segment(base, &hits[k], &(*offsets)[k], counters);
    }
  }
}

// The new ray has the ray state of the base's, except for the counts of transparent surfaces and portals and the blur.
void leave_by_event(const BasePath& base, const ShiftedEvent& event, bool is_dirac, OffsetPath* offset) {
  path::PathState& state = offset->state;
  const shading::RayState before = state.ray.state;
  const path::Vertex& y = *offset->vertex;
  const float blur = is_dirac ? 0.0f : base.context.filter_glossy.blur_behind(y.shade.closures, y.wo, event.wi);
  state.ray = base.state.ray;
  state.ray.state.transparent_depth = before.transparent_depth;
  state.ray.state.portal_depth = before.portal_depth;
  state.ray.state.blur = std::max(before.blur, blur);
  state.ray.state.guided_ratio = before.guided_ratio * guided_ratio(base.event, y, event.wi);
  state.ray.ray = path::spawn_ray(offset->vertex->point, event.wi);
  state.depth = base.state.depth;
  state.lpe_state = base.state.lpe_state;
  state.throughput *= event.factor;
  offset->ratio *= event.ratio;
  offset->kind_ratio = event.kind_ratio;
  offset->event.pdf = event.pdf;
  offset->event.sample.dirac = is_dirac;
  offset->is_from_camera = false;
}

void trace_own_segment(const BasePath& base, const geometry::Hit* first, OffsetPath* offset, film::Counters* counters) {
  offset->advance();
  offset->has_own_segment = true;
  if (path::shows_only_lights(base.context, base.state)) {
    counters->rays_shift += path::trace_to_lights(base.context, offset->state.ray, &offset->own_segment) ? 1 : 0;
    return;
  }
  ++counters->rays_shift;
  path::trace_segment(base.context, *base.sampler, base.state.depth, first, &offset->state.ray, offset->vertex,
                      &offset->own_segment, path::Shading::Later);
}

ShiftFailure trace_to_own_vertex(const BasePath& base, const ShiftedEvent& event, OffsetPath* offset,
                                 film::Counters* counters) {
  ++counters->shifts_replayed;  // counts attempts
  if (event.failure != ShiftFailure::None) {
    return event.failure;
  }
  ++counters->rays_shift;
  leave_by_event(base, event, false, offset);
  offset->advance();
  path::trace_segment(base.context, *base.sampler, base.state.depth, nullptr, &offset->state.ray, offset->vertex,
                      &offset->own_segment);
  if (offset->segment->end != path::SegmentEnd::Surface) {
    return ShiftFailure::Missed;
  }
  if (offset->segment->passes_portal) {
    return ShiftFailure::Class;  // pending offsets of a base that passes a portal fail, too
  }
  if (path::is_at_transparent_limit(base.context, offset->state.ray.state)) {
    return ShiftFailure::Occluded;
  }
  offset->state.throughput *= offset->segment->weight;
  return ShiftFailure::None;
}

}  // namespace gradus::gradient
