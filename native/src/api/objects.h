// What the handles of the C API stand for.
#pragma once

#include <memory>
#include <mutex>
#include <string>

#include "animation/sequence.h"
#include "api/registry.h"
#include "film/film.h"
#include "output/film_reader.h"
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
  Warnings warnings;                    // Warnings about stored frames that the caller has not yet read.
  std::weak_ptr<RenderObject> running;  // The render that was started last.
};

// Films of renders are shared and immutable; merging replaces the film by a new one.
struct FilmObject {
  FilmObject(std::shared_ptr<scene::Device> shared_device, std::shared_ptr<const film::Film> film)
      : device(std::move(shared_device)), reader_(make_reader(std::move(film))) {}
  const std::shared_ptr<scene::Device> device;

  std::shared_ptr<output::FilmReader> reader() const {
    const std::lock_guard lock(mutex_);
    return reader_;
  }
  std::shared_ptr<const film::Film> get() const { return reader()->film(); }
  // Adds the samples of another film. Readers get the film of before meanwhile; other merges wait.
  void merge(const film::Film& other);

 private:
  std::shared_ptr<output::FilmReader> make_reader(std::shared_ptr<const film::Film> film) const {
    return std::make_shared<output::FilmReader>(std::move(film), device);
  }
  std::mutex merge_mutex_;    // held for the whole of a merge
  mutable std::mutex mutex_;  // guards the pointer
  std::shared_ptr<output::FilmReader> reader_;
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
