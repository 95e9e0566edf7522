#include "regression/pictures.h"

#include "render/render.h"
#include "schema/options.h"

namespace gradus::regression {

namespace {

using test::PathScene;
using test::Scenario;

void whole_box(PathScene* scene) {
  test::build(Scenario::GlossyFloor, scene);
  scene->ball(Vec3(-0.4f, -0.5f, 0.1f), 0.45f, scene->material(test::glass(0.0f)), 10, true);
  scene->ball(Vec3(0.45f, -0.6f, 0.3f), 0.35f, scene->material(test::glossy(0.3f)), 10, true);
}

void behind_a_lens(PathScene* scene) {
  whole_box(scene);
  scene->camera_desc.aperture_radius = 0.1f;
  scene->camera_desc.focus_distance = 3.0f;
  scene->camera_desc.blades = 5;
}

void from_the_side(PathScene* scene) {
  whole_box(scene);
  scene->camera(Vec3(0, 0.2f, 3.2f), Vec3(0), 3.2f, GRADUS_CAMERA_ORTHOGRAPHIC);
}

void nothing(GradusSettings*) {}

void add_scenarios(std::vector<Picture>* list) {
  // Pictures of the scenarios before Linked are stored.
  for (int i = 0; i < int(Scenario::Linked); ++i) {
    const auto scenario = static_cast<Scenario>(i);
    const auto build = [scenario](PathScene* scene) { test::build(scenario, scene); };
    const std::string name = test::name_of(scenario);
    list->push_back({name + " path", build, [](GradusSettings* s) {
                       s->integrator = GRADUS_INTEGRATOR_PATH;
                       s->reconstruction = GRADUS_RECONSTRUCTION_NONE;
                     }});
    list->push_back({name + " L2", build, nothing});
  }
}

}  // namespace

std::vector<Picture> pictures() {
  std::vector<Picture> list;
  add_scenarios(&list);
  list.push_back({"box L1", whole_box, [](GradusSettings* s) { s->reconstruction = GRADUS_RECONSTRUCTION_L1; }});
  list.push_back({"box automatic", whole_box,
                  [](GradusSettings* s) {
                    s->integrator = GRADUS_INTEGRATOR_AUTO;
                    s->reconstruction = GRADUS_RECONSTRUCTION_AUTO;
                  },
                  true});
  list.push_back({"box behind a lens", behind_a_lens, nothing});
  list.push_back({"box orthographic", from_the_side, nothing});
  list.push_back({"box with a transparent film", [](PathScene* scene) { test::build(Scenario::World, scene); },
                  [](GradusSettings* s) { s->film_transparent = 1; }});
  list.push_back(
      {"box with a Gaussian filter", whole_box, [](GradusSettings* s) { s->pixel_filter = GRADUS_FILTER_GAUSSIAN; }});
  list.push_back(
      {"box with clamped light", whole_box, [](GradusSettings* s) { s->clamp_direct = s->clamp_indirect = 1.0f; }});
  list.push_back({"box without bounces", whole_box, [](GradusSettings* s) { s->max_bounces = 0; }});
  list.push_back({"box exposed twice", whole_box, [](GradusSettings* s) { s->film_exposure = 2.0f; }});
  return list;
}

std::vector<float> render(const Picture& picture, uint32_t samples, uint32_t seed) {
  GradusSettings settings = schema::default_settings();
  settings.width = kWidth;
  settings.height = kHeight;
  settings.samples = samples;
  settings.seed = seed;
  settings.noise_threshold = 0.0f;
  settings.denoiser = GRADUS_DENOISER_NONE;
  settings.max_bounces = 6;
  settings.integrator = GRADUS_INTEGRATOR_GRADIENT;
  settings.reconstruction = GRADUS_RECONSTRUCTION_L2;
  picture.change(&settings);
  PathScene scene;
  picture.build(&scene);
  const integrator::IntegratorContext context = scene.context(settings);
  render::Render render(test::test_device(), context.snapshot, settings);
  render.wait(-1.0);
  std::vector<float> rgba(size_t(kWidth) * kHeight * 4);
  render.read_pass(GRADUS_PASS_COMBINED, rgba.data(), rgba.size());
  return rgba;
}

std::vector<float> block_means(const std::vector<float>& rgba) {
  std::vector<float> means(size_t(kWidth / kBlock) * (kHeight / kBlock) * 3);
  for (uint32_t y = 0; y < kHeight; ++y) {
    for (uint32_t x = 0; x < kWidth; ++x) {
      float* mean = means.data() + 3 * (size_t(y / kBlock) * (kWidth / kBlock) + x / kBlock);
      for (size_t c = 0; c < 3; ++c) mean[c] += rgba[4 * (size_t(y) * kWidth + x) + c] / float(kBlock * kBlock);
    }
  }
  return means;
}

}  // namespace gradus::regression
