// The stats object of one rendered frame (contract 7.1), without the fields that only the host knows.
#pragma once

#include <string>
#include <vector>

#include "film/film.h"
#include "reconstruct/solver.h"
#include "render/plan.h"

namespace gradus::render {

struct PhaseTimes {
  double sample = 0.0;
  double preview = 0.0;  // what a watcher saw meanwhile
  double reconstruct = 0.0;
  double denoise = 0.0;
  double correspondence = 0.0;  // of a frame of a sequence to the one before
  double store = 0.0;           // reading and writing frames
  void add(const PhaseTimes& other) {
    sample += other.sample;
    preview += other.preview;
    reconstruct += other.reconstruct;
    denoise += other.denoise;
    correspondence += other.correspondence;
    store += other.store;
  }
  double total() const { return sample + preview + reconstruct + denoise + correspondence + store; }
};

struct RenderStats {
  // CPU time of samples is that of our threads, by tiles; that of all else (the pilot, previews, estimates of noise,
  // solves, the denoiser, links, files) is the whole process's meanwhile, what the host does in these moments included.
  PhaseTimes seconds, cpu_seconds;
  double total_seconds = 0.0;
  double process_cpu = 0.0;
  uint32_t threads = 0;  // Threads that took the samples; 0 = unknown.
  std::string denoiser;  // name and version of the host's; empty: none was used
  std::string stopped;   // why sampling ended: samples, noise, time, cancelled
  reconstruct::SolveReport solve;
  std::vector<std::string> warnings;
  Reasons chosen, skipped;        // what was decided after the plan, by samples
  double replayed_samples = 0.0;  // per pixel, those that replay the frame before

  // The work of a second part of the frame.
  void add(const RenderStats& part);
};

std::string stats_json(const RenderStats& stats, const Plan& plan, const film::Film& film);

}  // namespace gradus::render
