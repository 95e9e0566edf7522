#include "film_io/check_planes.h"

#include <atomic>

#include <tbb/parallel_for.h>

#include "base/error.h"

namespace gradus::film_io {
namespace {

constexpr size_t kPixels = 4096;  // pixels per task
constexpr float kObjects = 16777216.0f;

bool is_sound(float value) { return is_finite(value); }
bool is_sound(const Vec4& value) { return is_finite(Vec3(value)) && is_finite(value.w); }
bool is_sound(const film::ShownPoint& shown) {
  return shown.object >= 0.0f && shown.object <= kObjects && is_finite(shown.depth);
}
bool is_sound(const film::NonSpecularVertices& non_specular) {
  return is_finite(non_specular.reflectance) && is_finite(non_specular.normal) &&
         is_finite(non_specular.inverse_depth) && is_finite(non_specular.samples);
}
bool is_sound(const film::NonSpecularDetails& details) {
  return is_finite(details.uv) && is_finite(details.emission) && is_finite(details.segments) &&
         is_finite(details.object) && is_finite(details.face);
}

template <class Value>
void check(const std::vector<Value>& plane, const char* what) {
  std::atomic<bool> sound{true};
  tbb::parallel_for(tbb::blocked_range<size_t>(0, plane.size(), kPixels), [&](const tbb::blocked_range<size_t>& range) {
    for (size_t i = range.begin(); i < range.end(); ++i) {
      if (!is_sound(plane[i])) sound = false;
    }
  });
  if (!sound) throw invalid_argument(std::string("it holds ") + what + " that no pixel has");
}

}  // namespace

void check_planes(const film::Film& film) {
  for (const film::ComponentPlanes& planes : film.components) {
    for (const auto& half : planes.non_specular) check(half, "first rough vertices");
    check(planes.details, "details of vertices");
    check(planes.motion, "motion");
    check(planes.tracked, "causes of lost motion");
    check(planes.shown, "shown points");
  }
}

}  // namespace gradus::film_io
