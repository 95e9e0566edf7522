// G1, G3, G4, G6 and G10 of the C API: wrong handles, the error slot, calls in any order, many handles.
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <mutex>
#include <random>
#include <regex>
#include <set>
#include <sstream>
#include <thread>

#include <gtest/gtest.h>

#include "api/guard.h"
#include "api/registry.h"
#include "api/test_scene.h"

namespace gradus::handles_test {
namespace {

using namespace test;

// Returns every function that takes a handle; all other arguments are valid or NULL.
std::vector<std::function<GradusError(uint64_t)>> handle_functions(uint32_t kind) {
  switch (kind) {
    case 0:
      return {[](uint64_t h) { return gradus_device_release(h); },
              [](uint64_t h) {
                const char* t;
                return gradus_device_warning(h, &t);
              },
              [](uint64_t h) {
                GradusScene s;
                return gradus_scene_create(h, &s);
              },
              [](uint64_t h) {
                GradusScene s;
                return gradus_scene_load(h, "/nonexistent", &s, nullptr);
              },
              [](uint64_t h) {
                GradusFilm f;
                return gradus_film_load(h, "/nonexistent", &f);
              },
              [](uint64_t h) {
                return gradus_device_set_color_space(
                    h, "x", [](void*, float*, size_t) {}, nullptr);
              }};
    case 1:
      return {[](uint64_t h) { return gradus_scene_release(h); },
              [](uint64_t h) { return set_quad(h); },
              [](uint64_t h) { return set_instance(h); },
              [](uint64_t h) { return set_light(h); },
              [](uint64_t h) { return set_camera(h); },
              [](uint64_t h) {
                GradusWorld w = sized<GradusWorld>();
                return gradus_scene_set_world(h, &w);
              },
              [](uint64_t h) {
                GradusImage i = sized<GradusImage>();
                return gradus_scene_set_image(h, 1, &i);
              },
              [](uint64_t h) {
                GradusMaterial m = sized<GradusMaterial>();
                m.surface = -1;
                return gradus_scene_set_material(h, 1, &m);
              },
              [](uint64_t h) { return gradus_scene_remove(h, GRADUS_KIND_MESH, 1); },
              [](uint64_t h) { return gradus_scene_commit(h, nullptr, nullptr); },
              [](uint64_t h) {
                const char* t;
                return gradus_scene_warning(h, &t);
              },
              [](uint64_t h) { return gradus_scene_record(h, 1); },
              [](uint64_t h) { return gradus_scene_save(h, nullptr, "/nonexistent/x"); },
              [](uint64_t h) {
                GradusRender r;
                const GradusSettings s = small_render();
                return gradus_render_start(h, &s, &r);
              },
              [](uint64_t h) {
                GradusRender r;
                const GradusSettings s = small_render();
                return gradus_render_resume(h, &s, 0, &r);
              }};
    case 2:
      return {[](uint64_t h) { return gradus_render_release(h); },
              [](uint64_t h) {
                GradusProgress p = sized<GradusProgress>();
                return gradus_render_poll(h, &p);
              },
              [](uint64_t h) { return gradus_render_cancel(h); },
              [](uint64_t h) { return gradus_render_wait(h, 0.0); },
              [](uint64_t h) {
                float p[4];
                return gradus_render_read_pass(h, 0, p, 4);
              },
              [](uint64_t h) {
                const char* j;
                return gradus_render_stats(h, &j);
              },
              [](uint64_t h) {
                GradusFilm f;
                return gradus_render_film(h, &f);
              }};
    default:
      return {[](uint64_t h) { return gradus_film_release(h); },
              [](uint64_t h) { return gradus_film_save(h, "/nonexistent/x"); },
              [](uint64_t h) { return gradus_film_merge(h, h); },
              [](uint64_t h) {
                uint32_t a, b;
                return gradus_film_size(h, &a, &b);
              },
              [](uint64_t h) {
                float p[4];
                return gradus_film_reconstruct(h, 0, 0.2f, GRADUS_DENOISER_NONE, p, 4, nullptr);
              },
              [](uint64_t h) {
                float p[4];
                return gradus_film_read_pass(h, 0, p, 4);
              }};
  }
}

TEST(G1_Handles, WrongOnesAreRefusedEverywhere) {
  const GradusDevice device = make_device();
  const GradusScene scene = make_scene(device);
  GradusScene freed = 0;
  ASSERT_OK(gradus_scene_create(device, &freed));
  ASSERT_OK(gradus_scene_release(freed));
  GradusScene again = 0;  // takes the slot that was freed
  ASSERT_OK(gradus_scene_create(device, &again));
  EXPECT_NE(again, freed);
  std::mt19937_64 random(1);
  for (uint32_t kind = 0; kind < 4; ++kind) {
    std::vector<uint64_t> wrong = {0, 1, UINT64_MAX, freed, uint64_t{9} << 56 | 1};
    if (kind != 0) wrong.push_back(device);
    if (kind != 1) wrong.push_back(scene);
    for (int i = 0; i < 300; ++i) wrong.push_back(random());
    for (const auto& function : handle_functions(kind)) {
      for (const uint64_t handle : wrong) {
        EXPECT_EQ(function(handle), GRADUS_ERROR_INVALID_ARGUMENT) << kind;
        EXPECT_FALSE(error_text().empty());
      }
    }
  }
  EXPECT_OK(gradus_scene_release(again));
  EXPECT_OK(gradus_scene_release(scene));
  EXPECT_EQ(gradus_scene_release(scene), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(error_text().find("released before"), std::string::npos);
  EXPECT_OK(gradus_device_release(device));
}

// Calls random functions with live, freed, foreign and invented handles from two threads.
TEST(G1_Handles, TenThousandRandomCalls) {
  std::vector<std::function<GradusError(uint64_t)>> functions;
  for (uint32_t kind = 0; kind < 4; ++kind) {
    for (const auto& function : handle_functions(kind)) functions.push_back(function);
  }
  std::mutex mutex;
  std::vector<uint64_t> handles{0, 1, UINT64_MAX};
  const auto keep = [&](uint64_t handle) {
    const std::lock_guard lock(mutex);
    handles.push_back(handle);
  };
  const auto any = [&](std::mt19937_64& random) {
    const std::lock_guard lock(mutex);
    return random() % 16 == 0 ? random() : handles[random() % handles.size()];
  };
  const auto make = [&](std::mt19937_64& random) {
    uint64_t made = 0;
    const GradusSettings settings = small_render(4, 4, 1);
    switch (random() % 4) {
      case 0:
        made = make_device();
        break;
      case 1:
        if (gradus_scene_create(any(random), &made) == GRADUS_OK) fill_scene(made);
        break;
      case 2:
        gradus_render_start(any(random), &settings, &made);
        break;
      default:
        gradus_render_film(any(random), &made);
        break;
    }
    if (made) keep(made);
  };
  const auto calls = [&](uint32_t seed) {
    std::mt19937_64 random(seed);
    for (int i = 0; i < 5000; ++i) {
      if (i % 16 == 0) make(random);
      const GradusError code = functions[random() % functions.size()](any(random));
      EXPECT_GE(code, GRADUS_OK);
      EXPECT_LE(code, GRADUS_TIMEOUT);
      gradus_error(nullptr);
    }
  };
  std::thread other(calls, 2);
  calls(1);
  other.join();
  for (const uint64_t handle : handles) {
    for (const auto release : {gradus_render_release, gradus_film_release, gradus_scene_release, gradus_device_release})
      release(handle);
  }
}

TEST(G1_Handles, NullPointersAreRefusedEverywhere) {
  const GradusDevice device = make_device();
  const GradusScene scene = make_scene(device);
  const GradusSettings settings = small_render();
  GradusRender render = 0;
  ASSERT_OK(gradus_render_start(scene, &settings, &render));
  EXPECT_EQ(gradus_device_create(nullptr, nullptr), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(gradus_device_warning(device, nullptr), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(gradus_device_set_color_space(device, "x", nullptr, nullptr), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(gradus_device_set_color_space(
                device, nullptr, [](void*, float*, size_t) {}, nullptr),
            GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(gradus_scene_warning(scene, nullptr), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(gradus_scene_create(device, nullptr), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(gradus_scene_set_mesh(scene, 1, nullptr), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(gradus_scene_set_image(scene, 1, nullptr), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(gradus_scene_set_material(scene, 1, nullptr), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(gradus_scene_set_instances(scene, nullptr), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(gradus_scene_set_lights(scene, nullptr, 1), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(gradus_scene_set_lights(scene, nullptr, 0), GRADUS_OK);
  EXPECT_EQ(gradus_scene_set_camera(scene, nullptr), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(gradus_scene_set_world(scene, nullptr), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(gradus_scene_save(scene, nullptr, nullptr), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(gradus_scene_load(device, nullptr, nullptr, nullptr), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(gradus_render_start(scene, nullptr, &render), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(gradus_render_start(scene, &settings, nullptr), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(gradus_option(0, nullptr), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(gradus_settings_default(nullptr), GRADUS_ERROR_INVALID_ARGUMENT);
  gradus_error(nullptr);
  EXPECT_OK(gradus_scene_release(scene));
  EXPECT_OK(gradus_device_release(device));
}

TEST(G3_ErrorSlot, KeepsTheFirstErrorOfEachThreadUntilRead) {
  gradus_error(nullptr);
  EXPECT_EQ(gradus_device_release(0), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(gradus_pass_info(1000, nullptr, nullptr), GRADUS_ERROR_INVALID_ARGUMENT);
  std::thread other([] {
    const char* text = nullptr;
    EXPECT_EQ(gradus_error(&text), GRADUS_OK);
    EXPECT_STREQ(text, "");
  });
  other.join();
  const char* text = nullptr;
  EXPECT_EQ(gradus_error(&text), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(std::string(text).find("device"), std::string::npos) << text;
  EXPECT_EQ(gradus_error(&text), GRADUS_OK);
  EXPECT_STREQ(text, "");
}

TEST(G3_ErrorSlot, TextIsUtf8AndEnds) {
  gradus_error(nullptr);
  std::string long_text(5000, 'a');
  long_text[10] = '\xff';
  long_text.replace(20, 2, "\xc3\xa4");
  EXPECT_EQ(api::guard([&] { throw invalid_operation(long_text); }), GRADUS_ERROR_INVALID_OPERATION);
  const char* text = nullptr;
  gradus_error(&text);
  EXPECT_LT(std::strlen(text), 3000u);
  EXPECT_EQ(text[10], '?');
  EXPECT_EQ(std::string(text, 20, 2), "\xc3\xa4");
}

TEST(G4_Exceptions, EveryKindBecomesACode) {
  EXPECT_EQ(api::guard([] { throw std::bad_alloc(); }), GRADUS_ERROR_OUT_OF_MEMORY);
  EXPECT_EQ(api::guard([] { throw std::length_error("x"); }), GRADUS_ERROR_OUT_OF_MEMORY);
  EXPECT_EQ(api::guard([] { throw std::runtime_error("x"); }), GRADUS_ERROR_UNKNOWN);
  EXPECT_EQ(api::guard([] { throw std::invalid_argument("x"); }), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(api::guard([] { throw unsupported("x"); }), GRADUS_ERROR_UNSUPPORTED);
  EXPECT_EQ(api::guard([] { throw cancelled(); }), GRADUS_ERROR_CANCELLED);
  EXPECT_EQ(api::guard([] { throw 7; }), GRADUS_ERROR_UNKNOWN);
}

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

// No test can make every entry point throw. Instead, the source is searched: the whole body of each is within the
// guard.
TEST(G4_Exceptions, EveryEntryPointIsGuarded) {
  const std::filesystem::path native = GRADUS_SOURCE_DIR "/native";
  std::set<std::string> declared, guarded;
  const auto collect = [](const std::string& text, const std::regex& pattern, std::set<std::string>* names) {
    for (std::sregex_iterator match(text.begin(), text.end(), pattern), end; match != end; ++match)
      names->insert((*match)[1]);
  };
  const std::regex declaration(R"(GradusError (gradus_\w+)\()"),
      definition(R"(\nGradusError (gradus_\w+)\([^{;]*\{\s*return (?:api::guard|with_scene)\()");
  collect(text_of(native / "include/gradus/gradus.h"), declaration, &declared);
  for (const auto& file : std::filesystem::directory_iterator(native / "src/api"))
    collect(text_of(file.path()), definition, &guarded);
  EXPECT_GT(declared.size(), 30u);
  EXPECT_TRUE(std::regex_search(text_of(native / "src/api/scene.cpp"),
                                std::regex(R"(\nGradusError with_scene\([^{;]*\{\s*return guard\()")));
  guarded.insert("gradus_error");  // gradus_error() reads what the guard has stored
  EXPECT_EQ(declared, guarded);
}

TEST(G6_Order, RendersOutliveTheirSceneAndDevice) {
  const GradusDevice device = make_device();
  GradusScene scene = 0;
  ASSERT_OK(gradus_scene_create(device, &scene));
  GradusSettings settings = small_render();
  settings.integrator = GRADUS_INTEGRATOR_GRADIENT;  // so that the film holds data to reconstruct from
  GradusRender render = 0;
  EXPECT_EQ(gradus_render_start(scene, &settings, &render), GRADUS_ERROR_INVALID_OPERATION);
  EXPECT_EQ(error_text(), "the scene was not committed");
  EXPECT_OK(gradus_scene_commit(scene, nullptr, nullptr));
  EXPECT_EQ(gradus_render_start(scene, &settings, &render), GRADUS_ERROR_INVALID_OPERATION);
  EXPECT_EQ(error_text(), "the scene has no camera");
  EXPECT_EQ(render, 0u);
  fill_scene(scene);
  EXPECT_OK(gradus_scene_commit(scene, nullptr, nullptr));
  ASSERT_OK(gradus_render_start(scene, &settings, &render));
  EXPECT_OK(set_light(scene));  // edits the scene while it is rendered
  EXPECT_OK(gradus_scene_commit(scene, nullptr, nullptr));
  EXPECT_OK(gradus_scene_release(scene));
  EXPECT_OK(gradus_device_release(device));
  EXPECT_OK(gradus_render_wait(render, -1.0));
  GradusFilm film = 0;
  ASSERT_OK(gradus_render_film(render, &film));
  EXPECT_OK(gradus_render_release(render));
  uint32_t width = 0, height = 0;
  EXPECT_OK(gradus_film_size(film, &width, &height));
  EXPECT_EQ(width, 24u);
  std::vector<float> rgba(size_t(width) * height * 4);
  EXPECT_OK(gradus_film_reconstruct(film, GRADUS_RECONSTRUCTION_L1, 0.2f, GRADUS_DENOISER_NONE, rgba.data(),
                                    rgba.size(), nullptr));
  EXPECT_OK(gradus_film_release(film));
}

TEST(G6_Order, ReleaseWhileRenderingWaits) {
  const GradusDevice device = make_device();
  const GradusScene scene = make_scene(device);
  const GradusSettings settings = small_render(256, 256, 100000);
  GradusRender render = 0;
  ASSERT_OK(gradus_render_start(scene, &settings, &render));
  EXPECT_EQ(gradus_render_wait(render, 0.0), GRADUS_TIMEOUT);
  EXPECT_EQ(gradus_error(nullptr), GRADUS_OK);  // a wait that released the handle is no error
  GradusFilm film = 0;
  EXPECT_EQ(gradus_render_film(render, &film), GRADUS_ERROR_INVALID_OPERATION);
  const char* json = nullptr;
  EXPECT_EQ(gradus_render_stats(render, &json), GRADUS_ERROR_INVALID_OPERATION);
  EXPECT_EQ(json, nullptr);
  EXPECT_OK(gradus_render_release(render));
  EXPECT_OK(gradus_scene_release(scene));
  EXPECT_OK(gradus_device_release(device));
}

// Regression: the waiting thread kept the render alive until all of its samples were taken.
TEST(G6_Order, ReleaseWhileAnotherThreadWaitsCancels) {
  const GradusDevice device = make_device();
  const GradusScene scene = make_scene(device);
  const GradusSettings settings = small_render(256, 256, 16777216);
  for (int i = 0; i < 5; ++i) {
    GradusRender render = 0;
    ASSERT_OK(gradus_render_start(scene, &settings, &render));
    std::atomic<bool> waits{false};
    GradusError outcome = GRADUS_OK;
    std::thread waiter([&] {
      waits = true;
      outcome = gradus_render_wait(render, -1.0);
      gradus_error(nullptr);
    });
    while (!waits) std::this_thread::yield();
    std::this_thread::sleep_for(std::chrono::milliseconds(10 * i));
    EXPECT_OK(gradus_render_release(render));
    waiter.join();
    // INVALID_ARGUMENT if the handle was released before the thread began to wait.
    EXPECT_TRUE(outcome == GRADUS_ERROR_CANCELLED || outcome == GRADUS_ERROR_INVALID_ARGUMENT) << outcome;
  }
  EXPECT_OK(gradus_scene_release(scene));
  EXPECT_OK(gradus_device_release(device));
}

// Regression: warnings belonged to the device, so that another scene's render could receive those of a viewport.
TEST(SceneWarnings, StayWithTheirScene) {
  const GradusDevice device = make_device();
  const GradusScene good = make_scene(device), broken = make_scene(device);
  EXPECT_OK(gradus_scene_remove(broken, GRADUS_KIND_MESH, 1));
  EXPECT_OK(gradus_scene_commit(broken, nullptr, nullptr));
  const char* text = nullptr;
  EXPECT_OK(gradus_device_warning(device, &text));
  EXPECT_EQ(text, nullptr);
  EXPECT_OK(gradus_scene_warning(good, &text));
  EXPECT_EQ(text, nullptr);
  EXPECT_OK(gradus_scene_warning(broken, &text));
  ASSERT_NE(text, nullptr);
  EXPECT_NE(std::string(text).find("mesh that does not exist"), std::string::npos) << text;
  EXPECT_OK(gradus_scene_release(good));
  EXPECT_OK(gradus_scene_release(broken));
  EXPECT_OK(gradus_device_release(device));
}

// A render with `strict` starts only for scenes that are rendered completely.
TEST(SceneWarnings, EndAStrictRender) {
  const GradusDevice device = make_device();
  const GradusScene good = make_scene(device), broken = make_scene(device);
  EXPECT_OK(gradus_scene_remove(broken, GRADUS_KIND_MESH, 1));
  EXPECT_OK(gradus_scene_commit(broken, nullptr, nullptr));
  GradusSettings settings = small_render();
  for (const uint32_t strict : {0u, 1u}) {
    settings.strict = strict;
    for (const GradusScene scene : {good, broken}) {
      GradusRender render = 0;
      if (strict && scene == broken) {
        EXPECT_EQ(gradus_render_start(scene, &settings, &render), GRADUS_ERROR_UNSUPPORTED);
        EXPECT_NE(error_text().find("strict: object "), std::string::npos);
        EXPECT_EQ(render, 0u);
      } else {
        EXPECT_OK(gradus_render_start(scene, &settings, &render));
        EXPECT_OK(gradus_render_wait(render, -1.0));
        EXPECT_OK(gradus_render_release(render));
      }
    }
  }
  EXPECT_OK(gradus_scene_release(good));
  EXPECT_OK(gradus_scene_release(broken));
  EXPECT_OK(gradus_device_release(device));
}

TEST(G10_Registry, ManyHandlesComeAndGo) {
  api::Registry registry;
  uint64_t last = 0;
  for (int i = 0; i < 100000; ++i) {
    const uint64_t handle = registry.add(api::HandleType::Film, std::make_shared<int>(i));
    EXPECT_NE(handle, last);
    EXPECT_EQ(*std::static_pointer_cast<int>(registry.remove(api::HandleType::Film, handle)), i);
    last = handle;
  }
  EXPECT_EQ(registry.size(), 0u);
}

}  // namespace
}  // namespace gradus::handles_test
