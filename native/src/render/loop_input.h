// What a render is made of.
#pragma once

#include <memory>

#include "film/film.h"
#include "film/replay_map.h"
#include "render/component_replay.h"
#include "render/render.h"
#include "scene/device.h"

namespace gradus::render {

// What a frame of a sequence repeats of the frame before (contract 4.2).
struct Replay {
  film::ReplayMap replay_map;
  std::vector<uint32_t> counts;  // samples of each pixel; empty: those of the settings
  ComponentReplays components;   // of the sources
};

// Threads that a render with these settings has. device: may be nullptr if settings.threads is set.
inline uint32_t threads_of(const GradusSettings& settings, const scene::Device* device) {
  return settings.threads > 0 ? settings.threads : device != nullptr ? device->threads() : 1;
}

struct LoopInput {
  std::shared_ptr<scene::Device> device;
  std::shared_ptr<const scene::Snapshot> snapshot;
  GradusSettings settings{};
  std::shared_ptr<const film::Film> resumed;
  IntegratorFactory factory;
  uint32_t threads = 1;
  // A part of a frame of a sequence: it is sampled everywhere, and reconstructed later, with others.
  bool samples_only = false;
  uint32_t whole_samples = 0;            // of the frame, by which both parts are planned; 0: those of the settings
  std::shared_ptr<const Replay> replay;  // nullptr: the samples are the frame's own

  // What the plan goes by.
  GradusSettings planned_settings() const {
    GradusSettings planned = settings;
    if (whole_samples > 0) planned.samples = whole_samples;
    return planned;
  }
  // An integrator of the snapshot's camera, for settings that may differ from the render's.
  std::unique_ptr<integrator::Integrator> make_integrator(const GradusSettings& its_settings, uint32_t integrator,
                                                          lpe::ComponentSet components = {}) const;
};

}  // namespace gradus::render
