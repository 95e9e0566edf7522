#include "motion/refine_flow.h"

#include <numeric>

namespace gradus::motion {
namespace {

constexpr int kWarps = 5, kSweeps = 10;
constexpr int kWindow = 3;             // radius of the window in pixels; its Gaussian has half of it as deviation
constexpr float kSmoothness = 5.0f;    // weight per pixel of difference, against squared data relative to its variance
constexpr float kAlike = 0.1f;         // pixels: smaller differences are penalised by their squares
constexpr float kOutlier = 3.0f;       // standard deviations: larger data is penalised by its magnitude
constexpr float kPriorWeight = 1e-4f;  // weight of a zero residual, which decides where there is no other data
constexpr float kOverRelaxation = 1.7f;  // factor of Gauss-Seidel steps
constexpr float kMaxRefinement = 1.0f;   // pixels: range over which a gradient is valid

// Normal equations of a vector: (xx xy; xy yy) vector = right.
struct Normal {
  float xx = 0.0f, xy = 0.0f, yy = 0.0f;
  Vec2 right{0.0f};

  void add(float weight, const Normal& other) {
    xx += weight * other.xx, xy += weight * other.xy, yy += weight * other.yy, right += weight * other.right;
  }
  // Adds a quadratic term with its minimum at `vector`.
  void pull(float weight, const Vec2& vector) { xx += weight, yy += weight, right += weight * vector; }
  // Returns the solved form, vector = (xx xy; xy yy) right; all 0 if the matrix is not positive definite.
  Normal inverse() const {
    const float determinant = xx * yy - xy * xy;
    if (!(determinant > 0.0f)) return {};
    return {yy / determinant, -xy / determinant, xx / determinant, right};
  }
};

std::array<float, 2 * kWindow + 1> window_weights() {
  std::array<float, 2 * kWindow + 1> weights{};
  for (size_t i = 0; i < weights.size(); ++i) {
    const float offset = float(i) - float(kWindow);
    weights[i] = std::exp(-2.0f * offset * offset / float(kWindow * kWindow));
  }
  const float sum = std::accumulate(weights.begin(), weights.end(), 0.0f);
  for (float& weight : weights) weight /= sum;
  return weights;
}

// Alternates between warping the second image by the present vectors and solving for a step by successive
// over-relaxation.
class Refinement {
 public:
  Refinement(const FlowPair& pair, std::vector<Vec2>* residual)
      : pair_(pair),
        width_(pair.from.width),
        height_(pair.from.height),
        residual_(*residual),
        step_(residual->size()),
        warped_(residual->size()),
        pixels_(residual->size()),
        rows_(residual->size()),
        data_(residual->size()),
        right_(residual->size()),
        below_(residual->size()) {}

  void run() {
    for (int i = 0; i < kWarps; ++i) {
      each_pixel([this](int x, int y, size_t p) { warped_[p] = warped(x, y, p); });
      each_pixel([this](int x, int y, size_t p) { pixels_[p] = pixel_data(x, y, p); });
      sum_windows();
      each_pixel([this](int x, int y, size_t p) {
        right_[p] = x + 1 < width_ ? likeness(p, p + 1) : 0.0f;
        below_[p] = y + 1 < height_ ? likeness(p, p + size_t(width_)) : 0.0f;
      });
      each_pixel([this](int x, int y, size_t p) { pixels_[p] = solved(x, y, p); });
      std::fill(step_.begin(), step_.end(), Vec2(0.0f));
      for (int k = 0; k < 2 * kSweeps; ++k) {
        for_rows(height_, [this, k](int y) { relax(y, k & 1); });
      }
      each_pixel([this](int, int, size_t p) { residual_[p] += glm::clamp(step_[p], -kMaxRefinement, kMaxRefinement); });
    }
  }

 private:
  size_t index(int x, int y) const { return size_t(y) * size_t(width_) + size_t(x); }
  template <class Body>
  void each_pixel(const Body& body) {
    motion::each_pixel(width_, height_, body);
  }

  // Returns the level of the second image at the end of a pixel's vector. A pixel that it cannot show gets its own
  // level, so that it has no mismatch.
  float warped(int x, int y, size_t p) const {
    return pair_.seen[p] ? cubic_at(pair_.to, Vec2(float(x), float(y)) + pair_.bootstrap[p] + residual_[p])
                         : pair_.from.values[p];
  }

  // Returns the data term of one pixel: change + gradient · step = 0, with the gradient of the mean of both images.
  Normal pixel_data(int x, int y, size_t p) const {
    if (!pair_.seen[p]) return {};
    const FilmPlane<float> warped{width_, height_, warped_};
    const auto mean = [&](int i, int j) { return 0.5f * (pair_.from.at(i, j) + warped.at(i, j)); };
    const Vec2 gradient = 0.5f * Vec2(mean(x + 1, y) - mean(x - 1, y), mean(x, y + 1) - mean(x, y - 1));
    const float change = warped_[p] - pair_.from.values[p], variance = 2.0f * pair_.noise[p] * pair_.noise[p];
    const float weight = 1.0f / (variance * std::max(1.0f, std::abs(change) / (kOutlier * std::sqrt(variance))));
    return {weight * gradient.x * gradient.x, weight * gradient.x * gradient.y, weight * gradient.y * gradient.y,
            -weight * change * gradient};
  }

  // Sums the data terms over the window around each pixel, and adds the prior.
  void sum_windows() {
    each_pixel([this](int x, int y, size_t p) {
      Normal sum;
      for (int i = std::max(x - kWindow, 0); i <= std::min(x + kWindow, width_ - 1); ++i)
        sum.add(weight(i - x), pixels_[index(i, y)]);
      rows_[p] = sum;
    });
    each_pixel([this](int x, int y, size_t p) {
      Normal sum;
      for (int j = std::max(y - kWindow, 0); j <= std::min(y + kWindow, height_ - 1); ++j)
        sum.add(weight(j - y), rows_[index(x, j)]);
      sum.pull(kPriorWeight, -residual_[p]);
      data_[p] = sum;
    });
  }
  float weight(int offset) const { return weights_[size_t(ptrdiff_t(offset) + kWindow)]; }

  // Returns the weight of smoothness between the residuals of two neighbours.
  float likeness(size_t p, size_t q) const {
    if (pair_.object[p] != pair_.object[q]) return 0.0f;
    const Vec2 difference = residual_[q] - residual_[p];
    return kSmoothness / std::sqrt(glm::dot(difference, difference) + kAlike * kAlike);
  }

  // Returns the solved equations of a pixel's step, with its right side for neighbours that make no step.
  Normal solved(int x, int y, size_t p) const {
    Normal normal = data_[p];
    const size_t row = size_t(width_);
    if (x > 0) normal.pull(right_[p - 1], residual_[p - 1] - residual_[p]);
    if (x + 1 < width_) normal.pull(right_[p], residual_[p + 1] - residual_[p]);
    if (y > 0) normal.pull(below_[p - row], residual_[p - row] - residual_[p]);
    if (y + 1 < height_) normal.pull(below_[p], residual_[p + row] - residual_[p]);
    return normal.inverse();
  }

  // Relaxes every other pixel of a row: pixels of one colour of a chessboard do not depend on each other. It must not
  // be inlined, for the reason that motion/film_plane.h gives for its rows.
  [[gnu::noinline]] void relax(int y, int colour) {
    for (int x = (y + colour) & 1; x < width_; x += 2) {
      const size_t p = index(x, y), row = size_t(width_);
      const Normal& inverse = pixels_[p];
      Vec2 right = inverse.right;
      if (x > 0) right += right_[p - 1] * step_[p - 1];
      if (x + 1 < width_) right += right_[p] * step_[p + 1];
      if (y > 0) right += below_[p - row] * step_[p - row];
      if (y + 1 < height_) right += below_[p] * step_[p + row];
      const Vec2 step = {inverse.xx * right.x + inverse.xy * right.y, inverse.xy * right.x + inverse.yy * right.y};
      step_[p] += kOverRelaxation * (step - step_[p]);
    }
  }

  const FlowPair& pair_;
  const int width_, height_;
  std::vector<Vec2>& residual_;
  std::vector<Vec2> step_;  // step of this warp
  std::vector<float> warped_;
  std::vector<Normal> pixels_;        // data of single pixels, later the solved equations
  std::vector<Normal> rows_, data_;   // data summed along rows, and over windows
  std::vector<float> right_, below_;  // smoothness between a pixel and its right and lower neighbour
  const std::array<float, 2 * kWindow + 1> weights_ = window_weights();
};

}  // namespace

void refine_flow(const FlowPair& pair, std::vector<Vec2>* residual) { Refinement(pair, residual).run(); }

}  // namespace gradus::motion
