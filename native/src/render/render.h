// The loop (contract 1.8): plan, batches, frame, reconstruction, error, next batch. It alone loops; it owns cancel,
// progress, clock.
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

// Makes the integrator of a plan: `integrator` is a GradusIntegrator, never AUTO. Tests bring their own.
using IntegratorFactory = std::function<std::unique_ptr<integrator::Integrator>(
    const integrator::IntegratorContext& context, uint32_t integrator)>;
std::unique_ptr<integrator::Integrator> make_integrator(const integrator::IntegratorContext& context,
                                                        uint32_t integrator);

class Render {
 public:
  // Starts on a thread of its own. Throws invalid_argument for settings that cannot be obeyed (contract 5.1). resumed:
  // go on from its samples; invalid_argument if its keys or planes differ. device: for the number of threads; may be
  // nullptr if settings.threads is set.
  Render(std::shared_ptr<scene::Device> device, std::shared_ptr<const scene::Snapshot> snapshot,
         const GradusSettings& settings, std::shared_ptr<const film::Film> resumed = nullptr,
         const IntegratorFactory& factory = make_integrator);
  // Runs another task.
  explicit Render(std::unique_ptr<RenderTask> task);
  ~Render();  // cancels and waits
  Render(const Render&) = delete;
  Render& operator=(const Render&) = delete;

  GradusProgress progress() const;
  void cancel();
  // False: still running after `seconds` (negative: no limit). Rethrows nothing; see outcome().
  bool wait(double seconds);
  GradusError outcome(std::string* text) const;  // OK, CANCELLED or the failure, once ended
  // The delivered region. While sampling, Noisy Image is the noisy image so far, each tile as of its last batch that
  // ended, 0 before the first one; so is Combined until its reader, a watcher, is shown more (render/preview.h). Never
  // waits. Others: invalid_operation until then.
  void read_pass(uint32_t pass, float* pixels, size_t count) const;
  // Of a component, once sampling has ended: invalid_operation until then.
  void read_component(const std::string& name, uint32_t pass, float* pixels, size_t count) const;
  // Throw invalid_operation while running.
  std::string stats_json() const;
  std::shared_ptr<const film::Film> film() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gradus::render
