#include "integrator/pixel_loop.h"

#include <algorithm>

namespace gradus::integrator {

namespace {

// Whose random numbers a pixel takes.
struct Source {
  path::StreamKind kind = path::StreamKind::Pixel;
  int32_t x = 0, y = 0;
  int32_t frame = 0;
  uint32_t seed = 0;
  bool shares_jitter = false;  // with its cell
};

// A pixel's of the frame itself, or of the one that it replays.
Source numbers_of(const path::PathContext& context, const WorkUnit& unit, int32_t x, int32_t y) {
  const film::ReplayMap* replayed = unit.replay_map;
  if (replayed != nullptr)
    return {path::StreamKind::Pixel, x, y, replayed->stream_frame, replayed->seed, replayed->shares_jitter};
  return {path::StreamKind::Pixel,
          x,
          y,
          context.settings.frame,
          context.settings.seed,
          shares_jitter(context.camera, context.scene)};
}

Source source_of(const path::PathContext& context, const WorkUnit& unit, const film::Film& film, int32_t x, int32_t y) {
  if (unit.replay_map == nullptr) return numbers_of(context, unit, x, y);
  const int32_t pixel = unit.replay_map->correspondence.pixel[film.index(x, y)];
  if (pixel == film::kNoCorrespondence)
    return {path::StreamKind::Disocclusion, x, y, context.settings.frame, context.settings.seed};
  const int32_t width = film.region.width();
  return numbers_of(context, unit, film.region.x0 + pixel % width, film.region.y0 + pixel / width);
}

path::Sampler make_sampler(const path::PathContext& context, const Source& source, path::StreamKind kind,
                           uint32_t stream, uint32_t number) {
  return path::Sampler({source.seed, kind, stream, source.frame, number}, context.settings.independent_sampler != 0);
}

// Jitter of the cell that holds a pixel.
Vec2 jitter_of_block(const path::PathContext& context, const Source& source, uint32_t number) {
  const uint32_t column = static_cast<uint32_t>(film::pixel_block_of(source.x)),
                 row = static_cast<uint32_t>(film::pixel_block_of(source.y));
  const path::Sampler sampler =
      make_sampler(context, source, path::StreamKind::PixelBlock, (row << 16) ^ (column & 0xffffu), number);
  return context.filter.sample(sampler.get2(path::dimension::kFilm));
}

}  // namespace

uint32_t max_samples(const WorkUnit& unit, const film::Film& film, const Region& block) {
  if (unit.count_map == nullptr) {
    return unit.count;
  }
  uint32_t maximum = 0;
  for (int32_t y = block.y0; y < block.y1; ++y) {
    for (int32_t x = block.x0; x < block.x1; ++x) {
      maximum = std::max(maximum, unit_count(unit, film.index(x, y)));
    }
  }
  return maximum;
}

bool shares_rays(const path::PathContext& context, const WorkUnit& unit, const film::Film& film, const Region& block) {
  if (!shares_jitter(context.camera, context.scene) || (unit.replay_map != nullptr && !unit.replay_map->shares_jitter))
    return false;
  for (int32_t y = block.y0; y < block.y1 && unit.replay_map != nullptr; ++y) {
    for (int32_t x = block.x0; x < block.x1; ++x) {
      if (unit.replay_map->correspondence.pixel[film.index(x, y)] != static_cast<int32_t>(film.index(x, y)))
        return false;
    }
  }
  return true;
}

Vec2 block_jitter(const path::PathContext& context, const WorkUnit& unit, const Region& block, uint32_t number) {
  return jitter_of_block(context, numbers_of(context, unit, block.x0, block.y0), number);
}

PixelSample make_pixel_sample(const path::PathContext& context, const WorkUnit& unit, const film::Film& film, int32_t x,
                              int32_t y, uint32_t number) {
  const Source source = source_of(context, unit, film, x, y);
  PixelSample sample;
  sample.x = x;
  sample.y = y;
  sample.pixel = film.index(x, y);
  sample.number = number;
  sample.half = static_cast<int>(number & 1u);
  const uint32_t stream = static_cast<uint32_t>(source.y) * context.settings.width + static_cast<uint32_t>(source.x);
  sample.sampler = make_sampler(context, source, source.kind, stream, number);
  return sample;
}

Vec2 pixel_jitter(const path::PathContext& context, const WorkUnit& unit, const film::Film& film,
                  const PixelSample& sample) {
  const Source source = source_of(context, unit, film, sample.x, sample.y);
  if (source.shares_jitter) return jitter_of_block(context, source, sample.number);
  return context.filter.sample(sample.sampler.get2(path::dimension::kFilm));
}

void add_primal(const path::PathResult& result, const PixelSample& sample, const WorkUnit& unit, film::Film* film,
                film::Counters* counters) {
  const uint32_t wanted = unit_components(unit, sample.pixel);
  for (size_t c = 0; c < film->components.size(); ++c) {
    Radiance value = result.radiance[c];
    if (film->color_channels < 4) {
      value.w = 0.0f;
    }
    if (value != Radiance(0.0f) && (wanted >> c & 1) != 0) {
      film::add_radiance(value, &film->components[c].primal[sample.half][sample.pixel], counters);
    }
  }
  if (unit.adds_components) return;
  ++film->count[sample.half][sample.pixel];
  if (!film->fallback.empty() && result.fallback) {
    film->fallback[sample.pixel] += 1.0f;
  }
}

}  // namespace gradus::integrator
