// The input of a render: snapshot, settings, and optional samples to continue from or to replay.
#pragma once

#include <memory>

#include "film/film.h"
#include "film/replay_map.h"
#include "render/component_replay.h"
#include "render/render.h"
#include "scene/device.h"

namespace gradus::render {

// The samples of the previous frame that a frame of an animation replays.
struct Replay {
  film::ReplayMap replay_map;
  std::vector<uint32_t> counts;  // samples of each pixel; empty: the number in the settings
  bool takes_samples = true;     // false: the film only holds the correspondence
  ComponentReplays components;   // replays of single components, by replay_map.of_component
};

struct LoopInput {
  std::shared_ptr<scene::Device> device;
  std::shared_ptr<const scene::Snapshot> snapshot;
  GradusSettings settings{};
  std::shared_ptr<const film::Film> resumed;
  IntegratorFactory factory;
  uint32_t threads = 1;
  // Whether the render only takes samples of a frame of an animation. It then samples all components and is
  // reconstructed later together with other samples of the frame.
  bool samples_only = false;
  bool joins_frames = false;  // whether the reconstruction joins samples of other frames
  // Samples of the whole frame, fresh and replayed, for which the render is planned; 0: the number in the settings.
  uint32_t whole_samples = 0;
  std::shared_ptr<const Replay> replay;  // nullptr: the samples are the frame's own
  bool is_replayed = false;              // whether replays of the samples are compared with them

  // Returns whether the samples are replayed, or compared with replayed ones.
  bool meets_replays() const { return replay || is_replayed; }
  // Returns the settings for which the render is planned.
  GradusSettings planned_settings() const {
    GradusSettings planned = settings;
    if (whole_samples > 0) planned.samples = whole_samples;
    return planned;
  }
  // Makes an integrator for the camera of the snapshot. `its_settings` may differ from the settings of the render.
  std::unique_ptr<integrator::Integrator> make_integrator(const GradusSettings& its_settings, uint32_t integrator,
                                                          lpe::ComponentSet components = {}) const;
};

}  // namespace gradus::render
