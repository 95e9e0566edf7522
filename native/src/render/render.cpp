#include "render/render.h"

#include <pthread.h>

#include <csignal>
#include <thread>

#include "base/device.h"
#include "base/error.h"
#include "render/loop.h"
#include "settings/pass_table.h"

namespace gradus {
namespace {

// Signals are the host's: they must reach its threads, not ours, nor the workers that ours start.
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

std::unique_ptr<Integrator> make_integrator(const IntegratorContext& context, uint32_t integrator) {
  return integrator == GRADUS_INTEGRATOR_GRADIENT ? make_gradient_integrator(context) : make_path_integrator(context);
}

struct Render::State {
  State(LoopInput input) : loop(std::move(input)) {}
  RenderLoop loop;
  std::thread thread;
};

Render::Render(std::shared_ptr<Device> device, std::shared_ptr<const Snapshot> snapshot, const GradusSettings& settings,
               std::shared_ptr<const Frame> resumed, const IntegratorFactory& factory) {
  LoopInput input;
  input.threads = settings.threads > 0 ? settings.threads : device ? device->threads() : 1;
  input.device = std::move(device);
  input.snapshot = std::move(snapshot);
  input.settings = settings;
  input.resumed = std::move(resumed);
  input.factory = factory;
  state_ = std::make_unique<State>(std::move(input));
  const BlockSignals blocked;
  state_->thread = std::thread([loop = &state_->loop] {
    pthread_setname_np(pthread_self(), "gradus-render");
    loop->run();
  });
}

Render::~Render() {
  state_->loop.cancel();
  if (state_->thread.joinable()) state_->thread.join();
}

GradusProgress Render::progress() const { return state_->loop.progress(); }
void Render::cancel() { state_->loop.cancel(); }
bool Render::wait(double seconds) { return state_->loop.wait(seconds); }
GradusError Render::outcome(std::string* text) const { return state_->loop.outcome(text); }

void Render::read_pass(uint32_t pass, float* pixels, size_t count) const {
  const Region& region = state_->loop.plan().delivered;
  const PassInfo& info = pass_info(pass);
  const size_t expected = size_t(region.area()) * info.channels;
  if (count != expected) {
    throw invalid_argument("pass " + std::string(info.name) + " has " + std::to_string(expected) + " floats, " + std::to_string(count) +
                           " were given");
  }
  state_->loop.read_pass(pass, pixels);
}

std::string Render::stats_json() const { return state_->loop.stats(); }
std::shared_ptr<const Frame> Render::frame() const { return state_->loop.frame(); }

}  // namespace gradus
