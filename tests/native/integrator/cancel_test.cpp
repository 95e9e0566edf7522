// K2: a long work unit ends soon after a cancel, with whole samples.
#include <chrono>
#include <thread>

#include <gtest/gtest.h>

#include "gradient/gradient_integrator.h"
#include "support/path_scene.h"

namespace gradus::cancel_test {
namespace {

using Clock = std::chrono::steady_clock;

TEST(K2_Cancel, IntegratorsStopBetweenSamples) {
  test::PathScene scene;
  test::build(test::Scenario::DiffuseArea, &scene);
  const integrator::IntegratorContext context = scene.context(test::test_settings(16, 16));
  for (const bool gradient : {false, true}) {
    const auto integrator =
        gradient ? gradient::make_gradient_integrator(context) : integrator::make_path_integrator(context);
    film::Film film = test::make_test_film(context.settings, gradient);
    std::atomic<bool> stop{false};
    std::atomic<Clock::rep> ended{0};
    std::thread worker([&] {
      integrator->sample(integrator::WorkUnit{film.region, 0, 20000, nullptr}, &film, &film.counters, stop);
      ended = Clock::now().time_since_epoch().count();
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    const Clock::time_point requested = Clock::now();
    stop = true;
    worker.join();
    EXPECT_LT(Clock::duration(ended) - requested.time_since_epoch(), std::chrono::milliseconds(250));
    EXPECT_GT(film.count[0][0], 0u);
    EXPECT_LT(film.count[0][0], 10000u);
  }
}

}  // namespace
}  // namespace gradus::cancel_test
