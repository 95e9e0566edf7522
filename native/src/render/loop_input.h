// What a render is made of.
#pragma once

#include <memory>

#include "base/device.h"
#include "frame/frame.h"
#include "render/render.h"

namespace gradus {

struct LoopInput {
  std::shared_ptr<Device> device;
  std::shared_ptr<const Snapshot> snapshot;
  GradusSettings settings{};
  std::shared_ptr<const Frame> resumed;
  IntegratorFactory factory;
  uint32_t threads = 1;

  // An integrator of the snapshot's camera, for settings that may differ from the render's.
  std::unique_ptr<Integrator> make_integrator(const GradusSettings& its_settings, uint32_t integrator) const;
};

}  // namespace gradus
