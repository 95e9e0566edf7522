// A film has the same passes, bit for bit, whoever delivers them: the render, the C API and a sequence of one frame.
#include <algorithm>

#include "animation/sequence_fixture.h"
#include "api/objects.h"
#include "api/test_scene.h"
#include "render/scene_render.h"
#include "schema/pass_table.h"

namespace gradus::passes_test {
namespace {

using namespace test;

std::shared_ptr<scene::Device> device_with_stand_in() {
  return two_threads(GRADUS_BINARY_DIR "/tests/libfake_oidn.so");
}

GradusSettings settings_with_all_passes(uint32_t reconstruction, uint32_t denoiser) {
  GradusSettings settings = settings_of(1);
  settings.integrator = GRADUS_INTEGRATOR_GRADIENT;
  settings.reconstruction = reconstruction;
  settings.denoiser = denoiser;
  settings.film_exposure = 1.7f;
  settings.passes = (uint64_t{1} << GRADUS_PASS_COUNT) - 1;
  settings.use_decomposition = 1;
  settings.component_passes = (1u << GRADUS_COMPONENT_PASS_COUNT) - 1;
  settings.threads = 2;
  return settings;
}

// The film of a render, as a handle of the C API.
class Handle {
 public:
  Handle(const std::shared_ptr<scene::Device>& device, std::shared_ptr<const film::Film> film)
      : handle_(api::add_handle(std::make_shared<api::FilmObject>(device, std::move(film)))) {}
  ~Handle() { EXPECT_OK(gradus_film_release(handle_)); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;

  std::vector<float> read(uint32_t pass) const {
    std::vector<float> pixels(size_t{schema::pass_info(pass).channels} * kSide * kSide);
    EXPECT_OK(gradus_film_read_pass(handle_, pass, pixels.data(), pixels.size()));
    return pixels;
  }
  std::vector<float> read(const std::string& component, uint32_t pass) const {
    std::vector<float> pixels(size_t{schema::component_pass_info(pass).channels} * kSide * kSide);
    EXPECT_OK(gradus_film_read_component(handle_, component.c_str(), pass, pixels.data(), pixels.size()));
    return pixels;
  }

 private:
  GradusFilm handle_;
};

// Compares the passes of a film that the C API delivers with those of `delivered`, a render or a task.
template <class Delivered>
void expect_same_passes(const Handle& film, const Delivered& delivered, const std::vector<std::string>& components,
                        bool (*is_compared)(uint32_t pass), bool (*is_component_compared)(uint32_t pass)) {
  for (const schema::PassInfo& info : schema::all_passes()) {
    if (is_compared(info.pass)) {
      EXPECT_EQ(film.read(info.pass), delivered.read(info.pass)) << info.name;
    }
  }
  for (const std::string& component : components) {
    for (const schema::ComponentPassInfo& info : schema::all_component_passes()) {
      if (!is_component_compared(info.pass)) continue;
      EXPECT_EQ(film.read(component, info.pass), delivered.read(component, info.pass)) << component << " " << info.name;
    }
  }
}

// Reads of a render or a task of a sequence.
template <class Task>
struct DeliveredBy {
  Task* task;
  std::vector<float> read(uint32_t pass) const {
    std::vector<float> pixels(size_t{schema::pass_info(pass).channels} * kSide * kSide);
    read_from(pass, &pixels);
    return pixels;
  }
  std::vector<float> read(const std::string& component, uint32_t pass) const {
    std::vector<float> pixels(size_t{schema::component_pass_info(pass).channels} * kSide * kSide);
    read_from(component, pass, &pixels);
    return pixels;
  }

 private:
  void read_from(uint32_t pass, std::vector<float>* pixels) const {
    if constexpr (std::is_same_v<Task, render::Render>) {
      task->read_pass(pass, pixels->data(), pixels->size());
    } else {
      task->read_pass(pass, pixels->data());
    }
  }
  void read_from(const std::string& component, uint32_t pass, std::vector<float>* pixels) const {
    if constexpr (std::is_same_v<Task, render::Render>) {
      task->read_component(component, pass, pixels->data(), pixels->size());
    } else {
      task->read_component(component, pass, pixels->data());
    }
  }
};

std::vector<std::string> names_of(const film::Film& film) {
  std::vector<std::string> names{"Emission"};  // has no path in the scene with glass
  for (const film::ComponentPlanes& planes : film.components) names.push_back(planes.name);
  return names;
}

bool every_pass(uint32_t) { return true; }

struct How {
  uint32_t reconstruction, denoiser;
};

class PassesOfOneFilm : public testing::TestWithParam<How> {};

// The film's own Error is that before the denoiser.
TEST_P(PassesOfOneFilm, AreThoseOfTheRender) {
  const auto device = device_with_stand_in();
  PathScene scene;
  build(Scenario::Glass, &scene);
  const GradusSettings settings = settings_with_all_passes(GetParam().reconstruction, GetParam().denoiser);
  render::Render render(device, scene.context(settings).snapshot, settings);
  render.wait(-1.0);
  const Handle film(device, render.film());
  const DeliveredBy<render::Render> delivered{&render};
  const bool denoises = GetParam().denoiser != GRADUS_DENOISER_NONE;
  const auto is_compared = denoises ? [](uint32_t pass) { return pass != GRADUS_PASS_ERROR; } : every_pass;
  expect_same_passes(film, delivered, names_of(*render.film()), is_compared, every_pass);
  const bool is_noisy = GetParam().reconstruction == GRADUS_RECONSTRUCTION_NONE && !denoises;
  EXPECT_EQ(film.read(GRADUS_PASS_COMBINED) == film.read(GRADUS_PASS_NOISY_IMAGE), is_noisy);
  EXPECT_GT(render.film()->components.size(), 2u);
  for (const uint32_t pass : {GRADUS_PASS_DIFFUSE_DIRECT, GRADUS_PASS_ERROR}) {
    const std::vector<float> pixels = film.read(pass);
    EXPECT_GT(*std::max_element(pixels.begin(), pixels.end()), 0.0f) << schema::pass_info(pass).name;
  }
}

// Windows of frames have a picture of their own, and with it light passes and colours of components. All other passes
// are those of the film.
TEST_P(PassesOfOneFilm, AreThoseOfASequenceOfOneFrame) {
  if (GetParam().reconstruction == GRADUS_RECONSTRUCTION_NONE) GTEST_SKIP() << "sequences always reconstruct";
  const auto device = device_with_stand_in();
  Pan pan(1.0f, Scenario::Glass);
  const auto sequence = std::make_shared<animation::Sequence>(device, animation::SequenceSettings{1, 1, 1, {}, ""});
  const GradusSettings settings = settings_with_all_passes(GetParam().reconstruction, GetParam().denoiser);
  run(sequence->sample(pan.at(1), settings).get());
  const auto task = test::delivered(sequence.get(), 1);
  const Handle film(device, task->film());
  expect_same_passes(
      film, DeliveredBy<render::RenderTask>{task.get()}, names_of(*task->film()),
      [](uint32_t pass) {
        return pass != GRADUS_PASS_COMBINED && pass != GRADUS_PASS_ERROR &&
               !schema::has_bit(schema::light_passes(), pass);
      },
      [](uint32_t pass) { return !schema::is_of_picture(pass); });
}

INSTANTIATE_TEST_SUITE_P(Options, PassesOfOneFilm,
                         testing::Values(How{GRADUS_RECONSTRUCTION_NONE, GRADUS_DENOISER_NONE},
                                         How{GRADUS_RECONSTRUCTION_NONE, GRADUS_DENOISER_OIDN},
                                         How{GRADUS_RECONSTRUCTION_L2, GRADUS_DENOISER_NONE},
                                         How{GRADUS_RECONSTRUCTION_L1, GRADUS_DENOISER_OIDN},
                                         How{GRADUS_RECONSTRUCTION_REGULARIZED, GRADUS_DENOISER_NONE},
                                         How{GRADUS_RECONSTRUCTION_REGULARIZED, GRADUS_DENOISER_AUTO}));

// What is delivered after a cancel is the noisy image, its error and its components.
TEST(PassesOfACancelledRender, AreThoseOfTheNoisyImage) {
  PathScene scene;
  build(Scenario::Glass, &scene);
  GradusSettings settings = settings_with_all_passes(GRADUS_RECONSTRUCTION_L1, GRADUS_DENOISER_NONE);
  settings.samples = 1000000;
  const auto device = device_with_stand_in();
  render::Render render(device, scene.context(settings).snapshot, settings);
  while (render.progress().samples_done < 2) std::this_thread::yield();
  render.cancel();
  render.wait(-1.0);
  auto noisy = std::make_shared<film::Film>(*render.film());
  noisy->settings.reconstruction = GRADUS_RECONSTRUCTION_NONE;
  const Handle film(device, noisy);
  expect_same_passes(film, DeliveredBy<render::Render>{&render}, names_of(*noisy), every_pass, every_pass);
}

}  // namespace
}  // namespace gradus::passes_test
