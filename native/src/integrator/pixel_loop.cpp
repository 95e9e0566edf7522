#include "integrator/pixel_loop.h"

#include <algorithm>

namespace gradus {

namespace {

// Whose random numbers a pixel takes.
struct Source {
  StreamKind kind = StreamKind::Pixel;
  int32_t x = 0, y = 0;
  int32_t frame = 0;
};

Source source_of(const PathContext& context, const WorkUnit& unit, const Frame& frame, int32_t x, int32_t y) {
  if (unit.sources == nullptr) return {StreamKind::Pixel, x, y, context.settings.frame};
  const int32_t pixel = unit.sources->pixel[frame.index(x, y)];
  if (pixel == kNoLink) return {StreamKind::Hole, x, y, context.settings.frame};
  const int32_t width = frame.region.width();
  return {StreamKind::Pixel, frame.region.x0 + pixel % width, frame.region.y0 + pixel / width, unit.sources->stream_frame};
}

Sampler make_sampler(const PathContext& context, StreamKind kind, uint32_t stream, int32_t frame, uint32_t number) {
  return Sampler({context.settings.seed, kind, stream, frame, number}, context.settings.independent_sampler != 0);
}

// Jitter of the cell that holds a pixel.
Vec2 jitter_of_cell(const PathContext& context, const Source& source, uint32_t number) {
  const uint32_t column = static_cast<uint32_t>(lattice_cell(source.x)), row = static_cast<uint32_t>(lattice_cell(source.y));
  const Sampler sampler = make_sampler(context, StreamKind::Lattice, (row << 16) ^ (column & 0xffffu), source.frame, number);
  return context.filter.sample(sampler.get2(dimension::kFilm));
}

}  // namespace

uint32_t most_samples(const WorkUnit& unit, const Frame& frame, const Region& cell) {
  if (unit.count_map == nullptr) {
    return unit.count;
  }
  uint32_t most = 0;
  for (int32_t y = cell.y0; y < cell.y1; ++y) {
    for (int32_t x = cell.x0; x < cell.x1; ++x) {
      most = std::max(most, unit_count(unit, frame.index(x, y)));
    }
  }
  return most;
}

bool shares_rays(const PathContext& context, const WorkUnit& unit, const Frame& frame, const Region& cell) {
  if (!shares_jitter(context)) return false;
  for (int32_t y = cell.y0; y < cell.y1 && unit.sources != nullptr; ++y) {
    for (int32_t x = cell.x0; x < cell.x1; ++x) {
      if (unit.sources->pixel[frame.index(x, y)] != static_cast<int32_t>(frame.index(x, y))) return false;
    }
  }
  return true;
}

Vec2 cell_jitter(const PathContext& context, const WorkUnit& unit, const Region& cell, uint32_t number) {
  const int32_t frame = unit.sources != nullptr ? unit.sources->stream_frame : context.settings.frame;
  return jitter_of_cell(context, {StreamKind::Pixel, cell.x0, cell.y0, frame}, number);
}

PixelSample make_pixel_sample(const PathContext& context, const WorkUnit& unit, const Frame& frame, int32_t x, int32_t y, uint32_t number) {
  const Source source = source_of(context, unit, frame, x, y);
  PixelSample sample;
  sample.x = x;
  sample.y = y;
  sample.pixel = frame.index(x, y);
  sample.number = number;
  sample.half = static_cast<int>(number & 1u);
  const uint32_t stream = static_cast<uint32_t>(source.y) * context.settings.width + static_cast<uint32_t>(source.x);
  sample.sampler = make_sampler(context, source.kind, stream, source.frame, number);
  return sample;
}

Vec2 own_jitter(const PathContext& context, const WorkUnit& unit, const Frame& frame, const PixelSample& sample) {
  const Source source = source_of(context, unit, frame, sample.x, sample.y);
  if (shares_jitter(context) && source.kind == StreamKind::Pixel) return jitter_of_cell(context, source, sample.number);
  return context.filter.sample(sample.sampler.get2(dimension::kFilm));
}

void add_primal(const PathResult& result, const PixelSample& sample, Frame* frame, Counters* counters) {
  Radiance value = result.radiance;
  if (frame->channels < 4) {
    value.w = 0.0f;
  }
  add_radiance(value, &frame->components[0].primal[sample.half][sample.pixel], counters);
  ++frame->count[sample.half][sample.pixel];
  if (!frame->fallback.empty() && result.fallback) {
    frame->fallback[sample.pixel] += 1.0f;
  }
}

}  // namespace gradus
