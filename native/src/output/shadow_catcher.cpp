#include "output/shadow_catcher.h"

#include <algorithm>

#include "film/catcher_channels.h"
#include "film/region_pixels.h"

namespace gradus::output {
namespace {

// Returns the mean over RGB of the light on a catcher, divided by the light that it receives alone.
float brightness(const float* shaded, const float* alone) {
  float sum = 0.0f;
  for (int c = 0; c < 3; ++c) sum += alone[c] != 0.0f ? shaded[c] / alone[c] : 1.0f;
  return sum / 3.0f;
}

}  // namespace

void show_shadow_catchers(const film::Film& film, const Region& region, float* rgba) {
  const film::Channel* shaded = film.channels.find(film::kCatcherShaded);
  if (shaded == nullptr) return;
  const film::Channel* alone = film.channels.find(film::kCatcherAlone);
  const film::Channel* background = film.channels.find(film::kCatcherBackground);
  film::for_pixels(film, region, [&](size_t i, size_t out) {
    const uint32_t samples = film::samples_at(film, i);
    if (samples == 0) return;
    float* const pixel = rgba + 4 * out;
    const float *s = &shaded->values[0][4 * i], *a = &alone->values[0][4 * i];
    float light = 1.0f;
    if (a[3] > 0.0f) {
      // Where the background shows beside the catcher, it is not darkened.
      const float covered = std::clamp(pixel[3] + s[3] / float(samples), 0.0f, 1.0f);
      light = std::clamp(1.0f - covered + covered * brightness(s, a), 0.0f, 1.0f);
    }
    const float shows = (1.0f - pixel[3]) * light;
    pixel[3] = 1.0f - shows;
    if (film.settings.film_transparent != 0) return;
    const float scale = film.settings.film_exposure * shows / float(samples);
    for (size_t c = 0; c < 3; ++c) pixel[c] += scale * background->values[0][3 * i + c];
    pixel[3] = 1.0f;
  });
}

}  // namespace gradus::output
