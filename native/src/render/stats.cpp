#include "render/stats.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/clock.h"
#include "base/error.h"
#include "film/counter_fields.h"
#include "schema/options.h"

namespace gradus::render {
namespace {

using nlohmann::json;

json reasons(const Reasons& planned, const Reasons& later) {
  json result = json::object();
  for (const Reasons* list : {&planned, &later}) {
    for (const auto& [what, why] : *list) result[what] = why;
  }
  return result;
}

json phases(const PhaseTimes& t) {
  return {{"sample", t.sample},
          {"preview", t.preview},
          {"reconstruct", t.reconstruct},
          {"denoise", t.denoise},
          {"correspondence", t.correspondence},
          {"store", t.store}};
}

}  // namespace

void RenderStats::add(const RenderStats& part) {
  seconds.add(part.seconds);
  cpu_seconds.add(part.cpu_seconds);
  total_seconds += part.total_seconds;
  process_cpu += part.process_cpu;
  for (const std::string& warning : part.warnings) {
    if (std::find(warnings.begin(), warnings.end(), warning) == warnings.end()) warnings.push_back(warning);
  }
}

void RenderStats::leave_out(const std::string& warning, bool strict) {
  if (strict) throw unsupported("strict: " + warning);
  warnings.push_back(warning);
}

std::string stats_json(const RenderStats& stats, const Plan& plan, const film::Film& film) {
  const GradusSettings& settings = film.settings;
  const Region& d = plan.delivered;
  json j;
  j["schema"] = 2;
  j["version"] = gradus_version_text();
  j["frame"] = film.frame_number;
  j["resolution"] = {settings.width, settings.height};
  j["region"] = {d.x0, d.y0, d.x1, d.y1};
  j["seed"] = settings.seed;
  j["integrator"] = schema::choice_name(*schema::find_option("integrator"), settings.integrator);
  j["reconstruction"] = schema::choice_name(*schema::find_option("reconstruction"), settings.reconstruction);
  j["denoiser"] = stats.denoiser.empty() ? json(nullptr) : json(stats.denoiser);
  j["unbiased"] = delivers_unbiased(plan, settings.reconstruction, settings.denoiser != GRADUS_DENOISER_NONE);
  for (const film::ComponentPlanes& planes : film.components) j["components"].push_back(planes.name);
  j["samples"] = film::mean_samples(film);
  j["samples_fresh"] = film::mean_samples(film) - stats.replayed_samples;
  j["samples_replayed"] = stats.replayed_samples;
  j["stopped"] = stats.stopped;
  j["plan"] = {{"chosen", reasons(plan.chosen, stats.chosen)}, {"skipped", reasons(plan.skipped, stats.skipped)}};
  j["seconds"] = phases(stats.seconds);
  j["seconds"]["total"] = stats.total_seconds;
  j["cpu_seconds"] = phases(stats.cpu_seconds);
  j["cpu_seconds"]["total"] = stats.cpu_seconds.total();
  j["process_cpu"] = stats.process_cpu;
  if (stats.threads > 0) j["threads"] = stats.threads;
  for (const film::CounterField& field : film::kCounterFields)
    j[json::json_pointer(field.path)] = film.counters.*field.value;
  if (settings.reconstruction != GRADUS_RECONSTRUCTION_NONE) {
    j["solver"] = {{"outer_steps", stats.solve.outer_steps},
                   {"inner_steps", stats.solve.inner_steps},
                   {"residual", stats.solve.residual},
                   {"hit_cap", stats.solve.hit_cap}};
  }
  j["film_memory_bytes"] = film.memory_bytes();
  j["peak_memory_bytes"] = peak_memory_bytes();
  j["warnings"] = stats.warnings;
  if (film.counters.nonfinite_radiance > 0)
    j["warnings"].push_back(
        "light that is not finite or too strong was left out: the strength of a world, a light or an emission");
  if (stats.solve.hit_cap) j["warnings"].push_back("the reconstruction stopped at its limit of steps");
  // Replaces invalid UTF-8 in names, which come from files, so that it does not cause an error.
  return j.dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace gradus::render
