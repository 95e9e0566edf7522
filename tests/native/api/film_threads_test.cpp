// The threads of stored films: gradus_film_reconstruct() uses as many as the settings of the film name, and readers do
// not wait for merges.
#include <chrono>
#include <future>
#include <latch>
#include <thread>

#include "api/objects.h"
#include "base/clock.h"
#include "film_io/store.h"
#include "render/fake_integrator.h"
#include "scene/scene_fixture.h"
#include "test_scene.h"

namespace gradus::film_threads_test {
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

// Regression: a merge kept readers from the film until all of its pixels were added.
TEST(FilmThreads, ReadersDoNotWaitForAMerge) {
  GradusSettings settings = test::small_settings(16, 16, 2);
  const std::shared_ptr<const film::Film> before = test::rendered(settings);
  settings.first_sample = 2;
  const std::shared_ptr<const film::Film> other = test::rendered(settings);
  const auto device = test::test_device();
  api::FilmObject film(device, before);

  // A merge cannot end while other threads have all places in the arena.
  std::latch entered(2);
  std::promise<void> leave;
  const std::shared_future<void> left = leave.get_future().share();
  const auto occupy = [&] {
    device->arena().execute([&] {
      entered.count_down();
      left.wait();
    });
  };
  std::thread first(occupy), second(occupy);
  entered.wait();
  std::thread merger([&] { film.merge(*other); });
  std::future<std::shared_ptr<const film::Film>> read = std::async(std::launch::async, [&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));  // The merge has begun.
    return film.get();
  });
  EXPECT_EQ(read.wait_for(std::chrono::seconds(10)), std::future_status::ready) << "the reader waits";
  leave.set_value();
  first.join();
  second.join();
  merger.join();
  EXPECT_TRUE(read.get() == before) << "the merge has ended before it was read";
  EXPECT_EQ(film::mean_samples(*film.get()), 4.0);
}

}  // namespace
}  // namespace gradus::film_threads_test
