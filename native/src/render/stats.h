// The statistics of one rendered frame as JSON, without the fields that only the host knows.
#pragma once

#include <string>
#include <vector>

#include "film/film.h"
#include "reconstruct/solve_report.h"
#include "render/plan.h"

namespace gradus::render {

struct PhaseTimes {
  double sample = 0.0;
  double preview = 0.0;  // previews while sampling
  double reconstruct = 0.0;
  double denoise = 0.0;
  double correspondence = 0.0;  // pixel correspondence of a frame of an animation to the previous one
  double store = 0.0;           // reading and writing stored films
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
  // CPU time of sampling, pilots included, is that of the library's threads, measured by tile. CPU time of everything
  // else (previews, noise estimates, solvers, the denoiser, correspondences, files) is that of the whole process in the
  // meantime, including work of the host.
  PhaseTimes seconds, cpu_seconds;
  double total_seconds = 0.0;
  double process_cpu = 0.0;
  uint32_t threads = 0;  // Threads that took the samples; 0 = unknown.
  std::string denoiser;  // name and version of the denoiser; empty: none was used
  std::string stopped;   // why sampling ended: samples, noise, time, cancelled
  reconstruct::SolveReport solve;
  std::vector<std::string> warnings;
  Reasons chosen, skipped;        // choices made after the plan, by samples
  double replayed_samples = 0.0;  // replayed samples per pixel

  // Adds the times and warnings of another render of the same frame.
  void add(const RenderStats& part);
  // Adds the warning that the render leaves something out. Throws `unsupported` if the setting `strict` is on.
  void leave_out(const std::string& warning, bool strict);
};

std::string stats_json(const RenderStats& stats, const Plan& plan, const film::Film& film);

}  // namespace gradus::render
