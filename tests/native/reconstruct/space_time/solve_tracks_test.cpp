// Weighted least squares along the tracks of pixels.
#include "reconstruct/space_time/solve_tracks.h"

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include "reconstruct/space_time/sequences.h"

namespace gradus::solve_tracks_test {
namespace {

using namespace test;

TEST(B2_Tracks, EqualTheDenseSolution) {
  constexpr int w = 7, h = 5, frames = 4, pixels = w * h, unknowns = pixels * frames;
  for (const Motion motion : kMotions) {
    Window window(w, h, 2, frames);
    set_correspondences(&window, motion);
    std::mt19937 random(5);
    std::uniform_real_distribution<float> uniform(0.01f, 2.0f);
    const auto random_fields = [&](int count, int channels) {
      std::vector<reconstruct::Field> fields(size_t(count), reconstruct::Field(w, h, channels));
      for (reconstruct::Field& field : fields) {
        for (int y = 0; y < h; ++y)
          for (int c = 0; c < channels; ++c)
            for (int x = 0; x < w; ++x) field.row(y, c)[x] = uniform(random);
      }
      return fields;
    };
    std::vector<reconstruct::Field> values = random_fields(frames, 2), weights = random_fields(frames, 1);
    const std::vector<reconstruct::Field> differences = random_fields(frames - 1, 1),
                                          couplings = random_fields(frames - 1, 1);
    std::vector<reconstruct::CorrespondenceMap> correspondence;
    for (int t = 0; t + 1 < frames; ++t) correspondence.push_back(reconstruct::read_correspondence(window, t));
    for (const int channel : {0, 1}) {  // the second channel has no differences: they are 0
      Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(unknowns, unknowns);
      Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns);
      for (int i = 0; i < unknowns; ++i) {
        const int t = i / pixels, y = i % pixels / w, x = i % w;
        const double weight = weights[size_t(t)].row(y)[x];
        matrix(i, i) += weight;
        right[i] += weight * values[size_t(t)].row(y, channel)[x];
        const int there = window.correspondence[size_t(t)][size_t(i % pixels)];
        if (t + 1 == frames || there == film::kNoCorrespondence) continue;
        const int j = (t + 1) * pixels + there;
        const double c = couplings[size_t(t)].row(y)[x], d = channel == 0 ? differences[size_t(t)].row(y)[x] : 0.0;
        matrix(i, i) += c;
        matrix(j, j) += c;
        matrix(i, j) -= c;
        matrix(j, i) -= c;
        right[i] -= c * d;
        right[j] += c * d;
      }
      const Eigen::VectorXd expected = matrix.ldlt().solve(right);
      std::vector<reconstruct::Field> x = values, used = weights;
      std::vector<reconstruct::TrackStep> steps;
      for (size_t t = 0; t + 1 < frames; ++t) steps.push_back({correspondence[t], differences[t], couplings[t]});
      reconstruct::solve_tracks(steps, &x, &used);
      for (int i = 0; i < unknowns; ++i) {
        ASSERT_NEAR(x[size_t(i / pixels)].row(i % pixels / w, channel)[i % w], expected[i], 1e-4)
            << i << ", motion " << int(motion);
      }
    }
  }
}

}  // namespace
}  // namespace gradus::solve_tracks_test
