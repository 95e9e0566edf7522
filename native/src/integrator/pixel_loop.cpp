#include "integrator/pixel_loop.h"

#include <algorithm>
#include <cmath>

#include "base/fault.h"

namespace gradus::integrator {

namespace {

// Stream of random numbers that a pixel uses.
struct Stream {
  path::StreamKind kind = path::StreamKind::Pixel;
  int32_t x = 0, y = 0;
  int32_t frame = 0;
  uint32_t seed = 0;
  bool shares_jitter = false;  // with its pixel block
};

// Returns the stream of a pixel in its own frame, or in the frame that is replayed if `replayed` is given.
Stream stream_of_pixel(const path::PathContext& context, const film::ReplayMap* replayed, bool gradients, int32_t x,
                       int32_t y) {
  if (replayed != nullptr)
    return {path::StreamKind::Pixel, x, y, replayed->stream_frame, replayed->seed, replayed->shares_jitter};
  return {path::StreamKind::Pixel,
          x,
          y,
          context.settings.frame,
          context.settings.seed,
          shares_jitter(context.camera, context.scene, gradients)};
}

// Returns the stream that a pixel of the film uses: its own, that of its correspondence in the replayed frame, or one
// for disocclusions.
Stream find_stream(const path::PathContext& context, const WorkUnit& unit, const film::Film& film, int32_t x,
                   int32_t y) {
  if (unit.replay_map == nullptr) return stream_of_pixel(context, nullptr, film.gradients, x, y);
  const int32_t pixel = unit.replay_map->correspondence.pixel[film.index(x, y)];
  if (pixel == film::kNoCorrespondence && GRADUS_FAULT(disocclusion_takes_own_numbers_again))
    return stream_of_pixel(context, nullptr, film.gradients, x, y);
  if (pixel == film::kNoCorrespondence)
    return {path::StreamKind::Disocclusion, x, y, context.settings.frame, context.settings.seed};
  if (GRADUS_FAULT(replay_takes_same_pixel)) return stream_of_pixel(context, unit.replay_map, film.gradients, x, y);
  const film::ReplayMap* replayed = GRADUS_FAULT(replayed_pixels_take_own_seed) ? nullptr : unit.replay_map;
  const int32_t width = film.region.width(), x0 = GRADUS_FAULT(replay_ignores_border_corner) ? 0 : film.region.x0;
  return stream_of_pixel(context, replayed, film.gradients, x0 + pixel % width, film.region.y0 + pixel / width);
}

path::Sampler make_sampler(const path::PathContext& context, const path::SampleKey& key) {
  return path::Sampler(key, context.settings.independent_sampler != 0);
}

path::Sampler sampler_of_pixel(const path::PathContext& context, const Stream& stream, uint32_t net_samples,
                               uint32_t number) {
  const Stream place = GRADUS_FAULT(random_stream_shared_by_pixels) ? Stream{} : stream;
  const auto x = static_cast<uint32_t>(place.x), y = static_cast<uint32_t>(place.y);
  path::SampleKey key{stream.seed, stream.kind, 0, stream.frame, number, net_samples};
  if (net_samples > 0) {
    key.morton = path::morton_code(x, y);
  } else {
    key.stream = y * context.settings.width + x;
  }
  return make_sampler(context, key);
}

// Returns the jitter of the pixel block that contains a pixel of the stream.
Vec2 jitter_of_block(const path::PathContext& context, const Stream& stream, uint32_t number) {
  const uint32_t column = static_cast<uint32_t>(film::pixel_block_of(stream.x)),
                 row = static_cast<uint32_t>(film::pixel_block_of(stream.y));
  const path::Sampler sampler = make_sampler(
      context, {stream.seed, path::StreamKind::PixelBlock, (row << 16) ^ (column & 0xffffu), stream.frame, number});
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
  if (!shares_jitter(context.camera, context.scene, film.gradients) ||
      (unit.replay_map != nullptr && !unit.replay_map->shares_jitter))
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
  const film::ReplayMap* replayed = GRADUS_FAULT(replayed_blocks_take_own_seed) ? nullptr : unit.replay_map;
  return jitter_of_block(context, stream_of_pixel(context, replayed, true, block.x0, block.y0), number);
}

PixelSample make_pixel_sample(const path::PathContext& context, const WorkUnit& unit, const film::Film& film, int32_t x,
                              int32_t y, uint32_t number) {
  const Stream stream = find_stream(context, unit, film, x, y);
  PixelSample sample;
  sample.x = x;
  sample.y = y;
  sample.pixel = film.index(x, y);
  sample.number = number;
  sample.half = static_cast<int>(number & 1u);
  const bool is_replay = unit.replay_map != nullptr && stream.kind == path::StreamKind::Pixel;
  sample.sampler =
      sampler_of_pixel(context, stream, is_replay ? unit.replay_map->net_samples : film.settings.net_samples, number);
  return sample;
}

Vec2 pixel_jitter(const path::PathContext& context, const WorkUnit& unit, const film::Film& film,
                  const PixelSample& sample) {
  const Stream stream = find_stream(context, unit, film, sample.x, sample.y);
  if (stream.shares_jitter) return jitter_of_block(context, stream, sample.number);
  return context.filter.sample(sample.sampler.get2(path::dimension::kFilm));
}

void add_primal(const path::PathResult& result, const PixelSample& sample, const WorkUnit& unit, film::Film* film,
                film::Counters* counters) {
  const uint32_t wanted = unit_components(unit, sample.pixel);
  for (size_t c = 0; c < film->components.size(); ++c) {
    Radiance value = result.radiance[c];
    if (GRADUS_FAULT(samples_one_percent_darker)) value *= 0.99f;
    if (GRADUS_FAULT(one_sample_in_1000_is_nan) && (sample.pixel * 31 + sample.number) % 1000 == 0) value.x = NAN;
    if (film->color_channels < 4) {
      value.w = 0.0f;
    }
    if (value != Radiance(0.0f) && (wanted >> c & 1) != 0) {
      film::add_radiance(value, &film->components[c].primal[sample.half][sample.pixel], counters);
    }
  }
  if (unit.adds_components) return;
  ++film->count[sample.half][sample.pixel];
  if (!result.fallback) return;
  if (film::Channel* fallback = film->channels.of_pass(GRADUS_PASS_FALLBACK); fallback != nullptr) {
    fallback->values[0][sample.pixel] += 1.0f;
  }
}

}  // namespace gradus::integrator
