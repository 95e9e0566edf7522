#include "reconstruct/space_time/track_smoothing.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include "reconstruct/field_values.h"

namespace gradus {
namespace {

// Ages of pixels are counted up to here; what elimination leaves has long been constant by then.
constexpr uint8_t kOldest = 63;

// How many frames a pixel's track has come from, up to kOldest.
using Ages = std::vector<uint8_t>;

Ages next_ages(const Ages& ages, const Links& links) {
  Ages next(ages.size(), 0);
  const size_t w = size_t(links.width());
  for (int y = 0; y < links.height(); ++y) {
    links.for_runs(y, [&](int begin, int end, int dx, int dy) {
      const uint8_t* from = ages.data() + size_t(y) * w;
      uint8_t* to = next.data() + size_t(y + dy) * w + dx;
      for (int x = begin; x < end; ++x) to[x] = std::min<uint8_t>(uint8_t(from[x] + 1), kOldest);
    });
  }
  return next;
}

// By age: 1 / pivot, where a track ends and where it goes on.
struct Pivots {
  std::array<float, kOldest + 1> last, linked;
};

Pivots pivots(float data_weight) {
  Pivots result{};
  float screen = data_weight;
  for (size_t age = 0; age <= kOldest; ++age) {
    result.last[age] = 1.0f / screen;
    result.linked[age] = 1.0f / (screen + 1.0f);
    screen = data_weight + screen / (screen + 1.0f);
  }
  return result;
}

// Back substitution of row y of frame t; the next frame is done.
void solve_row(const SpaceTimeSystem& system, int t, int y, const Pivots& pivot, const uint8_t* age, Frames* values) {
  Field& here = (*values)[size_t(t)];
  const bool last = t + 1 == system.frames();
  const Links::Shift* shifts = last ? nullptr : system.links(t).row(y);
  for (int c = 0; c < here.channels(); ++c) {
    float* row = here.row(y, c);
    for (int x = 0; x < here.width(); ++x) {
      if (last || shifts[x] == Links::kNone) row[x] *= pivot.last[age[x]];
    }
    if (last) continue;
    system.links(t).for_runs(y, [&](int begin, int end, int dx, int dy) {
      const float* next = (*values)[size_t(t) + 1].row(y + dy, c) + dx;
      for (int x = begin; x < end; ++x) row[x] = (row[x] + next[x]) * pivot.linked[age[x]];
    });
  }
}

}  // namespace

void smooth_tracks(const SpaceTimeSystem& system, float data_weight, Frames* values) {
  const int w = system.width(), h = system.height(), channels = values->front().channels();
  const Pivots pivot = pivots(data_weight);
  std::vector<Ages> ages{Ages(size_t(w) * size_t(h), 0)};
  for (int t = 0; t + 1 < system.frames(); ++t) ages.push_back(next_ages(ages.back(), system.links(t)));
  const auto age = [&](int t, int y) { return ages[size_t(t)].data() + size_t(y) * size_t(w); };
  for (Field& frame : *values) {
    for_values(&frame, [&](float& value, int, int, int) { value *= data_weight; });
  }
  for (int t = 0; t + 1 < system.frames(); ++t) {
    const Field& from = (*values)[size_t(t)];
    Field& to = (*values)[size_t(t) + 1];
    for_rows(h, [&](int y) {
      system.links(t).for_runs(y, [&](int begin, int end, int dx, int dy) {
        for (int c = 0; c < channels; ++c) {
          for (int x = begin; x < end; ++x) to.row(y + dy, c)[x + dx] += pivot.linked[age(t, y)[x]] * from.row(y, c)[x];
        }
      });
    });
  }
  for (int t = system.frames() - 1; t >= 0; --t) {
    for_rows(h, [&](int y) { solve_row(system, t, y, pivot, age(t, y), values); });
  }
}

}  // namespace gradus
