// The system of a window and its solver against matrices that are written down row by row.
#include <gtest/gtest.h>
#include <Eigen/Dense>

#include "reconstruct/space_time/sequences.h"
#include "reconstruct/space_time/solve_window.h"
#include "reconstruct/space_time/weigh_uniformly.h"

namespace gradus::system_test {
namespace {

using namespace test;

// Sets random weights of four decades.
void weigh_at_random(reconstruct::SpaceTimeSystem* system) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> exponent(-2.0f, 2.0f);
  std::vector<float> row(static_cast<size_t>(system->width()));
  for (const reconstruct::RowKind kind : reconstruct::kRowKinds) {
    for (int t = 0; t + int(reconstruct::is_temporal(kind)) < system->frames(); ++t) {
      for (int y = 0; y < system->height(); ++y) {
        for (float& weight : row) weight = std::pow(10.0f, exponent(random));
        system->set_weights(kind, t, y, row.data());
      }
    }
  }
}

double weight(reconstruct::SpaceTimeSystem* system, reconstruct::RowKind kind, int t, int x, int y) {
  std::vector<float> row(static_cast<size_t>(system->width()));
  system->weights(kind, t).read_row(y, row.data());
  const double factor = kind == reconstruct::RowKind::kPrimal ? system->frame(t).factor : 1.0;
  return factor * row[size_t(x)];
}

// AᵀWA and AᵀWb of channel 0, from the definition of the rows.
struct Dense {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd right_side;
};
Dense write_down(const Window& window, reconstruct::SpaceTimeSystem* system) {
  const auto [w, h, channels, frames] = window.size_;
  const int n = w * h * frames;
  Dense dense{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
  window.for_rows([&](reconstruct::RowKind kind, int t, int x, int y, const Window::Terms& terms) {
    const double weight_of_row = weight(system, kind, t, x, y);
    const double value = window.plane(kind, t)[size_t((y * w + x) * channels)];
    for (const auto& [i, a] : terms) {
      dense.right_side(i) += weight_of_row * a * value;
      for (const auto& [j, b] : terms) dense.matrix(i, j) += weight_of_row * a * b;
    }
  });
  return dense;
}

Eigen::VectorXd to_vector(const reconstruct::Frames& frames, int channel = 0) {
  const int w = frames.front().width(), h = frames.front().height();
  Eigen::VectorXd v(w * h * int(frames.size()));
  for (size_t t = 0; t < frames.size(); ++t) {
    for (int y = 0; y < h; ++y) {
      for (int x = 0; x < w; ++x) v((int(t) * h + y) * w + x) = frames[t].row(y, channel)[x];
    }
  }
  return v;
}

reconstruct::Frames random_frames(const reconstruct::SpaceTimeSystem& system, int channels, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  reconstruct::Frames frames = system.make_fields(channels);
  for (reconstruct::Field& field : frames) {
    for (int y = 0; y < field.height(); ++y) {
      for (int c = 0; c < channels; ++c) {
        for (int x = 0; x < field.width(); ++x) field.row(y, c)[x] = normal(random);
      }
    }
  }
  return frames;
}

Window random_window(int w, int h, int channels, int frames, Motion motion) {
  Window window(w, h, channels, frames);
  set_correspondences(&window, motion);
  unsigned seed = 1;
  for (auto& kind : window.planes) {
    for (auto& plane : kind) add_noise(&plane, 1.0f, seed++);
  }
  return window;
}

TEST(B2_SpaceTime, SystemIsTheOneThatItsRowsDefine) {
  for (const Motion motion : kMotions) {
    const Window window = random_window(13, 9, 2, 4, motion);
    reconstruct::SpaceTimeSystem system(window);
    weigh_at_random(&system);
    const Dense dense = write_down(window, &system);
    const reconstruct::Frames x = random_frames(system, 1, 3);
    reconstruct::Frames product = system.make_fields(1), right_side = product;
    const double energy = system.multiply(x, &product)[0];
    system.right_side(window, 0, &right_side);
    const Eigen::VectorXd v = to_vector(x), expected = dense.matrix * v;
    EXPECT_LT((to_vector(product) - expected).norm(), 1e-5 * expected.norm()) << int(motion);
    EXPECT_NEAR(energy, v.dot(expected), 1e-5 * energy);
    EXPECT_LT((to_vector(right_side) - dense.right_side).norm(), 1e-5 * dense.right_side.norm());
  }
}

TEST(B2_SpaceTime, ProductIsSymmetric) {
  for (const Motion motion : kMotions) {
    reconstruct::SpaceTimeSystem system(random_window(70, 140, 1, 5, motion));
    weigh_at_random(&system);
    const reconstruct::Frames a = random_frames(system, 1, 2), b = random_frames(system, 1, 3);
    reconstruct::Frames pa = system.make_fields(1), pb = pa;
    const double aa = system.multiply(a, &pa)[0], bb = system.multiply(b, &pb)[0];
    EXPECT_NEAR(to_vector(a).dot(to_vector(pb)), to_vector(b).dot(to_vector(pa)), 1e-5 * (aa + bb)) << int(motion);
  }
}

TEST(B2_TimeLadder, IsSymmetricAndPositive) {
  for (const Motion motion : kMotions) {
    const Window window = random_window(33, 17, 1, 5, motion);
    reconstruct::SpaceTimeSystem system(window);
    weigh_at_random(&system);
    reconstruct::TimeLadder ladder(system, 1);
    ladder.update();
    const reconstruct::Frames a = random_frames(system, 1, 2), b = random_frames(system, 1, 3);
    reconstruct::Frames za = system.make_fields(1), zb = za;
    double aa = 0.0, bb = 0.0;
    for (const RowSums& sums : ladder.apply(a, &za)) aa += sums.total()[0];
    for (const RowSums& sums : ladder.apply(b, &zb)) bb += sums.total()[0];
    EXPECT_GT(aa, 0.0);
    EXPECT_NEAR(aa, to_vector(a).dot(to_vector(za)), 1e-5 * aa);
    EXPECT_NEAR(to_vector(a).dot(to_vector(zb)), to_vector(b).dot(to_vector(za)), 1e-4 * (aa + bb)) << int(motion);
  }
}

struct Solved {
  reconstruct::Frames x;
  reconstruct::CgReport report;
};
Solved solve(const Window& window, reconstruct::SpaceTimeSystem* system, float residual, int max_steps = 100) {
  const int channels = window.size_.channels;
  reconstruct::TimeLadder ladder(*system, channels);
  ladder.update();
  Solved solved{system->make_fields(channels), {}};
  reconstruct::WindowFields fields(solved.x);
  system->right_side(window, 0, &fields.r);
  solved.report =
      reconstruct::solve_window(*system, &ladder, {.residual = residual}, max_steps, never, &fields, &solved.x);
  return solved;
}

TEST(B2_SpaceTime, SolverFindsTheDenseSolution) {
  for (const Motion motion : kMotions) {
    for (const bool alike : {true, false}) {
      const Window window = random_window(11, 8, 3, 4, motion);
      reconstruct::SpaceTimeSystem system(window);
      alike ? reconstruct::weigh_uniformly(window, 0.2f, &system) : weigh_at_random(&system);
      const Dense dense = write_down(window, &system);
      const Eigen::LLT<Eigen::MatrixXd> factors(dense.matrix);
      EXPECT_EQ(factors.info(), Eigen::Success) << "not positive definite";
      const Eigen::VectorXd expected = factors.solve(dense.right_side);
      const Solved solved = solve(window, &system, 1e-6f);
      EXPECT_TRUE(solved.report.reached);
      EXPECT_LT((to_vector(solved.x) - expected).norm(), 1e-4 * expected.norm()) << int(motion) << " " << alike;
    }
  }
}

// Conjugate gradients with a diagonal preconditioner take 60 to 200 steps for these systems.
TEST(B2_SpaceTime, TakesFewStepsForAnyMotion) {
  for (const Motion motion : kMotions) {
    const Window window = random_window(320, 180, 1, 10, motion);
    reconstruct::SpaceTimeSystem system(window);
    reconstruct::weigh_uniformly(window, 0.4f, &system);
    const int coarse = solve(window, &system, 1e-4f).report.steps, fine = solve(window, &system, 1e-6f).report.steps;
    EXPECT_LE(coarse, 8) << int(motion);
    EXPECT_LE(fine, 14) << int(motion);
  }
}

}  // namespace
}  // namespace gradus::system_test
