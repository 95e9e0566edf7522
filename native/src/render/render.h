// A running render: a thread with a task, and access to its progress, results and cancellation from other threads.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "film/film.h"
#include "gradus/gradus.h"
#include "integrator/integrator.h"
#include "scene/snapshot.h"

namespace gradus::scene {
class Device;
}  // namespace gradus::scene

namespace gradus::render {

class RenderTask;

// Makes the integrator of a plan. Throws `unsupported` for AUTO and unknown values. Tests pass their own factory.
using IntegratorFactory = std::function<std::unique_ptr<integrator::Integrator>(
    const integrator::IntegratorContext& context, uint32_t integrator)>;
std::unique_ptr<integrator::Integrator> make_integrator(const integrator::IntegratorContext& context,
                                                        uint32_t integrator);

class Render {
 public:
  // Starts a render on its own thread. Throws `invalid_argument` for settings that cannot be followed. If `resumed` is
  // set, the render continues from its samples; throws `invalid_argument` if its keys or planes differ. `device` gives
  // the number of threads and may be nullptr if settings.threads is set.
  Render(std::shared_ptr<scene::Device> device, std::shared_ptr<const scene::Snapshot> snapshot,
         const GradusSettings& settings, std::shared_ptr<const film::Film> resumed = nullptr,
         const IntegratorFactory& factory = make_integrator);
  // Runs any task on its own thread.
  explicit Render(std::unique_ptr<RenderTask> task);
  ~Render();  // cancels and waits
  Render(const Render&) = delete;
  Render& operator=(const Render&) = delete;

  GradusProgress progress() const;
  void cancel();
  // Waits until the render has ended. Returns false if it is still running after `seconds` (negative: no limit). Does
  // not rethrow errors; see outcome().
  bool wait(double seconds);
  GradusError outcome(std::string* text) const;  // OK, CANCELLED or the error; invalid_operation while running
  // Copies a pass of the delivered region. Never waits. While sampling, Noisy Image is the mean of the samples so far,
  // each tile as of its last finished batch, 0 before the first one; so is Combined until a preview is shown
  // (render/preview.h). Other passes throw `invalid_operation` until sampling has ended. Throws `invalid_argument` if
  // `count` is not the number of floats of the pass.
  void read_pass(uint32_t pass, float* pixels, size_t count) const;
  // Copies a pass of a component. Throws `invalid_operation` until sampling has ended.
  void read_component(const std::string& name, uint32_t pass, float* pixels, size_t count) const;
  // Copies a layer of a channel of GradusChannelKind `kind`; see gradus_render_read_channel().
  void read_channel(uint32_t kind, const std::string& name, uint32_t layer, float* pixels, size_t count) const;
  // Return the statistics and the film. Throw `invalid_operation` while running.
  std::string stats_json() const;
  std::shared_ptr<const film::Film> film() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gradus::render
