#include "output/shadow_catcher.h"

#include <algorithm>

#include "film/catcher_channels.h"
#include "film/pixel_sum.h"
#include "film/region_pixels.h"
#include "schema/pass_table.h"

namespace gradus::output {
namespace {

// Returns the light on the catchers of a pixel divided by the light that they receive alone. `alpha` is that of the
// picture with its holes; where the background shows beside a catcher, it is not darkened.
Rgb shadow(const film::Film& film, const film::Channel& shaded, size_t i, float alpha) {
  const film::Channel& alone = *film.channels.find(film::kCatcherAlone);
  const float *s = &shaded.values[0][4 * i], *a = &alone.values[0][4 * i];
  if (!(a[3] > 0.0f)) return Rgb(1.0f);
  const float covered = std::clamp(alpha + s[3] / float(film::samples_at(film, i)), 0.0f, 1.0f);
  Rgb quotient(1.0f);
  for (int c = 0; c < 3; ++c) quotient[c] = a[c] != 0.0f ? s[c] / a[c] : 1.0f;
  return 1.0f - covered + covered * quotient;
}

}  // namespace

void show_shadow_catchers(const film::Film& film, const Region& region, float* rgba) {
  const film::Channel* shaded = film.channels.find(film::kCatcherShaded);
  if (shaded == nullptr || schema::has_bit(film.settings.passes, GRADUS_PASS_SHADOW_CATCHER)) return;
  const film::Channel* background = film.channels.find(film::kCatcherBackground);
  film::for_pixels(film, region, [&](size_t i, size_t out) {
    const uint32_t samples = film::samples_at(film, i);
    if (samples == 0) return;
    float* const pixel = rgba + 4 * out;
    const float light = std::clamp(mean_component(shadow(film, *shaded, i, pixel[3])), 0.0f, 1.0f);
    const float shows = (1.0f - pixel[3]) * light;
    pixel[3] = 1.0f - shows;
    if (film.settings.film_transparent != 0) return;
    const float scale = film.settings.film_exposure * shows / float(samples);
    for (size_t c = 0; c < 3; ++c) pixel[c] += scale * background->values[0][3 * i + c];
    pixel[3] = 1.0f;
  });
}

void read_shadow_catchers(const film::Film& film, const Region& region, float* rgb) {
  std::fill_n(rgb, size_t(region.area()) * 3, 1.0f);
  const film::Channel* shaded = film.channels.find(film::kCatcherShaded);
  if (shaded == nullptr) return;
  film::for_pixels(film, region, [&](size_t i, size_t out) {
    const uint32_t samples = film::samples_at(film, i);
    if (samples == 0) return;
    const float alpha = film::sum_at(film, i).w / float(samples);
    const Rgb value = shadow(film, *shaded, i, std::clamp(alpha, 0.0f, 1.0f));
    std::copy_n(&value.x, 3, rgb + 3 * out);
  });
}

}  // namespace gradus::output
