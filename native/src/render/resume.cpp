#include "render/resume.h"

#include <algorithm>
#include <string>

#include "base/error.h"
#include "base/text_list.h"
#include "frame/cells.h"
#include "frame/gate.h"
#include "frame/pass_planes.h"
#include "settings/options.h"
#include "settings/pass_table.h"
#include "settings/sampling_differences.h"

namespace gradus {
namespace {

// The key is taken with the integrator that was used, not with AUTO.
uint64_t key_of(GradusSettings settings, uint32_t integrator) {
  settings.integrator = integrator;
  return sampling_key(settings);
}

template <class T>
void add(std::vector<T>* to, const std::vector<T>& from) {
  for (size_t i = 0; i < to->size(); ++i) (*to)[i] += from[i];
}

void add_planes(PassPlane* to, const PassPlane& from) {
  if (to->first_sample_only) return;  // the frame that has sample 0 came first
  for (int half = 0; half < kHalves; ++half) add(&to->values[half], from.values[half]);
  add(&to->weight, from.weight);
}

bool same_planes(const Frame& a, const Frame& b) {
  const KeptOfComponents of_a = kept_of_components(a), of_b = kept_of_components(b);
  if (of_a.rough != of_b.rough || of_a.details != of_b.details) return false;
  if (a.passes.size() != b.passes.size() || a.fallback.size() != b.fallback.size()) return false;
  for (size_t i = 0; i < a.passes.size(); ++i) {
    if (a.passes[i].pass != b.passes[i].pass) return false;
  }
  return true;
}

// A pilot may have found that gradients pay nowhere.
bool may_hold(const Plan& plan, uint32_t integrator) {
  return integrator == plan.integrator || (plan.pilot && integrator == GRADUS_INTEGRATOR_PATH);
}

}  // namespace

void check_gradients(const Frame& frame, bool wanted) {
  if (frame.gradients != wanted) throw invalid_argument(wanted ? "the frame holds no gradients" : "the frame holds gradients");
}

uint32_t resumed_samples(const Frame& frame, bool adaptively) {
  const bool by_cells = adaptively && !frame.shared.rays.empty();
  for (const Region& part : by_cells ? make_cells(frame.region) : std::vector<Region>{frame.region}) {
    const uint32_t first = samples_at(frame, frame.index(part.x0, part.y0));
    for (int32_t y = part.y0; y < part.y1; ++y) {
      for (int32_t x = part.x0; x < part.x1; ++x) {
        if (samples_at(frame, frame.index(x, y)) == first) continue;
        throw invalid_argument("the frame's pixels differ in their sample counts: a render cannot go on from it");
      }
    }
  }
  if (by_cells) return frame.shared.mean;
  return frame.region.area() > 0 ? samples_at(frame, 0) : 0;
}

ComponentSet resumed_components(const Frame& frame, const Plan& plan) {
  if (!plan.merges_components) return plan.components;
  uint32_t absent = 0;
  for (int c = 0; c < plan.components.count(); ++c) absent |= find_component(frame, plan.components[c].name) < 0 ? 1u << c : 0u;
  return plan.components.merged(absent);
}

void check_resumable(const Frame& frame, const GradusSettings& settings, const Plan& plan, uint64_t scene_key) {
  if (frame.scene_key != scene_key) throw invalid_argument("the frame shows another scene");
  if (key_of(frame.settings, plan.integrator) != key_of(settings, plan.integrator) || !may_hold(plan, frame.settings.integrator)) {
    GradusSettings wanted = settings;
    wanted.integrator = frame.settings.integrator;
    const std::string which = sampling_differences(frame.settings, wanted);
    throw invalid_argument("the frame was sampled with other settings: " + (which.empty() ? "another integrator" : which));
  }
  if (frame.region != plan.sampled || frame.settings.first_sample != settings.first_sample) {
    throw invalid_argument("the frame has another region or first sample");
  }
  const ComponentSet set = resumed_components(frame, plan);
  std::string wanted;
  for (int c = 0; c < set.count(); ++c) add_item(&wanted, set[c].name);
  if (component_names(frame) != wanted)
    throw invalid_argument("the frame holds the components " + component_names(frame) + ", and the render has " + wanted);
  const std::string gap = frame.samples.first_gap(settings.first_sample);
  if (!gap.empty()) throw invalid_argument("the frame lacks " + gap + ": render and merge these first");
  if (frame.settings.passes != settings.passes) throw invalid_argument("the frame was sampled with other passes");
  const KeptOfComponents held = kept_of_components(frame);
  if ((plan.rough_vertices && !held.rough) || (plan.rough_details && !held.details))
    throw invalid_argument("the frame was sampled without the passes of components");
  const uint64_t kept = kept_passes(frame);
  for (const PassInfo& info : stored_passes(plan.passes)) {
    if (!wants(kept, info.pass)) throw invalid_argument("the frame lacks " + std::string(info.name) + ", which the reconstruction reads");
  }
  if (resumed_samples(frame, settings.noise_threshold > 0.0f) > settings.samples)
    throw invalid_argument("the frame has more samples than are asked for");
}

void add_sums(Frame* frame, const Frame& other) {
  for (size_t c = 0; c < frame->components.size(); ++c) {
    std::vector<RoughDetails>& details = frame->components[c].details;
    for (size_t i = 0; i < details.size(); ++i) add_details(other.components[c].details[i], &details[i], &frame->counters);
  }
  for (int half = 0; half < kHalves; ++half) {
    for (size_t c = 0; c < frame->components.size(); ++c) {
      add(&frame->components[c].primal[half], other.components[c].primal[half]);
      for (size_t i = 0; i < frame->components[c].rough[half].size(); ++i) {
        add_rough(other.components[c].rough[half][i], &frame->components[c].rough[half][i], &frame->counters);
      }
      for (int o = 0; o < kOffsets; ++o) add(&frame->components[c].gradient[half][o], other.components[c].gradient[half][o]);
    }
    add(&frame->count[half], other.count[half]);
    for (int o = 0; o < kOffsets; ++o) add(&frame->pair_count[half][o], other.pair_count[half][o]);
  }
  for (size_t i = 0; i < frame->passes.size(); ++i) add_planes(&frame->passes[i], other.passes[i]);
  add(&frame->fallback, other.fallback);
  frame->counters.add(other.counters);
}

void merge_frames(Frame* frame, const Frame& other) {
  if (frame->scene_key != other.scene_key) throw invalid_argument("the frames show different scenes");
  if (sampling_key(frame->settings) != sampling_key(other.settings))
    throw invalid_argument("the frames were sampled with different settings");
  if (frame->region != other.region || frame->channels != other.channels || frame->gradients != other.gradients ||
      !same_planes(*frame, other)) {
    throw invalid_argument("the frames differ in size or planes");
  }
  if (!same_components(*frame, other))
    throw invalid_argument("the frames hold different components: " + component_names(*frame) + ", and " + component_names(other));
  if (frame->samples.overlap(other.samples)) {
    const uint32_t end = std::max(frame->samples.list().back().end, other.samples.list().back().end);
    throw invalid_argument("the frames share samples: render one of them with first_sample " + std::to_string(end));
  }
  const bool other_is_first = other.settings.first_sample < frame->settings.first_sample;
  for (size_t i = 0; i < frame->passes.size(); ++i) {
    if (frame->passes[i].first_sample_only && other_is_first) frame->passes[i] = other.passes[i];
  }
  add_sums(frame, other);
  frame->shared = {};  // each has taken other samples of a cell
  for (const SampleRange& range : other.samples.list()) frame->samples.add(range);
  if (other_is_first) frame->settings.first_sample = other.settings.first_sample;
  frame->settings.samples = uint32_t(std::min<uint64_t>(frame->samples.total(), UINT32_MAX));
}

}  // namespace gradus
