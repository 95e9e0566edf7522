#include "film/pass_planes.h"

#include <algorithm>

#include "schema/pass_table.h"

namespace gradus::film {

std::vector<PassPlane> make_pass_planes(uint64_t passes, size_t pixels) {
  std::vector<PassPlane> planes;
  for (const schema::PassInfo& info : schema::stored_passes(passes)) {
    PassPlane& plane = planes.emplace_back();
    plane.pass = info.pass;
    plane.channels = info.channels;
    plane.first_sample_only = info.kind == schema::PassKind::First;
    plane.skips_transparent = info.kind == schema::PassKind::Weighted;
    plane.in_halves = schema::is_in_halves(info.kind);
    for (int half = 0; half < (plane.in_halves ? kHalves : 1); ++half)
      plane.values[half].assign(pixels * info.channels, 0.0f);
    if (plane.skips_transparent) plane.weight.assign(pixels, 0.0f);
  }
  return planes;
}

void allocate_component_content(const ComponentContent& content, Film* film) {
  const auto pixels = size_t(film->region.area());
  for (ComponentPlanes& planes : film->components) {
    for (auto& half : planes.non_specular) half.assign(content.non_specular ? pixels : 0, NonSpecularVertices{});
    planes.details.assign(content.details ? pixels : 0, NonSpecularDetails{});
    planes.motion.assign(content.motion ? pixels : 0, Vec4(0.0f));
    planes.tracked.assign(content.motion ? pixels : 0, kNothingToTrack);
    planes.shown.assign(content.shown ? pixels : 0, ShownPoint{});
  }
}

ComponentContent component_content(const Film& film) {
  const ComponentPlanes& planes = film.components.front();
  return {!planes.non_specular[0].empty(), !planes.details.empty(), !planes.motion.empty(), !planes.shown.empty()};
}

uint64_t film_passes(const Film& film) {
  uint64_t passes = 0;
  for (const PassPlane& plane : film.passes) passes |= uint64_t{1} << plane.pass;
  return passes;
}

const PassPlane* find_plane(const Film& film, uint32_t pass) {
  const auto plane =
      std::find_if(film.passes.begin(), film.passes.end(), [&](const PassPlane& p) { return p.pass == pass; });
  return plane != film.passes.end() ? &*plane : nullptr;
}

uint64_t film_bytes_per_pixel(int components, bool gradients, uint64_t passes, const ComponentContent& content) {
  const uint64_t offsets = gradients ? uint64_t{kOffsets} : 0, radiances = uint64_t(components) * (1 + offsets);
  const uint64_t features = content.non_specular ? uint64_t(components) * sizeof(NonSpecularVertices) : 0;
  const uint64_t half = radiances * sizeof(Radiance) + features + sizeof(uint32_t) + offsets * sizeof(float);
  const uint64_t others = (content.details ? sizeof(NonSpecularDetails) : 0) +
                          (content.motion ? sizeof(Vec4) + sizeof(float) : 0) +
                          (content.shown ? sizeof(ShownPoint) : 0);
  return kHalves * half + uint64_t(components) * others + schema::pass_bytes_per_pixel(passes) +
         (schema::has_bit(passes, GRADUS_PASS_FALLBACK) ? sizeof(float) : 0);
}

}  // namespace gradus::film
