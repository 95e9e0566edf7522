#include "animation/stored_samples.h"

#include <cstdio>

#include "animation/frame_record.h"
#include "animation/fresh_replayed_shares.h"
#include "base/fault.h"
#include "base/text_list.h"
#include "film/features.h"
#include "schema/options.h"
#include "schema/pass_table.h"
#include "schema/sampling_differences.h"

namespace gradus::animation {
namespace {

// Returns the names of the passes that are in `passes` but not in `others`, for example "depth, normal".
std::string names_of_missing(uint64_t passes, uint64_t others) {
  std::string names;
  for (uint32_t pass = 0; pass < GRADUS_PASS_COUNT; ++pass) {
    if (schema::has_bit(passes & ~others, pass)) add_item(&names, schema::pass_info(pass).name);
  }
  return names;
}

std::string region_text(const uint32_t* r) {
  if (r[2] == 0 && r[3] == 0) return "the whole frame";
  char text[64];
  std::snprintf(text, sizeof(text), "region %u,%u,%u,%u", r[0], r[1], r[2], r[3]);
  return text;
}

// Whether a requested component pass needs features of surfaces that the stored film lacks.
bool lacks_surfaces(const film::ComponentContent& held, const GradusSettings& settings) {
  if (settings.use_decomposition == 0) return false;
  return (!held.non_specular && schema::any_wanted(settings.component_passes, schema::is_of_non_specular_vertices)) ||
         (!held.details && schema::any_wanted(settings.component_passes, schema::is_of_non_specular_details));
}

}  // namespace

std::string difference(const film::FilmHeader& stored, FrameSamples kind, const GradusSettings& settings,
                       uint64_t scene_key) {
  const GradusSettings& other = stored.settings;
  if (schema::sampling_key(other) != schema::sampling_key(settings) &&
      !GRADUS_FAULT(stored_frame_of_other_settings_accepted))
    return "other settings: " + schema::sampling_differences(other, settings);
  const std::string lacking = names_of_missing(settings.passes, other.passes),
                    beyond = names_of_missing(other.passes, settings.passes);
  if (!lacking.empty()) return "other passes: without " + lacking;
  if (lacks_surfaces(stored.of_components, settings)) return "without the surfaces of components";
  if (kind == FrameSamples::kFresh && schema::needs_flow(settings) && !stored.of_components.shown)
    return "without the motion of components";
  if (!beyond.empty()) return "other passes: with " + beyond;
  if (!show_same_region(other, settings)) return region_text(other.region) + ", not " + region_text(settings.region);
  if (stored.scene_key != scene_key && !GRADUS_FAULT(stored_frame_of_other_scene_accepted)) return "another scene";
  const bool adaptive = other.noise_threshold > 0.0f;
  if (adaptive && !(settings.noise_threshold > 0.0f)) return "a noise threshold, which is 0 now";
  const bool lacks_features = kind == FrameSamples::kFresh && joins_frames(settings) && !film::has_features(stored);
  return lacks_features ? "without the features that reconstruction regularized reads" : "";
}

}  // namespace gradus::animation
