#include "motion/parting_edges.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "base/rows.h"

namespace gradus::motion {
namespace {

// Adjacent pixels that move apart by more than this, in pixels per axis, move in different ways.
constexpr float kApart = 1.0f;
constexpr int kPixels = 4096;  // number of pixels that one task handles

// Returns whether two pixels beside each other, of which the first has a partner in the other view, move in different
// ways, or show different instances and the second has no partner.
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
  std::vector<uint8_t> edges(partner.size(), 0);
  for_pieces(
      int(partner.size()),
      [&](int begin, int end) {
        for (auto i = size_t(begin); i < size_t(end); ++i) {
          const auto differs = [&](size_t other) { return parts(view, partner, displacements, i, other); };
          edges[i] = partner[i] != film::kNoCorrespondence && any_beside(view.region, i, differs);
        }
      },
      kPixels);
  return edges;
}

// Returns whether one of 3×3 pixels is an edge.
bool is_near(const std::vector<uint8_t>& edges, const Region& region, size_t pixel) {
  const int width = region.width(), x = int(pixel) % width, y = int(pixel) / width;
  for (int j = std::max(y - 1, 0); j <= std::min(y + 1, region.height() - 1); ++j) {
    for (int i = std::max(x - 1, 0); i <= std::min(x + 1, width - 1); ++i) {
      if (edges[size_t(j) * size_t(width) + size_t(i)] != 0) return true;
    }
  }
  return false;
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
                             arriving = edges_of(to, back.pixel, here);
  for (size_t i = 0; i < pixels; ++i) {
    if (correspondence->pixel[i] == film::kNoCorrespondence) continue;
    const auto there = size_t(correspondence->pixel[i]);
    if ((leaving[i] != 0 && !is_near(arriving, to.region, there)) ||
        (arriving[there] != 0 && !is_near(leaving, from.region, i)))
      correspondence->pixel[i] = film::kNoCorrespondence;
  }
}

}  // namespace gradus::motion
