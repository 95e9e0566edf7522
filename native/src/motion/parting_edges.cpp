#include "motion/parting_edges.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "base/rows.h"

namespace gradus::motion {
namespace {

// Adjacent pixels that move apart by more than this, in pixels per axis, move in different ways.
constexpr float kApart = 1.0f;

bool parts(const CentreView& view, const std::vector<int32_t>& partner, const std::vector<Vec2>& displacements,
           size_t pixel, size_t other) {
  if (partner[other] == film::kNoCorrespondence) return view.hits[other].instance != view.hits[pixel].instance;
  const Vec2 apart = glm::abs(displacements[other] - displacements[pixel]);
  return std::max(apart.x, apart.y) > kApart;
}

// Returns 1 for the pixels with a partner in the other view beside which a pixel moves in another way, or shows another
// instance and has no partner.
std::vector<uint8_t> edges_of(const CentreView& view, const std::vector<int32_t>& partner,
                              const std::vector<Vec2>& displacements) {
  const auto width = size_t(view.region.width()), pixels = partner.size();
  std::vector<uint8_t> edges(pixels, 0);
  for_rows(view.region.height(), [&](int y) {
    const size_t first = size_t(y) * width;
    for (size_t i = first; i < first + width; ++i) {
      if (partner[i] == film::kNoCorrespondence) continue;
      const auto differs = [&](size_t other) { return parts(view, partner, displacements, i, other); };
      edges[i] = (i > first && differs(i - 1)) || (i + 1 < first + width && differs(i + 1)) ||
                 (i >= width && differs(i - width)) || (i + width < pixels && differs(i + width));
    }
  });
  return edges;
}

// Returns 1 for the pixels of which one in 3×3 pixels is an edge.
std::vector<uint8_t> near(const std::vector<uint8_t>& edges, const Region& region) {
  const int width = region.width(), height = region.height();
  std::vector<uint8_t> result(edges.size(), 0);
  for_rows(height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      uint8_t found = 0;
      for (int j = std::max(y - 1, 0); j <= std::min(y + 1, height - 1); ++j) {
        for (int i = std::max(x - 1, 0); i <= std::min(x + 1, width - 1); ++i)
          found |= edges[size_t(j) * size_t(width) + size_t(i)];
      }
      result[size_t(y) * size_t(width) + size_t(x)] = found;
    }
  });
  return result;
}

}  // namespace

void leave_out_parting_edges(const CentreView& from, const CentreView& to, film::PixelCorrespondence* correspondence) {
  const film::PixelCorrespondence back = inverse_correspondence(*correspondence);
  const size_t pixels = correspondence->pixel.size();
  std::vector<Vec2> forth(pixels, Vec2(0.0f)), here(pixels, Vec2(0.0f));
  for (size_t i = 0; i < pixels; ++i) {
    if (correspondence->pixel[i] == film::kNoCorrespondence) continue;
    const auto there = size_t(correspondence->pixel[i]);
    const Vec2 off = correspondence->off_centre.empty() ? Vec2(0.0f) : correspondence->off_centre[i];
    here[there] = forth[i] = centre_of(to.region, there) + off - centre_of(from.region, i);
  }
  const std::vector<uint8_t> leaving = edges_of(from, correspondence->pixel, forth),
                             arriving = edges_of(to, back.pixel, here), near_leaving = near(leaving, from.region),
                             near_arriving = near(arriving, to.region);
  for (size_t i = 0; i < pixels; ++i) {
    if (correspondence->pixel[i] == film::kNoCorrespondence) continue;
    const auto there = size_t(correspondence->pixel[i]);
    if ((leaving[i] != 0 && near_arriving[there] == 0) || (arriving[there] != 0 && near_leaving[i] == 0))
      correspondence->pixel[i] = film::kNoCorrespondence;
  }
}

}  // namespace gradus::motion
