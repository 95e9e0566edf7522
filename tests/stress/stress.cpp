#include "stress/stress.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "render/render.h"
#include "schema/options.h"
#include "schema/pass_table.h"
#include "support/developed.h"
#include "support/double_image.h"

namespace gradus::stress {

namespace {

struct CauseInfo {
  const char* name;
  uint64_t film::Counters::*count;
};
constexpr CauseInfo kCauseInfo[kCauses] = {
    {"missed", &film::Counters::fail_missed},    {"occluded", &film::Counters::fail_occluded},
    {"class", &film::Counters::fail_class},      {"total refl.", &film::Counters::fail_total_reflection},
    {"side", &film::Counters::fail_side},        {"density", &film::Counters::fail_density},
    {"jacobian", &film::Counters::fail_jacobian}};

struct Row {
  std::string name, note;
  film::Counters counters;
};

// Prints the rows when all tests have run.
class Table : public ::testing::Environment {
 public:
  std::vector<Row> rows;

  void TearDown() override {
    if (rows.empty()) return;
    std::printf(
        "\nFailed shifts of 1000, by cause; samples that were dropped; difference to double over its bound\n%-40s %9s",
        "case", "shifts");
    for (const CauseInfo& cause : kCauseInfo) std::printf(" %11s", cause.name);
    std::printf(" %8s %8s %8s  %s\n", "radiance", "gradient", "feature", "double");
    for (const Row& row : rows) print(row);
  }

 private:
  static void print(const Row& row) {
    const film::Counters& c = row.counters;
    std::printf("%-40s %9llu", row.name.c_str(), static_cast<unsigned long long>(c.shifts_attempted));
    for (const CauseInfo& cause : kCauseInfo) {
      std::printf(" %11.2f",
                  c.shifts_attempted > 0 ? 1000.0 * double(c.*cause.count) / double(c.shifts_attempted) : 0.0);
    }
    std::printf(" %8llu %8llu %8llu  %s\n", static_cast<unsigned long long>(c.nonfinite_radiance),
                static_cast<unsigned long long>(c.nonfinite_gradient),
                static_cast<unsigned long long>(c.nonfinite_feature), row.note.c_str());
  }
};

Table& table() {
  static Table* const instance =
      static_cast<Table*>(::testing::AddGlobalTestEnvironment(new Table));  // GoogleTest deletes it
  return *instance;
}
// Test environments must be registered before the tests start.
[[maybe_unused]] const Table& kTable = table();

void check(const film::Counters& c, const Bounds& bounds) {
  for (int i = 0; i < kCauses; ++i) {
    EXPECT_LE(double(c.*kCauseInfo[i].count), bounds.failed[size_t(i)] * double(c.shifts_attempted))
        << kCauseInfo[i].name;
  }
  EXPECT_LE(c.nonfinite_radiance + c.nonfinite_gradient + c.nonfinite_feature, bounds.dropped);
}

std::vector<float> read(const render::Render& render, uint32_t pass, const GradusSettings& settings) {
  std::vector<float> pixels(size_t(settings.width) * settings.height * schema::pass_info(pass).channels);
  render.read_pass(pass, pixels.data(), pixels.size());
  return pixels;
}

double compare_with_double(const integrator::IntegratorContext& context) {
  const double worst = test::render_in_double(context, context.settings.samples).worst();
  EXPECT_TRUE(std::isfinite(worst));
  return worst;
}

}  // namespace

Bounds Bounds::alone() {
  Bounds b;
  b.failed = {0.25, 0.01, 0.1, 0.03, 0.01, 0.03, 0.0};
  return b;
}

Bounds Bounds::dropping(uint64_t samples) const {
  Bounds b = *this;
  b.dropped = samples;
  return b;
}

Bounds Bounds::without_double() const {
  Bounds b = *this;
  b.from_double = -1.0;
  return b;
}

double mean(const std::vector<float>& rgba) {
  double sum = 0.0;
  for (size_t i = 0; i < rgba.size(); ++i) sum += i % 4 < 3 ? double(rgba[i]) : 0.0;
  return sum / (0.75 * double(rgba.size()));
}

double difference(const std::vector<float>& a, const std::vector<float>& b) {
  double squares = 0.0;
  for (size_t i = 0; i < a.size(); ++i) squares += std::pow(double(a[i]) - b[i], 2);
  return std::sqrt(squares / (0.75 * double(a.size()))) / mean(b);
}

std::string text_of(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

void expect_finite(const std::vector<float>& values, const std::string& what) {
  const auto bad = std::count_if(values.begin(), values.end(), [](float v) { return !std::isfinite(v); });
  EXPECT_EQ(bad, 0) << what;
}

GradusSettings small_picture() {
  GradusSettings s = schema::default_settings();
  s.width = full_run() ? 40 : 24;
  s.height = full_run() ? 30 : 18;
  s.samples = full_run() ? 32 : 16;
  s.noise_threshold = 0.0f;
  s.denoiser = GRADUS_DENOISER_NONE;
  s.max_bounces = s.diffuse_bounces = s.glossy_bounces = s.transmission_bounces = 32;
  s.integrator = GRADUS_INTEGRATOR_GRADIENT;
  s.reconstruction = GRADUS_RECONSTRUCTION_L2;
  s.passes = (uint64_t{1} << GRADUS_PASS_COUNT) - 1;
  return s;
}

Outcome render(const std::string& name, PathScene* scene, const Bounds& bounds, GradusSettings settings) {
  SCOPED_TRACE(name);
  const integrator::IntegratorContext context = scene->context(settings);
  render::Render render(test::test_device(), context.snapshot, settings);
  EXPECT_TRUE(render.wait(-1.0));
  std::string text;
  EXPECT_EQ(render.outcome(&text), GRADUS_OK) << text;
  for (uint32_t pass = 0; pass < GRADUS_PASS_COUNT; ++pass) {
    expect_finite(read(render, pass, settings), schema::pass_info(pass).name);
  }
  Outcome outcome;
  outcome.noisy = read(render, GRADUS_PASS_NOISY_IMAGE, settings);
  outcome.l2 = read(render, GRADUS_PASS_COMBINED, settings);
  const auto film = render.film();
  const std::vector<float> l1 = test::reconstructed(film, GRADUS_RECONSTRUCTION_L1, film->region);
  expect_finite(l1, "L1");
  outcome.counters = film->counters;
  check(outcome.counters, bounds);
  const double from_double = bounds.from_double < 0.0 ? 0.0 : compare_with_double(context);
  if (bounds.from_double >= 0.0) {
    EXPECT_LE(from_double, bounds.from_double) << "difference to double";
  }
  enter_row(name, outcome.counters, bounds.from_double >= 0.0 ? text_of(from_double) : "-");
  return outcome;
}

void enter_row(const std::string& name, const film::Counters& counters, const std::string& note) {
  table().rows.push_back({name, note, counters});
}

void build_box(PathScene* scene) {
  test::add_box(scene, test::matte(Rgb(0.6f)));
  test::add_ceiling_light(scene, 4.0f, 1.0f);
  scene->ball(Vec3(0.4f, -0.7f, 0.4f), 0.3f, scene->material(test::matte(Rgb(0.5f))), 6);
  scene->ball(Vec3(-0.4f, -0.6f, -0.3f), 0.4f, scene->material(test::glossy(0.4f)), 12, true);
  scene->ball(Vec3(-0.3f, -0.7f, 0.5f), 0.3f, scene->material(test::glass(0.0f)), 12, true);
  const float scale = scene->place[0][0];
  const Vec3 centre = Vec3(scene->place * Vec4(0.5f, 0.3f, 0.3f, 1.0f));
  GradusLight light = test::make_light(GRADUS_LIGHT_POINT, test::translation(centre), Rgb(0.3f * scale * scale));
  light.radius = 0.1f * scale;
  scene->light(light);
  scene->camera_desc.clip_start *= scale;
  scene->camera_desc.clip_end *= scale;
}

void build_furnace(PathScene* scene, const Surface& ball) {
  scene->world(Rgb(1.0f));
  scene->ball(Vec3(0.0f), 1.0f, scene->material(ball), 24, true);
  scene->camera(Vec3(0, 0, 4), Vec3(0.0f), 0.8f);
}

}  // namespace gradus::stress
