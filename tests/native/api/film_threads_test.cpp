// The threads of stored films: gradus_film_reconstruct() uses as many as the settings of the film name, and readers do
// not wait for merges.
#include <chrono>
#include <future>
#include <latch>
#include <thread>

#include <tbb/task_scheduler_observer.h>

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

// Stops the thread that enters an arena until resume() is called. Workers of the arena pass.
class ArenaGate : public tbb::task_scheduler_observer {
 public:
  explicit ArenaGate(tbb::task_arena& arena) : tbb::task_scheduler_observer(arena) { observe(true); }
  ~ArenaGate() override { observe(false); }
  void on_scheduler_entry(bool is_worker) override {
    if (is_worker) return;
    entered_.count_down();
    opened_.wait();
  }
  // Returns when a thread has entered.
  void wait_for_entry() const { entered_.wait(); }
  void resume() { opened_.count_down(); }

 private:
  std::latch entered_{1}, opened_{1};
};

// Regression: a merge kept readers from the film until all of its pixels were added.
TEST(FilmThreads, ReadersDoNotWaitForAMerge) {
  GradusSettings settings = test::small_settings(16, 16, 2);
  const std::shared_ptr<const film::Film> before = test::rendered(settings);
  settings.first_sample = 2;
  const std::shared_ptr<const film::Film> other = test::rendered(settings);
  const auto device = test::test_device();
  api::FilmObject film(device, before);

  ArenaGate gate(device->arena());
  std::thread merger([&] { film.merge(*other); });
  gate.wait_for_entry();  // The merge has begun, and adds no pixel before the gate is opened.
  auto read = std::async(std::launch::async, [&] { return film.get(); });
  EXPECT_EQ(read.wait_for(std::chrono::seconds(10)), std::future_status::ready) << "the reader waits";
  gate.resume();
  merger.join();
  EXPECT_TRUE(read.get() == before) << "the merge has ended before it was read";
  EXPECT_EQ(film::mean_samples(*film.get()), 4.0);
}

}  // namespace
}  // namespace gradus::film_threads_test
