#include "integrator/pixel_loop.h"

namespace gradus {

PixelSample make_pixel_sample(const PathContext& context, const Frame& frame, int32_t x, int32_t y, uint32_t number) {
  PixelSample sample;
  sample.x = x;
  sample.y = y;
  sample.pixel = frame.index(x, y);
  sample.number = number;
  sample.half = static_cast<int>(number & 1u);
  SampleKey key;
  key.seed = context.settings.seed;
  key.stream = static_cast<uint32_t>(y) * context.settings.width + static_cast<uint32_t>(x);
  key.stream_frame = context.settings.frame;
  key.index = number;
  sample.sampler = Sampler(key, context.settings.independent_sampler != 0);
  sample.film =
      Vec2(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f) + context.filter.sample(sample.sampler.get2(dimension::kFilm));
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
