#include "motion/flow_scene.h"

#include <random>
#include <stdexcept>

namespace gradus {

FlowFilm::FlowFilm(const FlowScene& scene, int frame) {
  std::mt19937 random(uint32_t(7 + frame));
  std::normal_distribution<float> noise(0.0f, 1.0f);
  for (int y = 0; y < scene.height; ++y) {
    for (int x = 0; x < scene.width; ++x) {
      float sum = 0.0f;
      for (int i = 0; i < 16; ++i) {
        const Vec2 offset = (Vec2(float(i % 4), float(i / 4)) + 0.5f) / 4.0f - 0.5f;
        sum += scene.sample(Vec2(float(x), float(y)) + offset, frame).light;
      }
      const Vec2 place = {float(x), float(y)};
      const FlowSample middle = scene.sample(place, frame);
      light.emplace_back(sum / 16.0f * (1.0f + scene.noise * noise(random)));
      // Inverts a motion that hardly changes over its own length.
      const Vec2 there = scene.surface(place, middle.object);
      surface.push_back(frame == 0 ? there : -scene.surface(place - there, middle.object));
      object.push_back(middle.object);
      depth.push_back(middle.depth);
      tracked.push_back(motion::kTracked);
    }
  }
}

float flow_pattern(const Vec2& p) {
  return std::sin(0.31f * p.x + 0.05f * p.y) + std::sin(0.27f * p.y - 0.11f * p.x + 1.0f) +
         std::sin(0.13f * p.x + 0.19f * p.y + 2.0f);
}

float disc_shadow(const Vec2& place, const Vec2& centre, float radius, float softness, float dark) {
  return dark + (1.0f - dark) / (1.0f + std::exp((radius - glm::length(place - centre)) / softness));
}

Vec2 turned(const Vec2& place, const Vec2& centre, float degrees) {
  const float angle = degrees * kPi / 180.0f, c = std::cos(angle), s = std::sin(angle);
  const Vec2 p = place - centre;
  return centre + Vec2(c * p.x - s * p.y, s * p.x + c * p.y);
}

std::shared_ptr<const motion::FlowLibrary> flow_library_of_the_build() {
  std::string why_not;
  auto library = motion::find_flow_library(GRADUS_BINARY_DIR "/native", &why_not);
  if (!library) throw std::runtime_error(why_not);
  return library;
}

std::array<motion::PixelMotion, 2> motion_of(const FlowScene& scene, motion::FlowDomain domain) {
  const FlowFilm first(scene, 0), second(scene, 1);
  return motion::irradiance_motion(flow_library_of_the_build().get(), scene.width, scene.height, first.view(),
                                   second.view(), domain);
}

float quantile(std::vector<float> values, float share) {
  if (values.empty()) throw std::runtime_error("no values");
  const auto at = values.begin() + ptrdiff_t(share * float(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace gradus
