#include "render/render.h"

#include <pthread.h>

#include <csignal>
#include <thread>

#include "base/error.h"
#include "film/scene_channels.h"
#include "gradient/gradient_integrator.h"
#include "output/options.h"
#include "render/loop.h"
#include "scene/device.h"
#include "schema/pass_table.h"

namespace gradus::render {
namespace {

// Blocks all signals while threads are started, which inherit the mask: signals must reach the threads of the host, not
// those of the library.
class BlockSignals {
 public:
  BlockSignals() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, &saved_);
  }
  ~BlockSignals() { pthread_sigmask(SIG_SETMASK, &saved_, nullptr); }
  BlockSignals(const BlockSignals&) = delete;
  BlockSignals& operator=(const BlockSignals&) = delete;

 private:
  sigset_t saved_;
};

}  // namespace

std::unique_ptr<integrator::Integrator> make_integrator(const integrator::IntegratorContext& context,
                                                        uint32_t integrator) {
  switch (integrator) {
    case GRADUS_INTEGRATOR_PATH:
      return integrator::make_path_integrator(context);
    case GRADUS_INTEGRATOR_GRADIENT:
      return gradient::make_gradient_integrator(context);
    default:
      throw unsupported("no integrator is implemented for the value " + std::to_string(integrator));
  }
}

namespace {

LoopInput make_input(std::shared_ptr<scene::Device> device, std::shared_ptr<const scene::Snapshot> snapshot,
                     const GradusSettings& settings, std::shared_ptr<const film::Film> resumed,
                     const IntegratorFactory& factory) {
  LoopInput input;
  input.threads = output::threads_of(settings, device.get());
  input.device = std::move(device);
  input.snapshot = std::move(snapshot);
  input.settings = settings;
  input.resumed = std::move(resumed);
  input.factory = factory;
  return input;
}

}  // namespace

struct Render::State {
  explicit State(std::unique_ptr<RenderTask> its_task) : task(std::move(its_task)) {}
  const std::unique_ptr<RenderTask> task;
  std::thread thread;
};

Render::Render(std::unique_ptr<RenderTask> task) : state_(std::make_unique<State>(std::move(task))) {
  const BlockSignals blocked;
  state_->thread = std::thread([running = state_->task.get()] {
    pthread_setname_np(pthread_self(), "gradus-render");
    running->run();
  });
}

Render::Render(std::shared_ptr<scene::Device> device, std::shared_ptr<const scene::Snapshot> snapshot,
               const GradusSettings& settings, std::shared_ptr<const film::Film> resumed,
               const IntegratorFactory& factory)
    : Render(std::make_unique<RenderLoop>(
          make_input(std::move(device), std::move(snapshot), settings, std::move(resumed), factory))) {}

Render::~Render() {
  state_->task->cancel();
  if (state_->thread.joinable()) state_->thread.join();
}

GradusProgress Render::progress() const { return state_->task->progress(); }
void Render::cancel() { state_->task->cancel(); }
bool Render::wait(double seconds) { return state_->task->wait(seconds); }
GradusError Render::outcome(std::string* text) const { return state_->task->outcome(text); }

void Render::read_pass(uint32_t pass, float* pixels, size_t count) const {
  const Region& region = state_->task->delivered();
  const schema::PassInfo& info = schema::pass_info(pass);
  const size_t expected = size_t(region.area()) * info.channels;
  if (count != expected) {
    throw invalid_argument("pass " + std::string(info.name) + " has " + std::to_string(expected) + " floats, " +
                           std::to_string(count) + " were given");
  }
  state_->task->read_pass(pass, pixels);
}

void Render::read_component(const std::string& name, uint32_t pass, float* pixels, size_t count) const {
  const size_t expected = size_t(state_->task->delivered().area()) * schema::component_pass_info(pass).channels;
  if (count != expected) {
    throw invalid_argument("pass " + std::string(schema::component_pass_info(pass).name) + " has " +
                           std::to_string(expected) + " floats, " + std::to_string(count) + " were given");
  }
  state_->task->read_component(name, pass, pixels);
}

void Render::read_channel(uint32_t kind, const std::string& name, uint32_t layer, float* pixels, size_t count) const {
  const size_t expected = size_t(state_->task->delivered().area()) * film::values_of_layer(kind);
  if (count != expected) {
    throw invalid_argument("channel '" + name + "' has " + std::to_string(expected) + " floats, " +
                           std::to_string(count) + " were given");
  }
  state_->task->read_channel(kind, name, layer, pixels);
}

std::string Render::stats_json() const { return state_->task->stats(); }
std::shared_ptr<const film::Film> Render::film() const { return state_->task->film(); }

}  // namespace gradus::render
