// Voronoi, Musgrave and Gabor textures and wavelengths against their definitions.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "shading/lattice_hash.h"
#include "shading/perlin.h"
#include "shading/program_builder.h"

namespace gradus::test::textures_test {
namespace {

using Point = std::array<double, 4>;

void expect_near(const Rgb& a, const Rgb& b, float tolerance, int id) {
  for (int i = 0; i < 3; i++) EXPECT_NEAR(a[i], b[i], tolerance) << "component " << i << " of case " << id;
}

Point sample_point(int i) { return {0.731 * i - 9.3, 0.377 * i - 4.1, 7.7 - 0.519 * i, 0.293 * i - 2.9}; }

// ------------------------------------------------------------------------------------------------ Voronoi

struct Cell {
  Point point{};  // relative to nothing
  Rgb color = Rgb(0.0f);
};

// The hash of Blender 5.0 on signed numbers of 32 bits, computed in 64 bits.
template <int D>
std::array<double, D> signed_pcg(std::array<int64_t, D> v) {
  const auto wrap = [](int64_t x) { return static_cast<int64_t>(static_cast<int32_t>(static_cast<uint32_t>(x))); };
  const auto mix = [&] {
    if constexpr (D == 2) {
      v[0] = wrap(v[0] + wrap(v[1] * 1664525));
      v[1] = wrap(v[1] + wrap(v[0] * 1664525));
    } else if constexpr (D == 3) {
      for (const int k : {0, 1, 2}) v[k] = wrap(v[k] + wrap(v[(k + 1) % 3] * v[(k + 2) % 3]));
    } else {
      v[0] = wrap(v[0] + wrap(v[1] * v[3]));
      v[1] = wrap(v[1] + wrap(v[2] * v[0]));
      v[2] = wrap(v[2] + wrap(v[0] * v[1]));
      v[3] = wrap(v[3] + wrap(v[1] * v[2]));
    }
  };
  for (int64_t& x : v) x = wrap(x * 1664525 + 1013904223);
  mix();
  for (int64_t& x : v) x ^= x >> 16;
  mix();
  std::array<double, D> out;
  for (int k = 0; k < D; k++) out[k] = static_cast<double>(v[k] & 0x7fffffff) / 2147483647.0;
  return out;
}

Cell float_cell(int dimensions, const std::array<float, 4>& c) {
  using shading::color_hash, shading::float_hash;
  const auto [x, y, z, w] = c;
  switch (dimensions) {
    case 1:
      return {{float_hash(x)}, color_hash(x)};
    case 2:
      return {{float_hash(x, y), float_hash(x, y, 1.0f)}, color_hash(x, y)};
    case 3:
      return {{float_hash(x, y, z), float_hash(x, y, z, 1.0f), float_hash(x, y, z, 2.0f)}, color_hash(x, y, z)};
    default:
      return {{float_hash(x, y, z, w), float_hash(w, x, y, z), float_hash(z, w, x, y), float_hash(y, z, w, x)},
              color_hash(x, y, z, w)};
  }
}

Cell integer_cell(int dimensions, const std::array<int64_t, 4>& c) {
  if (dimensions == 2) {
    const auto point = signed_pcg<2>({c[0], c[1]});
    const auto color = signed_pcg<3>({c[0], c[1], 0});
    return {{point[0], point[1]}, Rgb(color[0], color[1], color[2])};
  }
  if (dimensions == 3) {
    const auto point = signed_pcg<3>({c[0], c[1], c[2]});
    return {{point[0], point[1], point[2]}, Rgb(point[0], point[1], point[2])};
  }
  const auto point = signed_pcg<4>(c);
  return {{point[0], point[1], point[2], point[3]}, Rgb(point[0], point[1], point[2])};
}

struct Texture {
  int dimensions = 3;
  uint32_t metric = GRADUS_VORONOI_EUCLIDEAN;
  uint32_t form = GRADUS_VORONOI_FORM_INTEGERS;
  float randomness = 0.9f;
  float exponent = 1.7f;
  float smoothness = 0.0f;
  float detail = 0.0f, roughness = 1.0f, lacunarity = 1.0f;
  uint32_t normalize = 0;

  Rgb of(uint32_t feature, const Point& p, uint32_t output) const {
    const uint32_t mode = GRADUS_VORONOI_MODE(uint32_t(dimensions), feature, metric, normalize, form);
    const Vec3 v(p[0], p[1], p[2]);
    const float w = static_cast<float>(p[dimensions == 1 ? 0 : 3]);
    return evaluate(GRADUS_OP_VORONOI, {v, w, 1.0f, detail, roughness, lacunarity, smoothness, exponent, randomness},
                    mode, {}, output);
  }
  float distance(uint32_t feature, const Point& p) const { return of(feature, p, 0).x; }

  double length(const Point& a, const Point& b) const {
    double sum = 0.0;
    for (int k = 0; k < dimensions; k++) {
      const double x = std::fabs(a[k] - b[k]);
      if (dimensions == 1 || metric == GRADUS_VORONOI_MANHATTAN)
        sum += x;
      else if (metric == GRADUS_VORONOI_CHEBYCHEV)
        sum = std::max(sum, x);
      else
        sum += std::pow(x, metric == GRADUS_VORONOI_EUCLIDEAN ? 2.0 : exponent);
    }
    if (dimensions == 1 || metric == GRADUS_VORONOI_MANHATTAN || metric == GRADUS_VORONOI_CHEBYCHEV) return sum;
    return std::pow(sum, 1.0 / (metric == GRADUS_VORONOI_EUCLIDEAN ? 2.0 : exponent));
  }

  // Returns the cells whose numbers differ by up to 1 from that of `p`.
  std::vector<Cell> cells(const Point& p) const {
    std::vector<Cell> cells;
    for (int n = 0; n < (dimensions > 3 ? 81 : dimensions > 2 ? 27 : dimensions > 1 ? 9 : 3); n++) {
      std::array<int64_t, 4> number{};
      std::array<float, 4> lower{};
      for (int k = 0, rest = n; k < dimensions; k++, rest /= 3) {
        number[k] = static_cast<int64_t>(std::floor(p[k])) + rest % 3 - 1;
        lower[k] = static_cast<float>(number[k]);
      }
      const bool is_float = dimensions == 1 || form != GRADUS_VORONOI_FORM_INTEGERS;
      Cell cell = is_float ? float_cell(dimensions, lower) : integer_cell(dimensions, number);
      for (int k = 0; k < dimensions; k++) cell.point[k] = static_cast<double>(number[k]) + cell.point[k] * randomness;
      cells.push_back(cell);
    }
    return cells;
  }
};

const std::array<uint32_t, 3> kForms = {GRADUS_VORONOI_FORM_INTEGERS, GRADUS_VORONOI_FORM_FLOATS,
                                        GRADUS_VORONOI_FORM_LIMITED};

TEST(NodeVoronoi, ClosestPointsAreThoseOfTheDefinition) {
  for (int dimensions = 1; dimensions <= 4; dimensions++)
    for (const uint32_t form : kForms)
      for (uint32_t metric = 0; metric < 4; metric++) {
        const Texture t{.dimensions = dimensions, .metric = metric, .form = form};
        for (int i = 0; i < 30; i++) {
          const Point p = sample_point(i);
          std::vector<Cell> cells = t.cells(p);
          std::sort(cells.begin(), cells.end(),
                    [&](const Cell& a, const Cell& b) { return t.length(a.point, p) < t.length(b.point, p); });
          for (const uint32_t feature : {GRADUS_VORONOI_F1, GRADUS_VORONOI_F2}) {
            const Cell& cell = cells[feature];
            EXPECT_NEAR(t.distance(feature, p), t.length(cell.point, p), 1e-5) << dimensions << metric << form;
            expect_near(t.of(feature, p, 1), cell.color, 1e-6f, i);
            if (dimensions > 1)
              expect_near(t.of(feature, p, 2), Rgb(cell.point[0], cell.point[1], cell.point[2]), 2e-6f, i);
            if (dimensions == 1 || dimensions == 4) {
              EXPECT_NEAR(t.of(feature, p, 3).x, cell.point[dimensions - 1], 2e-6);
            }
          }
        }
      }
}

TEST(NodeVoronoi, EdgesAndSpheresAreThoseOfTheDefinition) {
  for (int dimensions = 2; dimensions <= 4; dimensions++) {
    const Texture t{.dimensions = dimensions};
    for (int i = 0; i < 30; i++) {
      const Point p = sample_point(i);
      const std::vector<Cell> cells = t.cells(p);
      const Cell* nearest = &cells[0];
      for (const Cell& cell : cells)
        if (t.length(cell.point, p) < t.length(nearest->point, p)) nearest = &cell;
      double edge = 1e9, gap = 1e9;
      for (const Cell& cell : cells) {
        if (&cell == nearest) continue;
        double along = 0.0;
        for (int k = 0; k < dimensions; k++)
          along += (0.5 * (cell.point[k] + nearest->point[k]) - p[k]) * (cell.point[k] - nearest->point[k]);
        edge = std::min(edge, along / t.length(cell.point, nearest->point));
      }
      for (const Cell& cell : t.cells(nearest->point))
        if (t.length(cell.point, nearest->point) > 0.0) gap = std::min(gap, t.length(cell.point, nearest->point));
      EXPECT_NEAR(t.distance(GRADUS_VORONOI_DISTANCE_TO_EDGE, p), edge, 1e-5) << dimensions;
      EXPECT_NEAR(t.of(GRADUS_VORONOI_N_SPHERE_RADIUS, p, 4).x, 0.5 * gap, 1e-5) << dimensions;
    }
  }
}

TEST(NodeVoronoi, WithoutRandomnessItIsALattice) {
  for (int dimensions = 1; dimensions <= 4; dimensions++) {
    const Texture t{.dimensions = dimensions, .randomness = 0.0f};
    for (int i = 0; i < 30; i++) {
      const Point p = sample_point(i);
      double squared = 0.0, longest = 0.0;
      for (int k = 0; k < dimensions; k++) {
        const double x = std::fabs(p[k] - std::round(p[k]));
        squared += x * x;
        longest = std::max(longest, x);
      }
      EXPECT_NEAR(t.distance(GRADUS_VORONOI_F1, p), std::sqrt(squared), 1e-5);
      EXPECT_NEAR(t.of(GRADUS_VORONOI_N_SPHERE_RADIUS, p, 4).x, 0.5, 1e-6);
      if (dimensions > 1) {
        EXPECT_NEAR(t.distance(GRADUS_VORONOI_DISTANCE_TO_EDGE, p), 0.5 - longest, 1e-5) << dimensions;
      }
    }
  }
}

// In one dimension the edges are those of the point of the cell in which p lies, as in Blender.
TEST(NodeVoronoi, EdgesOnALineAreHalfwayToTheNeighbours) {
  const Texture t{.dimensions = 1};
  for (int i = 0; i < 30; i++) {
    const Point p = sample_point(i);
    const std::vector<Cell> cells = t.cells(p);
    const auto edge = [&](int k) { return std::fabs(0.5 * (cells[1].point[0] + cells[k].point[0]) - p[0]); };
    EXPECT_NEAR(t.distance(GRADUS_VORONOI_DISTANCE_TO_EDGE, p), std::min(edge(0), edge(2)), 1e-5);
  }
}

TEST(NodeVoronoi, SmoothingIsContinuousAndSmall) {
  for (int dimensions = 1; dimensions <= 4; dimensions++)
    for (const uint32_t form : {GRADUS_VORONOI_FORM_INTEGERS, GRADUS_VORONOI_FORM_LIMITED}) {
      Texture t{.dimensions = dimensions, .form = form};
      for (int i = 0; i < 30; i++) {
        Point p = sample_point(i);
        t.smoothness = 0.0f;
        const float closest = t.distance(GRADUS_VORONOI_F1, p);
        EXPECT_EQ(t.distance(GRADUS_VORONOI_SMOOTH_F1, p), closest);
        t.smoothness = 0.4f;
        EXPECT_LE(t.distance(GRADUS_VORONOI_SMOOTH_F1, p), closest + 1e-6f);
        EXPECT_GT(t.distance(GRADUS_VORONOI_SMOOTH_F1, p), closest - 0.4f);
        for (int k = 0; k < dimensions; k++) p[k] = std::round(p[k]) + 1e-5;
        Point q = p;
        for (int k = 0; k < dimensions; k++) q[k] -= 2e-5;
        expect_near(t.of(GRADUS_VORONOI_SMOOTH_F1, p, 1), t.of(GRADUS_VORONOI_SMOOTH_F1, q, 1), 2e-3f, i);
      }
    }
}

TEST(NodeVoronoi, OctavesAreSummedAndNormalized) {
  for (int dimensions = 1; dimensions <= 4; dimensions++)
    for (uint32_t feature = GRADUS_VORONOI_F1; feature <= GRADUS_VORONOI_SMOOTH_F1; feature++) {
      const Texture single{.dimensions = dimensions, .smoothness = 0.3f};
      Texture t = single, whole = single;
      t.detail = 1.5f;  // octaves of weight 1, 1 and 0.5 at the same scale
      whole.normalize = 1;
      const Point p = sample_point(11);
      const float distance = single.distance(feature, p);
      EXPECT_NEAR(t.distance(feature, p), 2.5f * distance, 1e-5f);
      t.normalize = 1;
      EXPECT_NEAR(t.distance(feature, p), whole.distance(feature, p), 1e-6f);
      const float longest = 0.95f * std::sqrt(static_cast<float>(dimensions));
      EXPECT_NEAR(t.distance(feature, p), distance / longest / (feature == GRADUS_VORONOI_F2 ? 2.0f : 1.0f), 1e-6f);
      expect_near(t.of(feature, p, 1), single.of(feature, p, 1), 1e-6f, dimensions);
    }
  Texture t{.lacunarity = 2.0f};
  const Point p = sample_point(5), twice = {2.0 * p[0], 2.0 * p[1], 2.0 * p[2], 0.0};
  const float coarse = t.distance(GRADUS_VORONOI_DISTANCE_TO_EDGE, p);
  const float fine = t.distance(GRADUS_VORONOI_DISTANCE_TO_EDGE, twice) / 2.0f;
  t.detail = 1.0f;
  EXPECT_NEAR(t.distance(GRADUS_VORONOI_DISTANCE_TO_EDGE, p), std::min(coarse, fine), 1e-6f);
}

TEST(NodeVoronoi, DistancesBeforeBlender4EndAt8) {
  Texture t{.dimensions = 4, .metric = GRADUS_VORONOI_MINKOWSKI, .form = GRADUS_VORONOI_FORM_FLOATS, .exponent = 0.1f};
  const Point p = sample_point(7);
  for (const uint32_t feature : {GRADUS_VORONOI_F1, GRADUS_VORONOI_F2, GRADUS_VORONOI_SMOOTH_F1}) {
    t.form = GRADUS_VORONOI_FORM_FLOATS;
    EXPECT_GT(t.distance(feature, p), 100.0f) << feature;
    t.form = GRADUS_VORONOI_FORM_LIMITED;
    EXPECT_EQ(t.distance(feature, p), 8.0f) << feature;
  }
}

TEST(NodeVoronoi, AnyCoordinatesGiveResults) {
  for (const double x : {1e30, -1e30, 3e9, std::numeric_limits<double>::quiet_NaN()})
    for (int dimensions = 1; dimensions <= 4; dimensions++)
      for (uint32_t feature = 0; feature <= GRADUS_VORONOI_N_SPHERE_RADIUS; feature++)
        for (const uint32_t form : kForms) {
          const Texture t{.dimensions = dimensions, .form = form, .smoothness = 0.5f, .detail = 1.5f};
          const Rgb color = t.of(feature, {x, x, x, x}, 1);
          EXPECT_TRUE(std::isnan(x) || (color.x >= -1.0f && color.x <= 3.0f)) << x << dimensions << feature << form;
        }
}

// ------------------------------------------------------------------------------------------------ Musgrave, Gabor

TEST(NodeMusgrave, IsTheNoiseTextureOfOneOctaveLess) {
  const Vec3 p(0.37f, -1.21f, 2.63f);
  for (uint32_t type = GRADUS_NOISE_FBM; type <= GRADUS_NOISE_HETERO_TERRAIN; type++)
    for (uint32_t dimensions = 1; dimensions <= 4; dimensions++) {
      const float lacunarity = 2.2f, dimension = 0.7f, offset = 0.8f, gain = 1.3f;
      const Rgb noise = evaluate(
          GRADUS_OP_NOISE, {p, 0.4f, 1.5f, 2.3f, std::pow(lacunarity, -dimension), lacunarity, offset, gain, 0.0f},
          GRADUS_NOISE_MODE(dimensions, type, 0, 0));
      const Rgb musgrave = evaluate(GRADUS_OP_MUSGRAVE, {p, 0.4f, 1.5f, 3.3f, dimension, lacunarity, offset, gain},
                                    GRADUS_NOISE_MODE(dimensions, type, 0, 0));
      EXPECT_NEAR(musgrave.x, noise.x, 1e-5f) << type << dimensions;
    }
}

TEST(NodeMusgrave, AFractionOfTheFirstOctaveScalesIt) {
  const Vec3 p(0.37f, -1.21f, 2.63f);
  const auto of = [&](uint32_t type, float detail) {
    return evaluate(GRADUS_OP_MUSGRAVE, {p, 0.0f, 1.0f, detail, 2.0f, 2.0f, 0.5f, 1.0f},
                    GRADUS_NOISE_MODE(3, type, 0, 0))
        .x;
  };
  const float noise = shading::signed_noise(p);
  EXPECT_EQ(of(GRADUS_NOISE_FBM, 0.0f), 0.0f);
  EXPECT_NEAR(of(GRADUS_NOISE_FBM, 0.25f), 0.25f * noise, 1e-6f);
  EXPECT_NEAR(of(GRADUS_NOISE_FBM, 1.0f), noise, 1e-6f);
  EXPECT_EQ(of(GRADUS_NOISE_MULTIFRACTAL, 0.0f), 1.0f);
  EXPECT_NEAR(of(GRADUS_NOISE_MULTIFRACTAL, 0.25f), 1.0f + 0.25f * noise, 1e-6f);
  EXPECT_NEAR(of(GRADUS_NOISE_HETERO_TERRAIN, 0.0f), 0.5f + noise, 1e-6f);
}

// Sums the kernels around a point one by one.
TEST(NodeGabor, IsASumOfKernels) {
  using shading::float_hash;
  const float frequency = 2.3f;
  const Vec3 orientation = glm::normalize(Vec3(0.5f, -0.7f, 0.4f));
  for (const float isotropy : {0.0f, 0.6f})
    for (int dimensions = 2; dimensions <= 3; dimensions++)
      for (int i = 0; i < 20; i++) {
        const bool flat = dimensions == 2;
        const Point at = sample_point(i);
        const Vec3 p(at[0], at[1], flat ? 0.0 : at[2]);
        double real = 0.0, imaginary = 0.0;
        for (int n = 0; n < (flat ? 9 : 27) * 8; n++) {
          const int k = n % 8, cell = n / 8;
          const Vec3 c = glm::floor(p) + Vec3(cell % 3 - 1, cell / 3 % 3 - 1, flat ? 0 : cell / 9 - 1);
          const float first = 3.0f * float(k), second = first + 1.0f, third = first + 2.0f;
          const auto pick = [&](float s) { return flat ? float_hash(c.x, c.y, s) : float_hash(c.x, c.y, c.z, s); };
          const Vec3 center =
              flat ? Vec3(pick(second), float_hash(second, c.x, c.y), 0.0f)
                   : Vec3(pick(second), float_hash(c.z, c.x, second, c.y), float_hash(second, c.z, c.y, c.x));
          const Vec3 d = p - c - center;
          const double squared = glm::dot(d, d);
          if (squared >= 1.0) continue;
          Vec3 direction;
          if (flat) {
            const float angle = 0.6f + (pick(first) - 0.5f) * kPi * isotropy;
            direction = Vec3(std::cos(angle), std::sin(angle), 0.0f);
          } else {
            const float theta = std::acos(orientation.z) + pick(first) * kPi * isotropy;
            const float phi =
                std::atan2(orientation.y, orientation.x) + float_hash(c.z, c.x, first, c.y) * kPi * isotropy;
            direction = Vec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
          }
          const double bell = std::exp(-kPi * squared) * (0.5 + 0.5 * std::cos(kPi * squared));
          const double sign = pick(third) < 0.5f ? -1.0 : 1.0;
          const double angle = 2.0 * kPi * frequency * glm::dot(d, direction);
          real += sign * bell * std::cos(angle);
          imaginary += sign * bell * std::sin(angle);
        }
        const double range = flat ? 6.0 : 6.0 * std::sqrt(std::sqrt(0.5));
        const auto of = [&](uint32_t output) {
          return evaluate(GRADUS_OP_GABOR, {p, 1.0f, frequency, 1.0f - isotropy, 0.6f, orientation},
                          static_cast<uint32_t>(dimensions), {}, output)
              .x;
        };
        EXPECT_NEAR(of(0), imaginary / range * 0.5 + 0.5, 1e-5);
        EXPECT_NEAR(of(1), std::atan2(imaginary, real) / (2.0 * kPi) + 0.5, 1e-4);
        EXPECT_NEAR(of(2), std::hypot(real, imaginary) / range, 1e-5);
      }
}

// ------------------------------------------------------------------------------------------------ others

// The sides of a square of radius 1 are at the distance 1 from the origin, and a full rounding makes it a circle.
TEST(NodeRadialTiling, SquaresAndCircles) {
  const auto of = [](const Vec3& p, float sides, float roundness, uint32_t mode, uint32_t output) {
    return evaluate(GRADUS_OP_RADIAL_TILING, {p, sides, roundness}, mode, {}, output);
  };
  const Vec3 first = Vec3(3.0f, 1.0f, 0.0f) / std::sqrt(2.0f);  // in the first quadrant, whose side is diagonal
  expect_near(of(first, 4.0f, 0.0f, 0, 0), Rgb(-1.0f, 1.0f, 0.0f), 1e-5f, 0);
  expect_near(of(first, 4.0f, 0.0f, 1, 0), Rgb(0.25f, 2.0f, 0.0f), 1e-5f, 1);
  expect_near(of(first, 4.0f, 0.0f, 0, 2), Rgb(1.0f), 1e-5f, 2);
  expect_near(of(first, 4.0f, 0.0f, 0, 3), Rgb(0.25f * kPi), 1e-5f, 3);
  const Vec3 third = -first;
  EXPECT_EQ(of(third, 4.0f, 0.0f, 0, 1).x, 2.0f);
  const float angle = std::atan(1.0f / 3.0f) - 0.25f * kPi;
  expect_near(of(third, 4.0f, 1.0f, 0, 0), Rgb(angle, std::sqrt(5.0f) - 1.0f, 0.0f), 1e-5f, 4);
  EXPECT_EQ(of(Vec3(0.0f), 4.5f, 0.5f, 0, 0).x, 0.0f);
}

// Coordinates across the sides are continuous over the corners, those of a shorter side included.
TEST(NodeRadialTiling, SidesMeetAtCorners) {
  for (const float sides : {3.0f, 4.3f, 5.8f})
    for (const float roundness : {0.0f, 0.3f, 0.8f})
      for (int corner = 0; corner <= static_cast<int>(sides); corner++) {
        const float turn = 2.0f * kPi * static_cast<float>(corner) / sides;
        const auto across = [&](float angle) {
          return evaluate(GRADUS_OP_RADIAL_TILING, {Vec3(std::cos(angle), std::sin(angle), 0.0f), sides, roundness}).y;
        };
        EXPECT_NEAR(across(turn - 1e-4f), across(turn + 1e-4f), 1e-3f) << sides << " " << roundness << " " << corner;
      }
}

TEST(NodeWavelength, ColoursOfTheSpectrum) {
  const auto of = [](float nanometres) { return evaluate(GRADUS_OP_WAVELENGTH, {nanometres}); };
  for (const float invisible : {-1e30f, 0.0f, 370.0f, 780.0f, 1e30f}) EXPECT_EQ(of(invisible), Rgb(0.0f)) << invisible;
  const Rgb red = of(650.0f), green = of(535.0f), blue = of(450.0f);
  EXPECT_TRUE(red.x > 0.1f && red.y == 0.0f && red.z == 0.0f);
  EXPECT_TRUE(green.y > 0.3f && green.x == 0.0f && green.y > 3.0f * green.z);
  EXPECT_TRUE(blue.z > 0.3f && blue.y == 0.0f && blue.z > 3.0f * blue.x);
  EXPECT_NEAR(of(602.5f).x, 0.5f * (of(600.0f).x + of(605.0f).x), 1e-6f);
}

}  // namespace
}  // namespace gradus::test::textures_test
