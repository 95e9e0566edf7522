// Small animations for tests of sequences: a scene before which the camera pans, and its delivered frames.
#pragma once

#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "animation/sequence.h"
#include "support/path_scene.h"

namespace gradus::test {
namespace fs = std::filesystem;

inline constexpr uint32_t kSide = 32;

inline GradusSettings settings_of(int32_t frame, uint32_t samples = 8) {
  GradusSettings settings = test_settings(kSide, kSide);
  settings.frame = frame;
  settings.samples = samples;
  settings.independent_sampler = 0;
  settings.reconstruction = GRADUS_RECONSTRUCTION_L2;
  settings.filter_width = 0.01f;  // a wider filter would add an error of coverage at all edges
  return settings;
}

// A folder that is removed at the end of the test.
class Folder {
 public:
  Folder() : path_((fs::temp_directory_path() / "gradus-test-XXXXXX").string()) {
    if (mkdtemp(path_.data()) == nullptr) throw std::runtime_error("no temporary folder");
  }
  ~Folder() { fs::remove_all(path_); }
  const std::string& path() const { return path_; }
  void remove(int32_t frame, const std::string& part = "") const {
    for (const auto& entry : fs::directory_iterator(path_)) {
      if (entry.path().filename().string().find(std::to_string(frame).append(".").append(part)) != std::string::npos)
        fs::remove(entry.path());
    }
  }

 private:
  std::string path_;
};

// A camera that moves sideways by some pixels from frame to frame.
class Pan {
 public:
  explicit Pan(float pixels, Scenario scenario = Scenario::DiffuseArea) : pixels_(pixels) { build(scenario, &scene_); }

  std::shared_ptr<const scene::Snapshot> at(int32_t frame) {
    const float x = pixels_ * 1.8f * 3.2f / (2.0f * kSide) * float(frame);
    scene_.camera(Vec3(x, 0, 3.2f), Vec3(x, 0, 0), 0.9f);
    return scene_.context(settings_of(frame)).snapshot;
  }
  // Gives the object that the scenario has added last another surface.
  void dress_last(const Surface& surface) {
    scene_.scene.dress(scene_.scene.instance_count() - 1, scene_.material(surface));
  }
  std::shared_ptr<const scene::Snapshot> turned(float angle) {
    scene_.camera(Vec3(0, 0, 3.2f), Vec3(std::sin(angle), 0, 3.2f - std::cos(angle)), 0.9f);
    return scene_.context(settings_of(0)).snapshot;
  }

 private:
  PathScene scene_;
  float pixels_;
};

struct Delivered {
  std::vector<float> combined, noisy, difference, correspondence;
  nlohmann::json stats;
};

inline void run(render::RenderTask* task) {
  task->run();
  std::string text;
  ASSERT_EQ(task->outcome(&text), GRADUS_OK) << text;
}

inline std::vector<float> read(const render::RenderTask& task, uint32_t pass, size_t channels) {
  std::vector<float> pixels(size_t(task.delivered().area()) * channels);
  task.read_pass(pass, pixels.data());
  return pixels;
}

inline double squared_distance(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0.0;
  for (size_t i = 0; i < a.size(); ++i) sum += std::pow(double(a[i]) - b[i], 2);
  return sum;
}

// Delivers a frame and returns its task.
inline std::unique_ptr<render::RenderTask> delivered(animation::Sequence* sequence, int32_t frame) {
  auto task = sequence->deliver(frame, nullptr);
  run(task.get());
  return task;
}

inline Delivered deliver(animation::Sequence* sequence, int32_t frame) {
  const auto task = delivered(sequence, frame);
  return {read(*task, GRADUS_PASS_COMBINED, 4), read(*task, GRADUS_PASS_NOISY_IMAGE, 4),
          read(*task, GRADUS_PASS_GRADIENT_T, 3), read(*task, GRADUS_PASS_GRADIENT_T_CORRESPONDENCE, 3),
          nlohmann::json::parse(task->stats())};
}

// Returns a device of two threads. `denoiser_path`: where its denoiser is, unless it is nullptr.
inline std::shared_ptr<scene::Device> two_threads(const char* denoiser_path = nullptr) {
  GradusDeviceSettings settings{};
  settings.struct_size = sizeof(settings);
  settings.threads = 2;
  settings.denoiser_path = denoiser_path;
  return std::make_shared<scene::Device>(settings);
}

inline std::shared_ptr<animation::Sequence> make_sequence(int32_t first, int32_t last, const std::string& folder = "") {
  return std::make_shared<animation::Sequence>(two_threads(), animation::SequenceSettings{first, last, 1, {}, folder});
}

inline GradusSettings with_passes(GradusSettings settings) {
  settings.passes |= uint64_t{1} << GRADUS_PASS_GRADIENT_T | uint64_t{1} << GRADUS_PASS_GRADIENT_T_CORRESPONDENCE;
  return settings;
}

inline void sample(animation::Sequence* sequence, const std::shared_ptr<const scene::Snapshot>& snapshot,
                   const GradusSettings& settings) {
  run(sequence->sample(snapshot, with_passes(settings)).get());
}

inline void sample_frames(animation::Sequence* sequence, Pan* pan, int32_t first, int32_t last) {
  for (int32_t t = first; t <= last; ++t) sample(sequence, pan->at(t), settings_of(t));
}

// Returns the warnings about stored frames, one a line.
inline std::string stale_frames(animation::Sequence* sequence) {
  Warnings warnings;
  sequence->warn_of_stale_frames(&warnings);
  std::string lines;
  for (std::string text; warnings.take(&text);) lines += text + "\n";
  return lines;
}

inline std::vector<Delivered> render(Pan* pan, animation::Sequence* sequence, int32_t first, int32_t last,
                                     uint32_t samples = 8, uint32_t reconstruction = GRADUS_RECONSTRUCTION_L2) {
  std::vector<Delivered> frames;
  const auto settings_at = [&](int32_t frame) {
    GradusSettings settings = settings_of(frame, samples);
    settings.reconstruction = reconstruction;
    return settings;
  };
  int32_t sampled = sequence->needs(settings_at(first)).first;
  for (int32_t frame = first; frame <= last; ++frame) {
    for (; sampled <= sequence->needs(settings_at(frame)).last; ++sampled)
      sample(sequence, pan->at(sampled), settings_at(sampled));
    frames.push_back(deliver(sequence, frame));
  }
  return frames;
}

}  // namespace gradus::test
