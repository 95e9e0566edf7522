#include "motion/flow_vectors.h"

#include "base/fpu.h"
#include "motion/refine_flow.h"

namespace gradus::motion {
namespace {

// Pixels: maximum error of a surface's motion to the other frame and back. The motion back is that of the nearest
// pixel.
constexpr float kSurfaceReturn = 0.5f;
constexpr float kMinNoiseLevel = 0.5f;  // levels: rounding of the levels
// Standard deviation of a level, relative to the median magnitude of the difference of two levels.
constexpr float kDeviation = 1.4826f / 1.41421356f;
constexpr int kPatch = 7;          // radius in pixels of the patch over which two vectors are compared
constexpr float kMinNoise = 1.0f;  // levels: reconstructions leave correlated errors, which DIS fits well
constexpr float kGain = 1.5f;      // variances, mean over the patch, that a vector must explain: less may fit by chance

// Estimates the vectors from one frame to another. The other frame is first compensated by the motion of surfaces, so
// that optical flow finds the motion relative to them, the residual.
class FlowVectors {
 public:
  FlowVectors(const FlowFrame& from, const FlowFrame& to) : from_(from), to_(to), seen_(from.count()) {
    each_pixel([this](size_t p) { seen_[p] = is_seen(p); });
  }

  std::vector<Vec2> vectors(const FlowLibrary& library) const {
    const GreyImage there = compensated();
    const std::vector<Vec2> found = optical_flow(library, from_.image(), there);
    const std::vector<float> unmoved = squared_mismatch(there, std::vector<Vec2>(found.size())),
                             moved = squared_mismatch(there, found);
    const std::vector<float> noise = deviations(moved);
    std::vector<Vec2> residual = significant(found, unmoved, moved, noise);
    refine_flow({from_.levels(), to_.levels(), noise, from_.surface(), seen_, from_.object()}, &residual);
    each_pixel(
        [&](size_t p) { residual[p] = bounded(from_.surface()[p] + residual[p], from_.width(), from_.height()); });
    return residual;
  }

 private:
  template <class Body>
  void each_pixel(const Body& body) const {
    motion::each_pixel(from_.width(), from_.height(), [&](int, int, size_t p) { body(p); });
  }

  // Whether the surface of a pixel is visible in the other frame, with no edge near either pixel.
  bool is_seen(size_t p) const {
    const Vec2 there = from_.place(p) + from_.surface()[p];
    if (from_.tracked()[p] != kTracked || from_.shows_edge(p) || !to_.holds(there)) return false;
    const size_t q = to_.nearest(there);
    if (to_.tracked()[q] != kTracked || to_.shows_edge(q) || to_.object()[q] != from_.object()[p]) return false;
    return glm::length(from_.surface()[p] + to_.surface()[q]) <= kSurfaceReturn;
  }

  // Returns the other frame, warped by the motion of surfaces. Pixels that it does not show keep the levels of `from`.
  GreyImage compensated() const {
    GreyImage image = from_.image();
    each_pixel([&](size_t p) {
      if (seen_[p]) image.levels[p] = cubic_at(to_.levels(), from_.place(p) + from_.surface()[p]);
    });
    return image;
  }

  std::vector<float> squared_mismatch(const GreyImage& there, const std::vector<Vec2>& vectors) const {
    std::vector<float> result(vectors.size());
    each_pixel([&](size_t p) {
      const float off = linear_at(from_.plane(there.levels), from_.place(p) + vectors[p]) - from_.image().levels[p];
      result[p] = off * off;
    });
    return result;
  }

  // Returns the standard deviation of a level, from the median of the squared mismatch: most pixels are moved
  // correctly.
  float deviation(const std::vector<float>& squares) const {
    std::vector<float> seen;
    for (size_t p = 0; p < squares.size(); ++p) {
      if (seen_[p]) seen.push_back(squares[p]);
    }
    if (seen.empty()) return kMinNoiseLevel;
    const auto middle = seen.begin() + ptrdiff_t(seen.size() / 2);
    std::nth_element(seen.begin(), middle, seen.end());
    return std::max(kMinNoiseLevel, kDeviation * std::sqrt(*middle));
  }

  // Returns the standard deviation of a level at each pixel. Where the image is noisier than in most of the film, it is
  // estimated from the mismatch around the pixel.
  std::vector<float> deviations(const std::vector<float>& squares) const {
    const float overall = deviation(squares);
    std::vector<float> result = patch_means(squares);
    each_pixel([&](size_t p) { result[p] = std::max(overall, std::sqrt(0.5f * result[p])); });
    return result;
  }

  // Returns the residuals of vectors that explain more of the mismatch than chance would; 0 for the others. unmoved,
  // moved: squared mismatch without the vectors and with them.
  std::vector<Vec2> significant(const std::vector<Vec2>& found, std::vector<float> unmoved,
                                const std::vector<float>& moved, const std::vector<float>& noise) const {
    each_pixel([&](size_t p) { unmoved[p] -= moved[p]; });
    const std::vector<float> gain = patch_means(unmoved);
    std::vector<Vec2> residual(found.size(), Vec2(0.0f));
    each_pixel([&](size_t p) {
      const Vec2 place = from_.place(p) + found[p];
      const size_t q = from_.nearest(place);
      const float minimum = std::max(noise[p], kMinNoise);
      if (gain[p] < kGain * minimum * minimum || !seen_[p] || !seen_[q] || from_.object()[p] != from_.object()[q])
        return;
      // The compensated image was warped by the surface motion at `place`, not by that at `p`.
      residual[p] = found[p] + linear_at(from_.plane(from_.surface()), place) - from_.surface()[p];
    });
    return residual;
  }

  // Returns the mean over the patch around each pixel.
  std::vector<float> patch_means(const std::vector<float>& values) const {
    const FilmPlane<float> across{from_.width(), from_.height(), values};
    std::vector<float> rows(values.size()), result(values.size());
    const FilmPlane<float> down{from_.width(), from_.height(), rows};
    const auto sum = [&](const FilmPlane<float>& plane, int dx, int dy, std::vector<float>* sums) {
      motion::each_pixel(plane.width, plane.height, [&](int x, int y, size_t p) {
        float total = 0.0f;
        for (int i = -kPatch; i <= kPatch; ++i) total += plane.at(x + i * dx, y + i * dy);
        (*sums)[p] = total / float(2 * kPatch + 1);
      });
    };
    sum(across, 1, 0, &rows);
    sum(down, 0, 1, &result);
    return result;
  }

  const FlowFrame &from_, &to_;
  std::vector<uint8_t> seen_;
};

}  // namespace

std::vector<Vec2> flow_vectors(const FlowLibrary& library, const FlowFrame& from, const FlowFrame& to) {
  const FlushDenormals flush;  // gives the same bits in every thread
  return FlowVectors(from, to).vectors(library);
}

}  // namespace gradus::motion
