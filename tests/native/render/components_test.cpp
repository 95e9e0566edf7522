// Components of a render are planned by the content of the scene, reconstructed and read by name. They add up to
// Combined.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "base/error.h"
#include "film/features.h"
#include "film_io/store.h"
#include "motion/component_motion.h"
#include "reconstruct/reconstruct_film.h"
#include "render/resume.h"
#include "render/scene_render.h"
#include "schema/options.h"
#include "schema/pass_table.h"
#include "support/refusal.h"

namespace gradus::components_test {
namespace {

using test::PathScene;
using test::rendered;
using test::Scenario;
using test::started;

constexpr uint32_t kSide = 40;
constexpr uint32_t kAllPasses = (1u << GRADUS_COMPONENT_PASS_COUNT) - 1;

GradusSettings settings_with(const std::string& components, uint32_t reconstruction = GRADUS_RECONSTRUCTION_L2) {
  GradusSettings settings = test::test_settings(kSide, kSide);
  settings.independent_sampler = 0;
  settings.samples = 8;
  settings.net_samples = 8;  // also of tests that take fewer
  settings.threads = 2;
  settings.integrator = GRADUS_INTEGRATOR_GRADIENT;
  settings.reconstruction = reconstruction;
  settings.use_decomposition = 1;
  settings.component_passes = kAllPasses;
  schema::set_text(&settings, *schema::find_option("components"), components);
  return settings;
}

std::vector<float> combined(const render::Render& render) {
  std::vector<float> rgba(4 * kSide * kSide);
  render.read_pass(GRADUS_PASS_COMBINED, rgba.data(), rgba.size());
  return rgba;
}

std::vector<float> component(const render::Render& render, const std::string& name,
                             uint32_t pass = GRADUS_COMPONENT_COLOR) {
  std::vector<float> values(schema::component_pass_info(pass).channels * kSide * kSide);
  render.read_component(name, pass, values.data(), values.size());
  return values;
}

double sum_of(const std::vector<float>& values) {
  double sum = 0.0;
  for (const float value : values) sum += value;
  return sum;
}

const char* const kDefaultNames[] = {"Emission", "Diffuse", "Reflection", "Transmission", "Residual"};

std::string sampled_components(const render::Render& render) { return film::component_names(*render.film()); }

class Modes : public testing::TestWithParam<uint32_t> {};

TEST_P(Modes, ComponentsAddUpToCombined) {
  GradusSettings settings = settings_with("", GetParam());
  settings.film_exposure = 1.7f;
  if (GetParam() == GRADUS_RECONSTRUCTION_NONE) settings.integrator = GRADUS_INTEGRATOR_PATH;
  const auto render = rendered(Scenario::Glass, settings);
  const std::vector<float> rgba = combined(*render);
  std::vector<float> sum(3 * kSide * kSide), magnitude(sum);
  int lit = 0;
  for (const char* const name : kDefaultNames) {
    const std::vector<float> part = component(*render, name);
    for (size_t i = 0; i < part.size(); ++i) {
      sum[i] += part[i];
      magnitude[i] += std::fabs(part[i]);
    }
    lit += sum_of(part) > 1.0 ? 1 : 0;
  }
  EXPECT_GE(lit, 3);
  for (size_t i = 0; i < sum.size(); ++i) ASSERT_NEAR(sum[i], rgba[i / 3 * 4 + i % 3], 2e-6f * (magnitude[i] + 1.0f));
}

INSTANTIATE_TEST_SUITE_P(Components, Modes,
                         testing::Values(uint32_t{GRADUS_RECONSTRUCTION_NONE}, uint32_t{GRADUS_RECONSTRUCTION_L2},
                                         uint32_t{GRADUS_RECONSTRUCTION_L1},
                                         uint32_t{GRADUS_RECONSTRUCTION_REGULARIZED}));

// L2 has the same weights everywhere: separately reconstructed components add up to the picture of one component.
TEST(Components, OfL2AddUpToThePictureOfOne) {
  GradusSettings settings = settings_with("Once=E.L;Twice=E..L");
  const auto many = rendered(Scenario::Glass, settings);
  settings.use_decomposition = 0;
  settings.component_passes = 0;
  const auto one = rendered(Scenario::Glass, settings);
  const std::vector<float> a = combined(*many), b = combined(*one);
  const float scale = *std::max_element(b.begin(), b.end());
  for (size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], b[i], 1e-5f * scale) << i;
}

TEST(Components, ThatNoSurfaceCanMakeAreNotSampled) {
  const auto matte = rendered(Scenario::DiffuseArea, settings_with(""));
  EXPECT_EQ(sampled_components(*matte), "Emission, Diffuse");
  EXPECT_NE(matte->stats_json().find("\"components Reflection, Transmission, Residual\""), std::string::npos)
      << matte->stats_json();
  EXPECT_EQ(sum_of(component(*matte, "Reflection")), 0.0);
  const auto mirror = rendered(Scenario::Mirror, settings_with(""));
  EXPECT_EQ(sampled_components(*mirror), "Emission, Diffuse, Reflection, Residual");
  EXPECT_EQ(sampled_components(*rendered(Scenario::Glass, settings_with(""))),
            "Emission, Diffuse, Reflection, Transmission, Residual");
  // Components of a user's own set are removed in the same way, but none that may get light.
  EXPECT_EQ(
      sampled_components(*rendered(Scenario::DiffuseArea, settings_with("Caustic=ED+(R|T).*L;Rare=EDDDDDDDDDDDDL"))),
      "Rare, Residual");
}

// Builds a room with a mirror that shows its ceiling, or lies behind a wall.
void build_room_with_mirror(PathScene* scene, float size, float z) {
  test::add_box(scene, test::matte(Rgb(0.6f)));
  test::add_ceiling_light(scene, 20.0f, 0.5f);
  scene->quad(Vec3(-0.5f * size, -0.5f * size, z), Vec3(size, 0, 0), Vec3(0, size, -0.5f * size),
              scene->material(test::glossy(0.0f)));
}

GradusSettings light_alone(const std::string& components) {
  GradusSettings settings = settings_with(components, GRADUS_RECONSTRUCTION_REGULARIZED);
  settings.component_passes = 1u << GRADUS_COMPONENT_COLOR;
  return settings;
}

TEST(Components, ThatAreSmallEverywhereBelongToResidual) {
  PathScene hidden;
  build_room_with_mirror(&hidden, 0.5f, -1.5f);  // behind the wall of the box
  const auto render = rendered(&hidden, light_alone(""));
  EXPECT_EQ(sampled_components(*render), "Emission, Diffuse, Residual");
  EXPECT_NE(render->stats_json().find("\"components Reflection\":\"automatic: "), std::string::npos)
      << render->stats_json();
  EXPECT_EQ(sum_of(component(*render, "Reflection")), 0.0);
  const std::vector<float> rgba = combined(*render), diffuse = component(*render, "Diffuse"),
                           emission = component(*render, "Emission"), residual = component(*render, "Residual");
  for (size_t i = 0; i < diffuse.size(); ++i) {
    ASSERT_NEAR(diffuse[i] + emission[i] + residual[i], rgba[i / 3 * 4 + i % 3],
                2e-6f * (rgba[i / 3 * 4 + i % 3] + 1.0f));
  }
}

TEST(Components, ThatAreSmallAreKeptWhereTheyMayBeNeeded) {
  PathScene hidden, seen;
  build_room_with_mirror(&hidden, 0.5f, -1.5f);
  build_room_with_mirror(&seen, 0.1f, 0.0f);  // a few pixels
  const char* const kAll = "Emission, Diffuse, Reflection, Residual";
  EXPECT_EQ(sampled_components(*rendered(&seen, light_alone(""))), kAll);
  EXPECT_EQ(sampled_components(*rendered(&hidden, light_alone(std::string(lpe::kDefaultComponents)))), kAll)
      << "a user's own set";
  GradusSettings with_normals = light_alone("");
  with_normals.component_passes |= 1u << GRADUS_COMPONENT_NORMAL;
  EXPECT_EQ(sampled_components(*rendered(&hidden, with_normals)), kAll);
}

// Films of farms are merged, borders are compared with the full frame, and renders are resumed: the decision must be
// the same.
TEST(Components, ThatAreSmallAreSoInEveryPartOfTheWork) {
  PathScene hidden;
  build_room_with_mirror(&hidden, 0.5f, -1.5f);
  GradusSettings settings = light_alone("");
  const auto whole = rendered(&hidden, settings);
  settings.samples = 4;
  settings.threads = 1;
  const auto early = rendered(&hidden, settings);
  settings.first_sample = 4;
  settings.seed = 3;
  EXPECT_EQ(sampled_components(*rendered(&hidden, settings)), sampled_components(*whole));
  settings.seed = 0;
  settings.first_sample = 0;
  settings.samples = 8;
  render::Render more(test::test_device(), hidden.context(settings).snapshot, settings, early->film());
  ASSERT_TRUE(more.wait(-1.0));
  EXPECT_EQ(combined(more), combined(*whole));
  EXPECT_EQ(component(more, "Residual"), component(*whole, "Residual"));
  const uint32_t part[] = {0, 0, 8, 8};
  std::copy_n(part, 4, settings.region);
  EXPECT_EQ(film::component_names(*rendered(&hidden, settings)->film()), sampled_components(*whole));
}

// All components are small then; Residual alone remains.
TEST(Components, OfADarkSceneAreResidual) {
  PathScene scene;
  scene.quad(Vec3(-1, -1, 0), Vec3(2, 0, 0), Vec3(0, 2, 0), scene.material(test::matte(Rgb(0.5f))));
  scene.camera(Vec3(0, 0, 3), Vec3(0), 0.3f);
  const auto render = rendered(&scene, light_alone(""));
  EXPECT_EQ(sampled_components(*render), "Residual");
  for (const char* const name : kDefaultNames) EXPECT_EQ(sum_of(component(*render, name)), 0.0) << name;
}

TEST(Components, CostNothingUnlessRequested) {
  GradusSettings settings = settings_with("");
  settings.use_decomposition = 0;
  const auto render = rendered(Scenario::Glass, settings);
  EXPECT_EQ(render->film()->components.size(), 1u);
  EXPECT_TRUE(render->film()->components[0].non_specular[0].empty());
  EXPECT_THROW(component(*render, "Diffuse"), Error);
}

TEST(Components, InvalidSetsEndTheRenderWithTheReason) {
  PathScene scene;
  test::build(Scenario::DiffuseArea, &scene);
  for (const char* const set : {"Broken=E(DL", "A=EDL;B=E.L", "NotALetter=EXL"}) {
    const GradusSettings settings = settings_with(set);
    const auto snapshot = scene.context(settings).snapshot;
    try {
      render::Render render(test::test_device(), snapshot, settings);
      ADD_FAILURE() << set;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), GRADUS_ERROR_INVALID_ARGUMENT) << set;
    }
  }
}

TEST(Components, UnknownNamesAndSizesAreRefused) {
  const auto render = rendered(Scenario::DiffuseArea, settings_with(""));
  EXPECT_THROW(component(*render, "Difuse"), Error);
  std::vector<float> few(7);
  EXPECT_THROW(render->read_component("Diffuse", GRADUS_COMPONENT_COLOR, few.data(), few.size()), Error);
  EXPECT_THROW(render->read_component("Diffuse", GRADUS_COMPONENT_PASS_COUNT, few.data(), few.size()), Error);
}

// A wall of albedo 0.3 and its image in a mirror.
TEST(Components, HaveTheSurfacesThatTheirPathsMeetFirst) {
  PathScene scene;
  const uint64_t wall = scene.material(test::matte(Rgb(0.3f, 0.5f, 0.7f)));
  scene.quad(Vec3(-1, -1, 0), Vec3(1, 0, 0), Vec3(0, 2, 0), wall);
  scene.quad(Vec3(0, -1, 0), Vec3(1, 0, 0), Vec3(0, 2, 0), scene.material(test::glossy(0.0f)));
  scene.quad(Vec3(-9, -9, 6), Vec3(0, 18, 0), Vec3(18, 0, 0), scene.material(test::matte(Rgb(0.9f, 0.2f, 0.1f))));
  scene.light(test::make_light(GRADUS_LIGHT_POINT, test::translation(Vec3(0, 0, 2.0f)), Rgb(40.0f)));
  scene.camera(Vec3(0, 0, 3), Vec3(0), 0.3f);
  const auto render = rendered(&scene, settings_with(""));
  const std::vector<float> own = component(*render, "Diffuse", GRADUS_COMPONENT_REFLECTANCE);
  const std::vector<float> behind = component(*render, "Reflection", GRADUS_COMPONENT_REFLECTANCE);
  const std::vector<float> facing = component(*render, "Reflection", GRADUS_COMPONENT_NORMAL);
  const size_t left = 3 * (20 * kSide + 10), right = 3 * (20 * kSide + 30);
  EXPECT_NEAR(own[left + 1], 0.5f, 1e-5f);
  EXPECT_EQ(own[right + 1], 0.0f);
  EXPECT_EQ(behind[left], 0.0f);
  EXPECT_NEAR(behind[right], 0.9f, 1e-5f);
  EXPECT_NEAR(facing[right + 2], -1.0f, 1e-5f);
  const std::vector<float> near = component(*render, "Diffuse", GRADUS_COMPONENT_DEPTH),
                           far = component(*render, "Reflection", GRADUS_COMPONENT_DEPTH);
  EXPECT_NEAR(near[left / 3], 3.0f, 0.05f);
  EXPECT_NEAR(far[right / 3], 9.0f, 0.1f) << "to the mirror and back past the camera";
  EXPECT_EQ(near[right / 3], 1e10f);
  EXPECT_EQ(far[left / 3], 1e10f);
  // Irradiance · reflectance is the colour; for black surfaces the irradiance is the colour itself.
  const std::vector<float> color = component(*render, "Diffuse"),
                           light = component(*render, "Diffuse", GRADUS_COMPONENT_IRRADIANCE);
  EXPECT_GT(color[left], 0.0f);
  EXPECT_NEAR(light[left + 2] * 0.7f, color[left + 2], 1e-5f * color[left + 2]);
  EXPECT_EQ(light[right], color[right]);
}

// Adds a quad with u along a and v along b, face 3 of its mesh.
void add_mapped_quad(PathScene* scene, const Vec3& corner, const Vec3& a, const Vec3& b, const test::Surface& surface) {
  test::Soup soup;
  soup.triangle(corner, corner + a, corner + a + b);
  soup.triangle(corner, corner + a + b, corner + b);
  const float uv[] = {0, 0, 1, 0, 1, 1, 0, 0, 1, 1, 0, 1};
  const int32_t faces[] = {3, 3};
  GradusAttribute map{};
  map.struct_size = sizeof(map);
  map.domain = GRADUS_DOMAIN_CORNER;
  map.channels = 2;
  map.is_uv = 1;
  map.name = "UVMap";
  map.data = uv;
  test::MeshDesc mesh(soup);
  mesh.desc.attributes = &map;
  mesh.desc.attribute_count = 1;
  mesh.desc.triangle_faces = faces;
  mesh.desc.face_count = 4;
  const uint64_t material = scene->material(surface), key = 1000 + material;
  scene->scene.scene.set_mesh(key, mesh.desc);
  scene->scene.instance(key, Mat4(1.0f), GRADUS_VISIBLE_ALL, material);
}

constexpr uint32_t kDetails = 1u << GRADUS_COMPONENT_UV | 1u << GRADUS_COMPONENT_OBJECT_INDEX |
                              1u << GRADUS_COMPONENT_FACE_INDEX | 1u << GRADUS_COMPONENT_EMIT;

GradusSettings details_settings() {
  GradusSettings settings = settings_with("", GRADUS_RECONSTRUCTION_NONE);
  settings.component_passes = kDetails;
  settings.film_exposure = 1.5f;
  return settings;
}

// Values of the passes of a component in a pixel.
struct Shown {
  Vec3 uv, emit;
  float object, face;
};

Shown shown_at(const render::Render& render, const std::string& name, size_t pixel) {
  const auto values = [&](uint32_t pass) { return component(render, name, pass); };
  const std::vector<float> uv = values(GRADUS_COMPONENT_UV), emit = values(GRADUS_COMPONENT_EMIT);
  const auto vec = [&](const std::vector<float>& v) { return Vec3(v[3 * pixel], v[3 * pixel + 1], v[3 * pixel + 2]); };
  return {vec(uv), vec(emit), values(GRADUS_COMPONENT_OBJECT_INDEX)[pixel], values(GRADUS_COMPONENT_FACE_INDEX)[pixel]};
}

void expect_shown(const Shown& found, const Shown& expected) {
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(found.uv[c], expected.uv[c], 0.005f);
    EXPECT_NEAR(found.emit[c], expected.emit[c], 1e-5f);
  }
  EXPECT_EQ(found.object, expected.object);
  EXPECT_EQ(found.face, expected.face);
}

const Shown kNothingShown{Vec3(0.0f), Vec3(0.0f), 0.0f, -1.0f};

// A dim wall and a mirror, each with a map and an index of its own; the mirror shows an emissive wall behind the
// camera.
TEST(Components, HaveTheMapsIndicesAndEmissionOfTheSurfacesTheyShow) {
  PathScene scene;
  test::Surface dim = test::matte(Rgb(0.3f)), mirror = test::glossy(0.0f), screen = test::matte(Rgb(0.9f));
  dim.emission = Rgb(0.25f);
  mirror.glossy = Rgb(0.5f);
  screen.emission = Rgb(2.0f, 1.0f, 0.5f);
  scene.scene.pass_index = 4;
  add_mapped_quad(&scene, Vec3(-1, -1, 0), Vec3(1, 0, 0), Vec3(0, 2, 0), dim);
  scene.scene.pass_index = 7;
  add_mapped_quad(&scene, Vec3(0, -1, 0), Vec3(1, 0, 0), Vec3(0, 2, 0), mirror);
  scene.scene.pass_index = 9;
  add_mapped_quad(&scene, Vec3(-9, -9, 6), Vec3(0, 18, 0), Vec3(18, 0, 0), screen);
  scene.camera(Vec3(0, 0, 3), Vec3(0), 0.3f);
  const auto render = rendered(&scene, details_settings());
  const size_t left = 20 * kSide + 10, right = 20 * kSide + 30;
  const float x = 0.3f * (30.5f / kSide - 0.5f),
              y = 0.3f * (20.5f / kSide - 0.5f);  // of the ray to `right`, by distance
  expect_shown(shown_at(*render, "Reflection", right),
               {Vec3(0.5f + y / 2.0f, 0.5f + x / 2.0f, 1), 1.5f * Vec3(2, 1, 0.5f), 9, 3});
  expect_shown(shown_at(*render, "Diffuse", right), kNothingShown);
  const Vec3 map_of_left(1.0f - 0.9f * (0.5f - 10.5f / kSide), 0.5f + 0.45f * (20.5f / kSide - 0.5f), 1);
  const Shown wall{map_of_left, Vec3(0.375f), 4, 3};
  expect_shown(shown_at(*render, "Diffuse", left), wall);
  expect_shown(shown_at(*render, "Emission", left), wall);  // the wall is emissive
  expect_shown(shown_at(*render, "Reflection", left), kNothingShown);
  expect_shown(shown_at(*render, "Transmission", left), kNothingShown);
  EXPECT_TRUE(render->film()->components[0].non_specular[0].empty()) << "not requested";
}

// For directly visible emitters, the emission is the picture: a light before another one, and both before the world.
TEST(Components, EmissionOfADirectlyVisibleEmitterIsItsLight) {
  PathScene scene;
  scene.world(Rgb(0.25f, 0.5f, 0.1f));
  for (const float z : {0.0f, -1.0f}) {
    const Mat4 towards_the_camera = test::translation(Vec3(0, 0, z)) * test::scaling(Vec3(1, -1, -1));
    scene.light(test::make_light(GRADUS_LIGHT_RECTANGLE, towards_the_camera, Rgb(3.0f, 2.0f, 1.0f)));
  }
  scene.camera(Vec3(0, 0, 3), Vec3(0), 0.6f);
  GradusSettings settings = details_settings();
  settings.component_passes |= 1u << GRADUS_COMPONENT_COLOR;
  const auto render = rendered(&scene, settings);
  const std::vector<float> color = component(*render, "Emission"),
                           emit = component(*render, "Emission", GRADUS_COMPONENT_EMIT);
  for (size_t i = 0; i < color.size(); ++i) ASSERT_NEAR(emit[i], color[i], 1e-5f * color[i]) << i;
  const size_t middle = 20 * kSide + 20;
  const float lit = color[3 * middle], world = color[0];
  EXPECT_NEAR(world, 0.375f, 1e-5f);
  EXPECT_GT(lit, 2.0f * world);
}

// Regression: lights and the sky got the distance of the mirror that showed them, or of the camera.
TEST(Components, EmittersHaveTheirOwnDistance) {
  PathScene scene;
  scene.world(Rgb(0.25f, 0.5f, 0.1f));
  scene.light(test::make_light(GRADUS_LIGHT_RECTANGLE,
                               test::translation(Vec3(0, 0, -1)) * test::scaling(Vec3(1, -1, -1)), Rgb(3.0f)));
  scene.quad(Vec3(-0.5f, -0.5f, 0.0f), Vec3(0.5f, 0, 0), Vec3(0, 1, 0),
             scene.material(test::glossy(0.0f)));  // on the left
  scene.camera(Vec3(0, 0, 3), Vec3(0), 0.3f);
  GradusSettings settings = settings_with("", GRADUS_RECONSTRUCTION_NONE);
  const auto render = rendered(&scene, settings);
  const std::vector<float> seen = component(*render, "Emission", GRADUS_COMPONENT_DEPTH),
                           mirrored = component(*render, "Reflection", GRADUS_COMPONENT_DEPTH);
  const size_t left = 20 * kSide + 10, right = 20 * kSide + 21;
  EXPECT_NEAR(seen[right], 4.0f, 0.1f) << "the light";
  EXPECT_EQ(seen[left], 1e10f) << "hidden by the mirror";
  EXPECT_EQ(mirrored[left], 1e10f) << "the sky";
  EXPECT_GT(sum_of(component(*render, "Reflection")), 1.0);
}

// Regression: a lit and emissive surface was counted twice: its normal had half its length, and its reflectance was a
// mean of albedo and light.
TEST(Components, AnEmissiveSurfaceIsCountedOnce) {
  PathScene scene;
  test::Surface screen = test::matte(Rgb(0.3f));
  screen.emission = Rgb(0.25f, 0.5f, 8.0f);
  scene.quad(Vec3(-1, -1, 0), Vec3(2, 0, 0), Vec3(0, 2, 0), scene.material(screen));
  scene.camera(Vec3(0, 0, 3), Vec3(0), 0.3f);
  const auto render = rendered(&scene, settings_with("All=E.*L", GRADUS_RECONSTRUCTION_NONE));
  const size_t middle = 20 * kSide + 20;
  const std::vector<float> normal = component(*render, "All", GRADUS_COMPONENT_NORMAL),
                           reflectance = component(*render, "All", GRADUS_COMPONENT_REFLECTANCE);
  EXPECT_NEAR(normal[3 * middle + 2], 1.0f, 1e-5f);
  EXPECT_NEAR(reflectance[3 * middle], 0.55f, 1e-5f);
  EXPECT_NEAR(reflectance[3 * middle + 2], 1.0f, 1e-5f);
  EXPECT_NEAR(component(*render, "All", GRADUS_COMPONENT_DEPTH)[middle], 3.0f, 0.05f);
}

// Regression: negative light became black, or only its components did.
TEST(Components, AddUpBelowZero) {
  PathScene scene;
  test::add_box(&scene, test::matte(Rgb(0.6f)));
  scene.light(test::make_light(GRADUS_LIGHT_POINT, test::translation(Vec3(0, 0, 0.5f)), Rgb(-2.0f)));
  for (const uint32_t reconstruction :
       {GRADUS_RECONSTRUCTION_NONE, GRADUS_RECONSTRUCTION_L2, GRADUS_RECONSTRUCTION_REGULARIZED}) {
    const auto render = rendered(&scene, settings_with("Direct=EDL;Indirect=EDD+L", reconstruction));
    const std::vector<float> rgba = combined(*render), direct = component(*render, "Direct"),
                             indirect = component(*render, "Indirect");
    EXPECT_LT(*std::min_element(rgba.begin(), rgba.end()), -0.01f) << reconstruction;
    for (size_t i = 0; i < direct.size(); ++i) {
      const float whole = rgba[i / 3 * 4 + i % 3];
      ASSERT_NEAR(direct[i] + indirect[i], whole, 1e-5f * (1.0f + std::fabs(whole))) << reconstruction;
    }
  }
}

// Glass reflects few of the samples of a pixel, and the first of them is rarely the pixel's first sample.
TEST(Components, IndicesAreThoseOfTheFirstSampleThatMetAnObject) {
  PathScene scene;
  test::build(Scenario::Glass, &scene);
  GradusSettings settings = details_settings();
  const auto found = [&](uint32_t samples) {
    settings.samples = samples;
    return component(*rendered(&scene, settings), "Transmission", GRADUS_COMPONENT_FACE_INDEX);
  };
  const std::vector<float> one = found(1), eight = found(8);
  size_t more = 0;
  for (size_t i = 0; i < one.size(); ++i) {
    ASSERT_TRUE(one[i] < 0.0f || one[i] == eight[i]);
    more += one[i] < 0.0f && eight[i] >= 0.0f ? 1 : 0;
  }
  EXPECT_GT(more, 20u);
}

// The order of merging does not matter.
TEST(Components, IndicesOfMergedFilmsAreThoseOfTheWhole) {
  PathScene scene;
  test::build(Scenario::Glass, &scene);
  GradusSettings settings = details_settings();
  const auto details = [](const film::Film& film) {
    return film.components[size_t(film::find_component(film, "Transmission"))].details;
  };
  const auto whole = details(*rendered(&scene, settings)->film());
  settings.samples = 4;
  const auto early = rendered(&scene, settings)->film();
  settings.first_sample = 4;
  const auto late = rendered(&scene, settings)->film();
  size_t others = 0;
  for (const auto& [to, from] : {std::pair{early, late}, {late, early}}) {
    film::Film merged = *to;
    render::merge_films(&merged, *from);
    const auto found = details(merged);
    for (size_t i = 0; i < whole.size(); ++i) {
      ASSERT_EQ(found[i].object, whole[i].object);
      ASSERT_EQ(found[i].face, whole[i].face) << i;
      ASSERT_EQ(found[i].sample, whole[i].sample) << i;
      ASSERT_EQ(found[i].segments, whole[i].segments);
      others += details(*late)[i].face != whole[i].face ? 1 : 0;
    }
  }
  EXPECT_GT(others, 20u);
}

TEST(Components, AreKeptInFilmsAndResumed) {
  PathScene scene;
  test::build(Scenario::Glass, &scene);
  GradusSettings settings = settings_with("");
  const auto whole = rendered(&scene, settings);
  settings.samples = 4;
  const auto first = rendered(&scene, settings);
  const std::string path = testing::TempDir() + "gradus_components.exr";
  film_io::save_film(*first->film(), path);
  const std::shared_ptr<const film::Film> stored = film_io::load_film(path);
  EXPECT_EQ(film::component_names(*stored), film::component_names(*first->film()));
  EXPECT_EQ(stored->components[1].expression, "ED.*L");
  for (size_t c = 0; c < stored->components.size(); ++c) {
    EXPECT_EQ(stored->components[c].primal, first->film()->components[c].primal);
    EXPECT_EQ(stored->components[c].gradient, first->film()->components[c].gradient);
    const auto &non_specular = stored->components[c].non_specular[1],
               &kept = first->film()->components[c].non_specular[1];
    ASSERT_EQ(non_specular.size(), kept.size());
    EXPECT_EQ(std::memcmp(non_specular.data(), kept.data(), non_specular.size() * sizeof(film::NonSpecularVertices)),
              0);
    const auto &details = stored->components[c].details, &kept_details = first->film()->components[c].details;
    ASSERT_EQ(details.size(), kept_details.size());
    EXPECT_EQ(std::memcmp(details.data(), kept_details.data(), details.size() * sizeof(film::NonSpecularDetails)), 0);
  }
  settings.samples = 8;
  render::Render more(test::test_device(), scene.context(settings).snapshot, settings, stored);
  ASSERT_TRUE(more.wait(-1.0));
  EXPECT_EQ(combined(more), combined(*whole));
  for (const uint32_t pass :
       {GRADUS_COMPONENT_COLOR, GRADUS_COMPONENT_NORMAL, GRADUS_COMPONENT_FACE_INDEX, GRADUS_COMPONENT_EMIT}) {
    EXPECT_EQ(component(more, "Transmission", pass), component(*whole, "Transmission", pass));
  }
  // A film with other components is refused.
  const GradusSettings others = settings_with("Direct=EDL");
  EXPECT_THROW(render::Render(test::test_device(), scene.context(others).snapshot, others, stored), Error);
}

// Its passes would hold half of the samples.
TEST(Components, DoNotResumeFilmsWithoutTheirSurfaces) {
  PathScene scene;
  test::build(Scenario::DiffuseArea, &scene);
  for (const uint32_t pass : {GRADUS_COMPONENT_NORMAL, GRADUS_COMPONENT_UV}) {
    GradusSettings settings = settings_with("");
    settings.component_passes = 1u << GRADUS_COMPONENT_COLOR;
    settings.samples = 4;
    const auto first = rendered(&scene, settings)->film();
    settings.component_passes |= 1u << pass;
    settings.samples = 8;
    EXPECT_THROW(render::Render(test::test_device(), scene.context(settings).snapshot, settings, first), Error) << pass;
    settings.samples = 4;
    settings.first_sample = 4;
    film::Film merged = *first;
    EXPECT_THROW(render::merge_films(&merged, *rendered(&scene, settings)->film()), Error) << pass;
  }
}

TEST(Components, OfDifferentSetsAreNotMerged) {
  film::Film a(4, 4, {0, 0, 4, 4}, 3, 2, false), b = a;
  a.components[0].name = "Diffuse";
  b.components[0].name = "Direct";
  b.samples.add({0, 1});
  const std::string refusal = test::refusal_of([&] { render::merge_films(&a, b); });
  EXPECT_NE(refusal.find("Direct"), std::string::npos) << refusal;
}

constexpr uint32_t kMotionPasses = 1u << GRADUS_COMPONENT_MOTION | 1u << GRADUS_COMPONENT_TRACKED;

// Rotates the camera from frame to frame.
void turn_camera(scene::Snapshot* snapshot) {
  std::copy_n(snapshot->camera.matrix, 16, snapshot->camera.matrix_previous);
  snapshot->camera.matrix_previous[12] -= 0.05f;
}

TEST(Components, ReportTheirMotion) {
  PathScene scene;
  test::build(Scenario::Glass, &scene);
  GradusSettings settings = settings_with("");
  settings.component_passes = kMotionPasses;
  const integrator::IntegratorContext context = scene.context(settings);
  auto moved = std::make_shared<scene::Snapshot>(*context.snapshot);
  turn_camera(moved.get());
  render::Render render(test::test_device(), moved, settings);
  render.wait(-1.0);
  const lpe::ComponentSet set = lpe::ComponentSet::parse("");
  const Region region{0, 0, int32_t(kSide), int32_t(kSide)};
  const auto expected = motion::component_motion(*moved, settings, set, lpe::kEveryComponent, region);
  float farthest = 0.0f;
  for (int c = 0; c < set.count(); ++c) {
    if (film::find_component(*render.film(), set[c].name) < 0) continue;
    const std::vector<float> vectors = component(render, set[c].name, GRADUS_COMPONENT_MOTION);
    const std::vector<float> tracked = component(render, set[c].name, GRADUS_COMPONENT_TRACKED);
    for (size_t i = 0; i < tracked.size(); ++i) {
      const float found = expected[size_t(c)].tracked[i];
      const bool by_flow = set[c].name == lpe::kResidual && found == motion::kTracked;  // by flow between two frames
      ASSERT_EQ(tracked[i], by_flow ? motion::kNoNeighbour : found) << set[c].name;
      for (size_t k = 0; k < 4; ++k)
        ASSERT_EQ(vectors[4 * i + k], expected[size_t(c)].vectors[i][int(k)]) << set[c].name;
      farthest = std::max(farthest, std::fabs(vectors[4 * i]));
    }
  }
  EXPECT_GT(farthest, 0.2f);
}

// ThreadSanitizer sees the vectors move into the film while progress() adds up their sizes, unless both take the lock.
TEST(Components, ProgressCountsTheirMotionWhileItIsFound) {
  PathScene scene;
  test::build(Scenario::DiffuseArea, &scene);
  GradusSettings settings = settings_with("");
  settings.component_passes = kMotionPasses;
  const auto render = started(&scene, settings);
  while (!render->wait(0.0)) render->progress();
  ASSERT_EQ(render->outcome(nullptr), GRADUS_OK);
  const auto film = render->film();
  for (const film::ComponentPlanes& planes : film->components)
    EXPECT_EQ(planes.motion.size(), size_t{kSide} * kSide) << planes.name;
  EXPECT_GE(render->progress().memory_bytes, film->memory_bytes());
}

// Regression: if no paths remained for Residual, the last component of the set was treated as Residual: it got the
// motion of the mirror, marked as tracked.
TEST(Components, OfSetsWithoutResidualReportTheMotionOfTheReflectedObject) {
  PathScene scene;
  test::build(Scenario::Mirror, &scene);
  const auto motion_of = [&](const std::string& set, const std::string& name, uint32_t pass) {
    GradusSettings settings = settings_with(set);
    settings.component_passes = kMotionPasses;
    auto moved = std::make_shared<scene::Snapshot>(*scene.context(settings).snapshot);
    turn_camera(moved.get());
    render::Render render(test::test_device(), moved, settings);
    render.wait(-1.0);
    EXPECT_EQ(film::find_component(*render.film(), std::string(lpe::kResidual)) >= 0, set.empty());
    return component(render, name, pass);
  };
  const std::string set = "Matte=E(D.*)?L;Shiny=E(R|T).*L";
  const std::vector<float> tracked = motion_of(set, "Shiny", GRADUS_COMPONENT_TRACKED),
                           expected_tracked = motion_of("", "Reflection", GRADUS_COMPONENT_TRACKED),
                           vectors = motion_of(set, "Shiny", GRADUS_COMPONENT_MOTION),
                           expected = motion_of("", "Reflection", GRADUS_COMPONENT_MOTION);
  size_t both = 0;
  for (size_t i = 0; i < tracked.size(); ++i) {
    if (expected_tracked[i] == film::kNothingToTrack) {
      ASSERT_NE(tracked[i], motion::kTracked) << "nothing is mirrored there";
    }
    if (tracked[i] != motion::kTracked || expected_tracked[i] != motion::kTracked) continue;
    ++both;
    for (size_t k = 0; k < 4; ++k) ASSERT_NEAR(vectors[4 * i + k], expected[4 * i + k], 1e-3f);
  }
  EXPECT_GT(both, 100u);
}

TEST(Components, AMissingOneIsNotTracked) {
  GradusSettings settings = settings_with("Nothing=ETTTTTTL");
  settings.component_passes = kMotionPasses;
  const auto render = rendered(Scenario::DiffuseArea, settings);
  ASSERT_EQ(film::find_component(*render->film(), "Nothing"), -1);
  for (const float value : component(*render, "Nothing", GRADUS_COMPONENT_TRACKED))
    ASSERT_EQ(value, film::kNothingToTrack);
  for (const float value : component(*render, "Nothing", GRADUS_COMPONENT_MOTION)) ASSERT_EQ(value, 0.0f);
}

TEST(Components, MotionThatWasNotRequestedIsRefused) {
  GradusSettings settings = settings_with("");
  settings.component_passes = 1u << GRADUS_COMPONENT_COLOR;
  const auto render = rendered(Scenario::Glass, settings);
  std::vector<float> values(kSide * kSide);
  EXPECT_THROW(render->read_component("Diffuse", GRADUS_COMPONENT_TRACKED, values.data(), values.size()), Error);
}

TEST(Components, MotionIsStoredWithTheFilm) {
  GradusSettings settings = settings_with("");
  settings.component_passes = kMotionPasses;
  const auto film = rendered(Scenario::Glass, settings)->film();
  const std::string path =
      (std::filesystem::temp_directory_path() / ("gradus_motion_" + std::to_string(getpid()) + ".exr")).string();
  film_io::save_film(*film, path);
  const auto back = film_io::load_film(path);
  std::filesystem::remove(path);
  ASSERT_FALSE(film->components[0].motion.empty());
  EXPECT_TRUE(film->components[0].shown.empty()) << "of animations alone";
  for (size_t c = 0; c < film->components.size(); ++c) {
    EXPECT_EQ(back->components[c].motion, film->components[c].motion);
    EXPECT_EQ(back->components[c].tracked, film->components[c].tracked);
  }
}

// Data for passes are sampled only if the passes are requested.
TEST(Components, KeepNoSurfacesUnlessPassesShowThem) {
  GradusSettings settings = settings_with("", GRADUS_RECONSTRUCTION_REGULARIZED);
  settings.component_passes = 1u << GRADUS_COMPONENT_COLOR;
  const auto film = rendered(Scenario::Glass, settings)->film();
  for (const film::ComponentPlanes& planes : film->components)
    EXPECT_TRUE(planes.non_specular[0].empty() && planes.details.empty());
  settings.component_passes = 1u << GRADUS_COMPONENT_NORMAL;
  const auto render = rendered(Scenario::Glass, settings);
  for (const film::ComponentPlanes& planes : render->film()->components)
    EXPECT_TRUE(!planes.non_specular[0].empty() && planes.details.empty());
  EXPECT_THROW(component(*render, "Diffuse", GRADUS_COMPONENT_UV), Error);
}

// The picture and its components are clamped so that the components still add up to the clamped picture.
TEST(Components, ThatAreClampedAddUpToTheClampedPicture) {
  std::vector<std::vector<float>> images = {{2.0f, -1.0f, 1.0f, 0.5f}, {-1.0f, -1.0f, 3.0f, 0.25f}};
  reconstruct::clamp_components(4, &images);
  EXPECT_EQ(images[0], (std::vector<float>{1.0f, 0.0f, 1.0f, 0.5f}));
  EXPECT_EQ(images[1], (std::vector<float>{0.0f, 0.0f, 3.0f, 0.25f}));
}

// Linear reconstructions keep negative values, and all do where negative light was sampled.
TEST(Components, AreClampedUnlessNegativeLightWasSampled) {
  const auto film = rendered(Scenario::Glass, settings_with("", GRADUS_RECONSTRUCTION_REGULARIZED))->film();
  film::Film other = *film;
  for (const uint32_t how : {GRADUS_RECONSTRUCTION_REGULARIZED, GRADUS_RECONSTRUCTION_L1})
    EXPECT_FALSE(reconstruct::keeps_negative(other, how));
  EXPECT_TRUE(reconstruct::keeps_negative(other, GRADUS_RECONSTRUCTION_L2));
  Radiance& value = other.components.back().primal[1].back();
  value.y = -1e-4f;  // less than a thousandth of the light
  EXPECT_FALSE(reconstruct::keeps_negative(other, GRADUS_RECONSTRUCTION_REGULARIZED));
  value.y = -1e6f;
  EXPECT_TRUE(reconstruct::keeps_negative(other, GRADUS_RECONSTRUCTION_REGULARIZED));
}

}  // namespace
}  // namespace gradus::components_test
