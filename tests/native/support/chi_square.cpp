#include "support/chi_square.h"

#include <algorithm>
#include <numeric>
#include <sstream>

namespace gradus::test {
namespace {

// Returns Q(a, x) = Γ(a, x)/Γ(a): by a series below a + 1, by a continued fraction (Lentz) above.
double upper_gamma(double a, double x) {
  if (x <= 0.0) {
    return 1.0;
  }
  const double scale = std::exp(-x + a * std::log(x) - std::lgamma(a));
  if (x < a + 1.0) {
    double term = 1.0 / a;
    double sum = term;
    for (int n = 1; n < 100000 && term > sum * 1e-15; n++) {
      term *= x / (a + n);
      sum += term;
    }
    return std::max(0.0, 1.0 - scale * sum);
  }
  double b = x + 1.0 - a;
  double c = 1e300;
  double d = 1.0 / b;
  double h = d;
  for (int i = 1; i < 100000; i++) {
    const double an = -i * (i - a);
    b += 2.0;
    d = an * d + b;
    d = 1.0 / (std::abs(d) < 1e-300 ? 1e-300 : d);
    c = b + an / c;
    c = std::abs(c) < 1e-300 ? 1e-300 : c;
    const double step = d * c;
    h *= step;
    if (std::abs(step - 1.0) < 1e-14) {
      break;
    }
  }
  return scale * h;
}

struct Grid {
  Vec3 x;
  Vec3 y;
  Vec3 z;
  int rows;
  int columns;

  Vec3 direction(double theta, double phi) const {
    const double s = std::sin(theta);
    const Vec3 local(static_cast<float>(s * std::cos(phi)), static_cast<float>(s * std::sin(phi)),
                     static_cast<float>(std::cos(theta)));
    return glm::normalize(local.x * x + local.y * y + local.z * z);
  }
  size_t cell(const Vec3& d) const {
    const double theta = std::acos(std::clamp(static_cast<double>(glm::dot(d, z)), -1.0, 1.0));
    double phi = std::atan2(static_cast<double>(glm::dot(d, y)), static_cast<double>(glm::dot(d, x)));
    phi = phi < 0.0 ? phi + 2.0 * M_PI : phi;
    const int row = std::min(rows - 1, static_cast<int>(theta / M_PI * rows));
    const int column = std::min(columns - 1, static_cast<int>(phi / (2.0 * M_PI) * columns));
    return static_cast<size_t>(row * columns + column);
  }
};

Grid make_grid(const ChiSquareOptions& options) {
  const Vec3 z = glm::normalize(options.axis);
  const Vec3 x = glm::normalize(glm::cross(std::abs(z.x) < 0.5f ? Vec3(1, 0, 0) : Vec3(0, 1, 0), z));
  return {x, glm::cross(z, x), z, options.rows, options.columns};
}

// Integrates a cell by 4×4 midpoints, and subdivides it where the four quarters disagree with the whole.
class CellIntegral {
 public:
  CellIntegral(const Grid& grid, const std::function<double(const Vec3&)>& pdf) : grid_(grid), pdf_(pdf) {}
  double integrate(double t0, double t1, double p0, double p1) const {
    return refine(t0, t1, p0, p1, points(t0, t1, p0, p1), 0);
  }
  // Integrates by 64×64 points without subdivision.
  double integrate_fine(double t0, double t1, double p0, double p1) const {
    double sum = 0.0;
    for (int i = 0; i < 16; i++) {
      for (int j = 0; j < 16; j++) {
        sum += points(t0 + (t1 - t0) * i / 16, t0 + (t1 - t0) * (i + 1) / 16, p0 + (p1 - p0) * j / 16,
                      p0 + (p1 - p0) * (j + 1) / 16);
      }
    }
    return sum;
  }

 private:
  double points(double t0, double t1, double p0, double p1) const {
    double sum = 0.0;
    for (int i = 0; i < 4; i++) {
      for (int j = 0; j < 4; j++) {
        const double theta = t0 + (t1 - t0) * (i + 0.5) / 4;
        sum += pdf_(grid_.direction(theta, p0 + (p1 - p0) * (j + 0.5) / 4)) * std::sin(theta);
      }
    }
    return sum * (t1 - t0) * (p1 - p0) / 16;
  }
  double refine(double t0, double t1, double p0, double p1, double whole, int depth) const {
    const double tm = 0.5 * (t0 + t1);
    const double pm = 0.5 * (p0 + p1);
    const double a = points(t0, tm, p0, pm);
    const double b = points(t0, tm, pm, p1);
    const double c = points(tm, t1, p0, pm);
    const double d = points(tm, t1, pm, p1);
    const double sum = a + b + c + d;
    if (depth >= 6 || std::abs(sum - whole) <= std::max(2e-7, 1e-3 * sum)) {
      return sum;
    }
    return refine(t0, tm, p0, pm, a, depth + 1) + refine(t0, tm, pm, p1, b, depth + 1) +
           refine(tm, t1, p0, pm, c, depth + 1) + refine(tm, t1, pm, p1, d, depth + 1);
  }
  const Grid& grid_;
  const std::function<double(const Vec3&)>& pdf_;
};

void add_text(ChiSquareResult* result, const std::string& problem) { result->text += problem + "; "; }

}  // namespace

ChiSquareResult chi_square_counts(const std::vector<double>& observed, const std::vector<double>& expected,
                                  size_t sample_count, size_t invalid, int tests) {
  ChiSquareResult result;
  double pooled_expected = 0.0;
  double pooled_observed = 0.0;
  int cells = 0;
  for (size_t i = 0; i < observed.size(); i++) {
    result.mass += expected[i] / static_cast<double>(sample_count);
    if (expected[i] <= 0.0) {
      result.zero_density_samples += static_cast<size_t>(observed[i]);
    } else if (expected[i] < 5.0) {
      pooled_expected += expected[i];
      pooled_observed += observed[i];
    } else {
      const double difference = observed[i] - expected[i];
      result.statistic += difference * difference / expected[i];
      cells++;
    }
  }
  if (pooled_expected >= 5.0) {
    result.statistic += (pooled_observed - pooled_expected) * (pooled_observed - pooled_expected) / pooled_expected;
    cells++;
  }
  result.degrees_of_freedom = cells - 1;
  if (result.degrees_of_freedom > 0) {
    result.p_value = upper_gamma(0.5 * result.degrees_of_freedom, 0.5 * result.statistic);
  }
  const double level = 1.0 - std::pow(1.0 - 0.01, 1.0 / tests);
  const double tolerated = std::max(1e-5 * static_cast<double>(sample_count), 1.0);
  if (invalid > 0) add_text(&result, std::to_string(invalid) + " samples or densities are not valid");
  if (!(result.mass <= 1.01)) add_text(&result, "the density has mass " + std::to_string(result.mass));
  if (result.degrees_of_freedom < 1) add_text(&result, "fewer than one degree of freedom");
  if (static_cast<double>(result.zero_density_samples) > tolerated) {
    add_text(&result, std::to_string(result.zero_density_samples) + " samples where the density is 0");
  }
  if (!(result.p_value >= level)) add_text(&result, "p below the level");
  result.passed = result.text.empty();
  std::ostringstream numbers;
  numbers << "chi2 " << result.statistic << ", " << result.degrees_of_freedom << " degrees of freedom, p "
          << result.p_value << ", mass " << result.mass;
  result.text += numbers.str();
  return result;
}

ChiSquareResult chi_square_sphere(const std::function<bool(const Vec2&, const Vec2&, Vec3*)>& sample,
                                  const std::function<double(const Vec3&)>& pdf, const ChiSquareOptions& options) {
  const Grid grid = make_grid(options);
  const size_t cells = static_cast<size_t>(options.rows) * static_cast<size_t>(options.columns);
  std::vector<double> observed(cells, 0.0);
  std::vector<double> expected(cells, 0.0);
  size_t invalid = 0;
  Random random(options.seed);
  for (size_t i = 0; i < options.samples; i++) {
    Vec3 direction;
    const Vec2 u = random.get2();
    if (!sample(u, random.get2(), &direction)) {
      continue;
    }
    if (!is_finite(direction) || std::abs(glm::length(direction) - 1.0f) > 1e-4f) {
      invalid++;
      continue;
    }
    observed[grid.cell(direction)] += 1.0;
  }
  const std::function<double(const Vec3&)> checked = [&](const Vec3& direction) {
    const double value = pdf(direction);
    if (!(value >= 0.0) || !std::isfinite(value)) {
      invalid++;
      return 0.0;
    }
    return value;
  };
  const CellIntegral integral(grid, checked);
  const double dt = M_PI / options.rows;
  const double dp = 2.0 * M_PI / options.columns;
  const auto at = [&](int row, int column) { return static_cast<size_t>(row * options.columns + column); };
  for (int row = 0; row < options.rows; row++) {
    for (int column = 0; column < options.columns; column++) {
      expected[at(row, column)] = integral.integrate(dt * row, dt * (row + 1), dp * column, dp * (column + 1));
    }
  }
  // The edge of a density's support may cut a cell between all of its points: cells next to those that are not empty
  // are integrated more finely.
  const std::vector<double> first = expected;
  for (int row = 0; row < options.rows; row++) {
    for (int column = 0; column < options.columns; column++) {
      const bool beside = (row > 0 && first[at(row - 1, column)] > 0.0) ||
                          (row + 1 < options.rows && first[at(row + 1, column)] > 0.0) ||
                          first[at(row, (column + 1) % options.columns)] > 0.0 ||
                          first[at(row, (column + options.columns - 1) % options.columns)] > 0.0;
      if (beside && first[at(row, column)] <= 0.0) {
        expected[at(row, column)] = integral.integrate_fine(dt * row, dt * (row + 1), dp * column, dp * (column + 1));
      }
    }
  }
  for (double& cell : expected) {
    cell *= static_cast<double>(options.samples);
  }
  return chi_square_counts(observed, expected, options.samples, invalid, options.tests);
}

}  // namespace gradus::test
