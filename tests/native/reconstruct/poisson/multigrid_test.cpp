// The preconditioner of the L1 solver: the properties that conjugate gradients require, and its convergence.
#include <gtest/gtest.h>

#include "reconstruct/poisson/conjugate_gradient.h"
#include "reconstruct/poisson/l1_weights.h"
#include "reconstruct/poisson/weighted_least_squares.h"
#include "reconstruct/test_images.h"

namespace gradus::multigrid_test {
namespace {

using test::never;

constexpr int kSizes[][2] = {{1, 1}, {1, 7}, {7, 1}, {2, 3}, {33, 17}, {160, 90}};

reconstruct::Field random_field(int width, int height, int channels, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  reconstruct::Field field(width, height, channels);
  for (int y = 0; y < height; ++y) {
    for (int c = 0; c < channels; ++c) {
      for (int x = 0; x < width; ++x) field.row(y, c)[x] = normal(random);
    }
  }
  return field;
}

// Fills in difference weights of three decades in random order, as for a noisy image.
void fill(reconstruct::Stencil* a) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> exponent(-0.5f, 2.5f);
  const int w = a->width(), h = a->height();
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      a->right.row(y)[x] = x + 1 < w ? std::pow(10.0f, exponent(random)) : 0.0f;
      a->up.row(y)[x] = y + 1 < h ? std::pow(10.0f, exponent(random)) : 0.0f;
    }
  }
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      a->diagonal.row(y)[x] =
          0.02f + a->right.row(y)[x] + a->right.row(y)[x - 1] + a->up.row(y)[x] + a->up.row(y - 1)[x];
    }
  }
}

double dot(const reconstruct::Field& a, const reconstruct::Field& b) {
  double sum = 0.0;
  for (int y = 0; y < a.height(); ++y) sum += dot_row(a.row(y), b.row(y), a.width());
  return sum;
}

reconstruct::Field product(const reconstruct::Stencil& a, const reconstruct::Field& x) {
  reconstruct::Field result(x.width(), x.height(), 1);
  for (int y = 0; y < x.height(); ++y) reconstruct::apply_row(a, x, y, 0, result.row(y));
  return result;
}

reconstruct::Field interpolated(const reconstruct::Interpolation& p, const reconstruct::Field& coarse, int width,
                                int height) {
  reconstruct::Field fine(width, height, 1);
  std::vector<float> row(size_t(width) + 1);
  for (int y = 0; y < height; ++y) {
    p.interpolate_row(y, coarse.row(y / 2), coarse.row(y / 2 + 1), row.data());
    std::copy_n(row.begin(), width, fine.row(y));
  }
  return fine;
}

reconstruct::Field restricted(const reconstruct::Interpolation& p, const reconstruct::Field& fine) {
  reconstruct::Field coarse((fine.width() + 1) / 2, (fine.height() + 1) / 2, 1);
  for (int y = 0; y < coarse.height(); ++y) {
    p.restrict_rows(y, fine.row(2 * y - 1), fine.row(2 * y), fine.row(2 * y + 1), coarse.row(y));
  }
  return coarse;
}

// Two levels: the matrix of the first has no diagonal neighbours, that of the second has.
TEST(B2_Multigrid, CoarseMatrixIsTheFineOneBetweenInterpolations) {
  for (const auto& [w, h] : kSizes) {
    reconstruct::Stencil fine(w, h, false);
    fill(&fine);
    for (int level = 0; level < 2; ++level) {
      const int fw = fine.width(), fh = fine.height(), cw = (fw + 1) / 2, ch = (fh + 1) / 2;
      reconstruct::Interpolation p(fw, fh);
      p.update(fine);
      reconstruct::Stencil coarse(cw, ch, true);
      p.coarsen(fine, &coarse);
      const reconstruct::Field u = random_field(cw, ch, 1, 2), v = random_field(cw, ch, 1, 3);
      const reconstruct::Field pu = interpolated(p, u, fw, fh), pv = interpolated(p, v, fw, fh);
      const double scale = dot(u, product(coarse, u)) + dot(v, product(coarse, v));
      EXPECT_NEAR(dot(u, product(coarse, v)), dot(pu, product(fine, pv)), 1e-5 * scale)
          << w << "x" << h << " level " << level;
      EXPECT_NEAR(dot(u, product(coarse, u)), dot(pu, product(fine, pu)), 1e-5 * scale)
          << w << "x" << h << " level " << level;
      const reconstruct::Field f = random_field(fw, fh, 1, 4);
      EXPECT_NEAR(dot(u, restricted(p, f)), dot(pu, f), 1e-5 * (dot(f, f) + dot(u, u)));
      fine = coarse;
    }
  }
}

// Returns the pixels of a row with x + y even, next to each other.
std::vector<float> red_of(const reconstruct::Field& field, int y) {
  std::vector<float> red;
  for (int x = y & 1; x < field.width() + (y & 1); x += 2)
    red.push_back(y >= 0 && y < field.height() ? field.row(y)[x] : 0.0f);
  return red;
}

TEST(B2_Multigrid, RedPixelsAreThoseOfTheWholeGrid) {
  for (const auto& [w, h] : kSizes) {
    reconstruct::Stencil fine(w, h, false);
    fill(&fine);
    reconstruct::Interpolation p(w, h);
    p.update(fine);
    const int cw = (w + 1) / 2, ch = (h + 1) / 2;
    const reconstruct::Field coarse = random_field(cw, ch, 1, 2), whole = interpolated(p, coarse, w, h);
    reconstruct::Field residual = random_field(w, h, 1, 3);
    for (int y = 0; y < h; ++y) {
      for (int x = 1 - (y & 1); x < w; x += 2) residual.row(y)[x] = 0.0f;
    }
    const reconstruct::Field expected = restricted(p, residual);
    p.keep_red();
    for (int y = 0; y < h; ++y) {
      std::vector<float> red(static_cast<size_t>(cw), 0.0f);
      p.add_to_red_row(y, coarse.row(y / 2), coarse.row(y / 2 + 1), red.data());
      const std::vector<float> there = red_of(whole, y);
      for (int i = 0; i < w / 2; ++i) EXPECT_NEAR(red[size_t(i)], there[size_t(i)], 1e-6) << w << "x" << h;
    }
    for (int y = 0; y < ch; ++y) {
      std::vector<float> out(static_cast<size_t>(cw)), below{0.0f}, above{0.0f};
      const std::vector<float> under = red_of(residual, 2 * y - 1), here = red_of(residual, 2 * y),
                               over = red_of(residual, 2 * y + 1);
      below.insert(below.end(), under.begin(), under.end());  // readable one pixel to the left
      above.insert(above.end(), over.begin(), over.end());
      p.restrict_red_rows(y, below.data() + 1, here.data(), above.data() + 1, out.data());
      for (int x = 0; x < cw; ++x) EXPECT_NEAR(out[size_t(x)], expected.row(y)[x], 1e-5) << w << "x" << h;
    }
  }
}

TEST(B2_Multigrid, CycleIsSymmetricAndPositive) {
  for (const auto& [w, h] : kSizes) {
    reconstruct::Multigrid multigrid(w, h, 1);
    fill(&multigrid.matrix());
    multigrid.update();
    const reconstruct::Field a = random_field(w, h, 1, 2), b = random_field(w, h, 1, 3);
    reconstruct::Field za(w, h, 1), zb(w, h, 1);
    const double aa = multigrid.cycle(a, &za).total()[0], bb = multigrid.cycle(b, &zb).total()[0];
    EXPECT_GT(aa, 0.0);
    EXPECT_NEAR(aa, dot(a, za), 1e-5 * aa);
    EXPECT_NEAR(dot(a, zb), dot(b, za), 1e-4 * (aa + bb)) << w << "x" << h;
  }
}

reconstruct::CgReport solve_without_order(int max_steps) {
  constexpr int w = 320, h = 180;
  reconstruct::Multigrid multigrid(w, h, 1);
  fill(&multigrid.matrix());
  multigrid.update();
  const reconstruct::Field b = random_field(w, h, 1, 2);
  reconstruct::Field x(w, h, 1);
  reconstruct::CgFields fields(w, h, 1);
  return reconstruct::conjugate_gradient(&multigrid, b, &x, &fields, {.residual = 1e-4f}, max_steps, never);
}

// An aggregation of 2×2 pixels whose weights are those of the fine differences in series, which is weaker than the fine
// matrix at jumps of the weights, took 136 steps.
TEST(B2_Multigrid, RandomWeightsTakeFewSteps) {
  const reconstruct::CgReport report = solve_without_order(200);
  EXPECT_LE(report.steps, 40);
  EXPECT_TRUE(report.reached);
  EXPECT_LE(report.residual, 1e-4f);
}

// A solve that reaches its limit reports that, and its residual.
TEST(B2_Multigrid, TheLimitOfStepsIsReported) {
  reconstruct::SolveReport total;
  reconstruct::add_solve(solve_without_order(2), &total);
  EXPECT_EQ(total.inner_steps, 2);
  EXPECT_TRUE(total.hit_cap);
  EXPECT_GT(total.residual, 1e-4f);
}

}  // namespace
}  // namespace gradus::multigrid_test
