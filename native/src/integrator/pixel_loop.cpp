#include "integrator/pixel_loop.h"

#include <algorithm>

namespace gradus {

namespace {

// Whose random numbers a pixel takes.
struct Source {
  StreamKind kind = StreamKind::Pixel;
  int32_t x = 0, y = 0;
  int32_t frame = 0;
  uint32_t seed = 0;
  bool shares_jitter = false;  // with its cell
};

// A pixel's of the frame itself, or of the one that it replays.
Source numbers_of(const PathContext& context, const WorkUnit& unit, int32_t x, int32_t y) {
  const SampleSources* replayed = unit.sources;
  if (replayed != nullptr) return {StreamKind::Pixel, x, y, replayed->stream_frame, replayed->seed, replayed->shares_jitter};
  return {StreamKind::Pixel, x, y, context.settings.frame, context.settings.seed, shares_jitter(context.camera, context.scene)};
}

Source source_of(const PathContext& context, const WorkUnit& unit, const Frame& frame, int32_t x, int32_t y) {
  if (unit.sources == nullptr) return numbers_of(context, unit, x, y);
  const int32_t pixel = unit.sources->links.pixel[frame.index(x, y)];
  if (pixel == kNoLink) return {StreamKind::Hole, x, y, context.settings.frame, context.settings.seed};
  const int32_t width = frame.region.width();
  return numbers_of(context, unit, frame.region.x0 + pixel % width, frame.region.y0 + pixel / width);
}

Sampler make_sampler(const PathContext& context, const Source& source, StreamKind kind, uint32_t stream, uint32_t number) {
  return Sampler({source.seed, kind, stream, source.frame, number}, context.settings.independent_sampler != 0);
}

// Jitter of the cell that holds a pixel.
Vec2 jitter_of_cell(const PathContext& context, const Source& source, uint32_t number) {
  const uint32_t column = static_cast<uint32_t>(lattice_cell(source.x)), row = static_cast<uint32_t>(lattice_cell(source.y));
  const Sampler sampler = make_sampler(context, source, StreamKind::Lattice, (row << 16) ^ (column & 0xffffu), number);
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
  if (!shares_jitter(context.camera, context.scene) || (unit.sources != nullptr && !unit.sources->shares_jitter)) return false;
  for (int32_t y = cell.y0; y < cell.y1 && unit.sources != nullptr; ++y) {
    for (int32_t x = cell.x0; x < cell.x1; ++x) {
      if (unit.sources->links.pixel[frame.index(x, y)] != static_cast<int32_t>(frame.index(x, y))) return false;
    }
  }
  return true;
}

Vec2 cell_jitter(const PathContext& context, const WorkUnit& unit, const Region& cell, uint32_t number) {
  return jitter_of_cell(context, numbers_of(context, unit, cell.x0, cell.y0), number);
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
  sample.sampler = make_sampler(context, source, source.kind, stream, number);
  return sample;
}

Vec2 own_jitter(const PathContext& context, const WorkUnit& unit, const Frame& frame, const PixelSample& sample) {
  const Source source = source_of(context, unit, frame, sample.x, sample.y);
  if (source.shares_jitter) return jitter_of_cell(context, source, sample.number);
  return context.filter.sample(sample.sampler.get2(dimension::kFilm));
}

void add_primal(const PathResult& result, const PixelSample& sample, const WorkUnit& unit, Frame* frame, Counters* counters) {
  const uint32_t wanted = unit_components(unit, sample.pixel);
  for (size_t c = 0; c < frame->components.size(); ++c) {
    Radiance value = result.radiance[c];
    if (frame->channels < 4) {
      value.w = 0.0f;
    }
    if (value != Radiance(0.0f) && (wanted >> c & 1) != 0) {
      add_radiance(value, &frame->components[c].primal[sample.half][sample.pixel], counters);
    }
  }
  if (unit.again) return;
  ++frame->count[sample.half][sample.pixel];
  if (!frame->fallback.empty() && result.fallback) {
    frame->fallback[sample.pixel] += 1.0f;
  }
}

}  // namespace gradus
