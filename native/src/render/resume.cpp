#include "render/resume.h"

#include <algorithm>
#include <string>

#include "base/error.h"
#include "base/text_list.h"
#include "film/film.h"
#include "film/planes.h"
#include "film/scene_channels.h"
#include "schema/options.h"
#include "schema/pass_table.h"
#include "schema/sampling_differences.h"

namespace gradus::render {
namespace {

// Returns the sampling key, taken with the integrator that was used instead of AUTO.
uint64_t key_of(GradusSettings settings, uint32_t integrator) {
  settings.integrator = integrator;
  return schema::sampling_key(settings);
}

// Returns whether a film of this plan may have this integrator. If a pilot found no benefit of gradients, it is PATH.
bool may_contain(const Plan& plan, uint32_t integrator) {
  return integrator == plan.integrator || (plan.pilot && integrator == GRADUS_INTEGRATOR_PATH);
}

void check_channels(const std::vector<film::ChannelInfo>& held, const std::vector<film::ChannelInfo>& sampled) {
  for (const film::ChannelInfo& info : held) {
    if (std::ranges::find(sampled, info) == sampled.end())
      throw invalid_argument("the film holds the channel " + info.name + ", which the render does not sample");
  }
  for (const film::ChannelInfo& info : sampled) {
    if (std::ranges::find(held, info) == held.end()) throw invalid_argument("the film lacks the channel " + info.name);
  }
}

}  // namespace

void check_gradients(const film::Film& film, bool wanted) {
  if (film.gradients != wanted)
    throw invalid_argument(wanted ? "the film holds no gradients" : "the film holds gradients");
}

uint32_t resumed_samples(const film::Film& film, bool adaptively) {
  if (adaptively && !film.shared.rays.empty()) return film.shared.mean;
  const std::vector<uint32_t> counts = film::samples_of_pixels(film);
  const uint32_t usual = counts.empty() ? 0 : *std::ranges::min_element(counts);
  if (!counts.empty() && usual != film.samples.total())
    throw invalid_argument("the film's pixels differ in their sample counts: a render cannot continue from it");
  return usual;
}

lpe::ComponentSet resumed_components(const film::Film& film, const Plan& plan) {
  if (!plan.merges_components) return plan.components;
  uint32_t absent = 0;
  for (int c = 0; c < plan.components.count(); ++c)
    absent |= film::find_component(film, plan.components[c].name) < 0 ? 1u << c : 0u;
  return plan.components.merged(absent);
}

void check_resumable(const film::Film& film, const GradusSettings& settings, const Plan& plan, uint64_t scene_key) {
  if (film.scene_key != scene_key) throw invalid_argument("the film shows another scene");
  if (key_of(film.settings, plan.integrator) != key_of(settings, plan.integrator) ||
      !may_contain(plan, film.settings.integrator)) {
    GradusSettings wanted = settings;
    wanted.integrator = film.settings.integrator;
    const std::string which = schema::sampling_differences(film.settings, wanted);
    throw invalid_argument("the film was sampled with other settings: " +
                           (which.empty() ? "another integrator" : which));
  }
  if (film.region != plan.sampled || film.settings.first_sample != settings.first_sample) {
    throw invalid_argument("the film has another region or first sample");
  }
  const lpe::ComponentSet set = resumed_components(film, plan);
  std::string wanted;
  for (int c = 0; c < set.count(); ++c) add_item(&wanted, set[c].name);
  if (film::component_names(film) != wanted)
    throw invalid_argument("the film holds the components " + film::component_names(film) + ", and the render has " +
                           wanted);
  const std::string gap = film.samples.first_gap(settings.first_sample);
  if (!gap.empty()) throw invalid_argument("the film lacks " + gap + ": render and merge these first");
  if (film.settings.passes != settings.passes) throw invalid_argument("the film was sampled with other passes");
  const film::ComponentContent held = film::component_content(film);
  if ((plan.non_specular_vertices && !held.non_specular) || (plan.non_specular_details && !held.details))
    throw invalid_argument("the film was sampled without the passes of components");
  check_channels(film::other_channels(film), plan.scene_channels);
  const uint64_t kept = film.channels.passes();
  for (const schema::PassInfo& info : schema::stored_passes(plan.passes)) {
    if (!schema::has_bit(kept, info.pass))
      throw invalid_argument("the film lacks " + std::string(info.name) + ", which the reconstruction reads");
  }
  if (resumed_samples(film, settings.noise_threshold > 0.0f) > settings.samples)
    throw invalid_argument("the film has more samples than are asked for");
}

void merge_films(film::Film* film, const film::Film& other) {
  if (film->scene_key != other.scene_key) throw invalid_argument("the films show different scenes");
  if (schema::sampling_key(film->settings) != schema::sampling_key(other.settings))
    throw invalid_argument("the films were sampled with different settings");
  if (!film::same_components(*film, other))
    throw invalid_argument("the films hold different components: " + film::component_names(*film) + ", and " +
                           film::component_names(other));
  if (!film::can_add(*film, other)) throw invalid_argument("the films differ in size or planes");
  if (film->samples.overlap(other.samples)) {
    const uint32_t end = std::max(film->samples.list().back().end, other.samples.list().back().end);
    throw invalid_argument("the films share samples: render one of them with first_sample " + std::to_string(end));
  }
  const bool other_is_first = other.settings.first_sample < film->settings.first_sample;
  film::add_sums(film, other);
  film->shared = {};  // the adaptive states of two films with different samples cannot be combined
  for (const film::SampleRange& range : other.samples.list()) film->samples.add(range);
  if (other_is_first) {
    film->settings.first_sample = other.settings.first_sample;
    film->settings.net_samples = other.settings.net_samples;
  }
  film->settings.samples = uint32_t(std::min<uint64_t>(film->samples.total(), UINT32_MAX));
}

}  // namespace gradus::render
