// gradus_film_reconstruct() uses the number of threads that the settings of the film name.
#include "base/clock.h"
#include "film_io/store.h"
#include "render/fake_integrator.h"
#include "test_scene.h"

namespace gradus {
namespace {

// Regression: stored films were reconstructed with all processors, whatever number of threads their settings had.
TEST(FilmThreads, AreThoseOfItsSettings) {
  constexpr uint32_t size = 384;
  const GradusDevice device = test::make_device();
  GradusSettings settings = test::small_settings(size, size, 2);
  settings.integrator = GRADUS_INTEGRATOR_GRADIENT;
  settings.threads = 1;
  const std::string path = testing::TempDir() + "/threads.exr";
  film_io::save_film(*test::rendered(settings), path);
  GradusFilm film = 0;
  ASSERT_OK(gradus_film_load(device, path.c_str(), &film));
  std::vector<float> rgba(size_t{4} * size * size);
  const uint64_t process = process_cpu_nanoseconds(), thread = thread_cpu_nanoseconds();
  ASSERT_OK(gradus_film_reconstruct(film, GRADUS_RECONSTRUCTION_L1, 0.0f, GRADUS_DENOISER_NONE, rgba.data(),
                                    rgba.size(), nullptr));
  const double own = double(thread_cpu_nanoseconds() - thread), all = double(process_cpu_nanoseconds() - process);
  EXPECT_GT(own, 0.8 * all) << "others have worked";
  EXPECT_OK(gradus_film_release(film));
  EXPECT_OK(gradus_device_release(device));
  std::remove(path.c_str());
}

}  // namespace
}  // namespace gradus
