// What the handles of the C API stand for.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "animation/sequence.h"
#include "api/registry.h"
#include "film/film.h"
#include "output/light_passes.h"
#include "render/render.h"
#include "scene/device.h"
#include "scene/scene.h"

namespace gradus::api {

class SceneRecorder;  // api/recorder.h

// Removes the oldest warning and sets *text to it, or to NULL if there is none. The text is valid until the thread's
// next call.
inline void take_warning(Warnings* warnings, const char** text) {
  thread_local std::string taken;
  *text = warnings->take(&taken) ? taken.c_str() : nullptr;
}

struct SceneObject {
  explicit SceneObject(const std::shared_ptr<scene::Device>& device);
  ~SceneObject();
  // Throws invalid_operation before the first commit.
  std::shared_ptr<const scene::Snapshot> snapshot();
  std::mutex mutex;  // calls of one scene wait for each other
  scene::Scene scene;
  Warnings warnings;                        // Warnings of commits that the caller has not yet read.
  std::shared_ptr<SceneRecorder> recorder;  // nullptr if scene calls are not recorded.
};

struct RenderObject {
  RenderObject(std::shared_ptr<scene::Device> shared_device, std::shared_ptr<const scene::Snapshot> snapshot,
               const GradusSettings& settings, std::shared_ptr<const film::Film> resumed)
      : device(std::move(shared_device)), render(device, std::move(snapshot), settings, std::move(resumed)) {}
  RenderObject(std::shared_ptr<scene::Device> shared_device, std::unique_ptr<render::RenderTask> task)
      : device(std::move(shared_device)), render(std::move(task)) {}
  std::shared_ptr<scene::Device> device;
  render::Render render;
  std::mutex mutex;
  std::string stats;  // kept for the caller until release
};

struct SequenceObject {
  SequenceObject(std::shared_ptr<scene::Device> shared_device, const animation::SequenceSettings& settings)
      : device(std::move(shared_device)), sequence(std::make_shared<animation::Sequence>(device, settings)) {}
  std::mutex mutex;  // calls of one sequence wait for each other
  std::shared_ptr<scene::Device> device;
  std::shared_ptr<animation::Sequence> sequence;
  std::weak_ptr<RenderObject> running;  // The render that was started last.
};

// The picture that was last reconstructed from a film. Its light passes are computed when they are first read. The
// noisy image needs none, because the light passes of the film belong to it.
struct DevelopedPicture {
  std::vector<float> rgba;
  std::vector<std::vector<float>> components;  // RGB of each
  bool is_noisy = false;
  std::optional<output::LightPasses> light;
};

// Frames of renders are shared and immutable; merging replaces the frame by a new one.
struct FilmObject {
  explicit FilmObject(std::shared_ptr<scene::Device> shared_device) : device(std::move(shared_device)) {}
  std::mutex mutex;
  std::shared_ptr<scene::Device> device;
  std::shared_ptr<const film::Film> film;
  std::shared_ptr<DevelopedPicture>
      developed;  // nullptr if there is no picture yet or it has no light passes or components. `mutex` guards `light`.
  std::shared_ptr<const film::Film> get() {
    const std::lock_guard lock(mutex);
    return film;
  }
};

template <>
struct HandleOf<scene::Device> {
  static constexpr HandleType type = HandleType::Device;
};
template <>
struct HandleOf<SceneObject> {
  static constexpr HandleType type = HandleType::Scene;
};
template <>
struct HandleOf<RenderObject> {
  static constexpr HandleType type = HandleType::Render;
};
template <>
struct HandleOf<SequenceObject> {
  static constexpr HandleType type = HandleType::Sequence;
};
template <>
struct HandleOf<FilmObject> {
  static constexpr HandleType type = HandleType::Film;
};

}  // namespace gradus::api
