#include "integrator/pixel_loop.h"

#include <algorithm>

namespace gradus {

namespace {

SampleKey sample_key(const PathContext& context, StreamKind kind, uint32_t stream, uint32_t number) {
  SampleKey key;
  key.seed = context.settings.seed;
  key.kind = kind;
  key.stream = stream;
  key.stream_frame = context.settings.frame;
  key.index = number;
  return key;
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

Vec2 cell_jitter(const PathContext& context, const Region& cell, uint32_t number) {
  const uint32_t column = static_cast<uint32_t>(lattice_cell(cell.x0)), row = static_cast<uint32_t>(lattice_cell(cell.y0));
  const SampleKey key = sample_key(context, StreamKind::Lattice, (row << 16) ^ (column & 0xffffu), number);
  return context.filter.sample(Sampler(key, context.settings.independent_sampler != 0).get2(dimension::kFilm));
}

PixelSample make_pixel_sample(const PathContext& context, const Frame& frame, int32_t x, int32_t y, uint32_t number) {
  PixelSample sample;
  sample.x = x;
  sample.y = y;
  sample.pixel = frame.index(x, y);
  sample.number = number;
  sample.half = static_cast<int>(number & 1u);
  const uint32_t stream = static_cast<uint32_t>(y) * context.settings.width + static_cast<uint32_t>(x);
  sample.sampler = Sampler(sample_key(context, StreamKind::Pixel, stream, number), context.settings.independent_sampler != 0);
  return sample;
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
