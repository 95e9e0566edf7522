#include "output/light_passes.h"

#include <algorithm>
#include <cmath>

#include "base/cancel_check.h"
#include "base/fault.h"
#include "film/film.h"
#include "film/scene_channels.h"
#include "output/light_pass_samples.h"
#include "reconstruct/box_mean.h"
#include "reconstruct/field_values.h"
#include "reconstruct/regression/feature_filter.h"
#include "reconstruct/regression/picture_terms.h"
#include "reconstruct/solver_planes.h"
#include "schema/pass_table.h"

namespace gradus::output {
namespace {

// Smallest colour by which light is divided. Below it, quotient times colour does not give back the light.
constexpr float kMinColor = 1e-6f;

// Channels that add up to the picture, together with the light that is in none of them if `has_remainder`, or to
// the sum of the picture and of the light that a transparent film hides.
struct Split {
  LightPassPlanes planes;
  bool has_remainder = false;
  const film::Channel* hidden = nullptr;  // light that is not in the picture; null if there is none
};

// Returns the pass with the light that a transparent film hides, which is not in the picture; null if there is none.
const film::Channel* hidden_light(const film::Film& film) {
  return film.settings.film_transparent != 0 ? film.channels.of_pass(GRADUS_PASS_ENVIRONMENT) : nullptr;
}

LightPassPlanes light_planes(const film::Film& film) {
  LightPassPlanes planes;
  const film::Channel* const hidden = hidden_light(film);
  for (const film::Channel& plane : film.channels) {
    if (schema::has_bit(schema::light_passes(), plane.pass) && &plane != hidden) planes.push_back(&plane);
  }
  return planes;
}

LightPassPlanes group_planes(const film::Film& film) {
  LightPassPlanes planes;
  for (const film::Channel& plane : film.channels) {
    if (film::is_light_group(plane)) planes.push_back(&plane);
  }
  return planes;
}

// Returns the ways in which the channels of a film split its light.
std::vector<Split> splits_of(const film::Film& film) {
  const bool are_all = (film.channels.passes() & schema::light_passes()) == schema::light_passes();
  std::vector<Split> splits{{light_planes(film), !are_all}, {group_planes(film), true, hidden_light(film)}};
  std::erase_if(splits, [](const Split& split) { return split.planes.empty(); });
  return splits;
}

// Returns the colour plane by which the pass is divided, or nullptr if there is none.
const film::Channel* color_plane(const film::Film& film, const film::Channel& plane) {
  if (plane.pass == GRADUS_PASS_COUNT) return nullptr;
  const schema::PassInfo& info = schema::pass_info(plane.pass);
  return info.kind == schema::PassKind::Light ? film.channels.of_pass(info.color) : nullptr;
}

// Returns the colour planes of all light passes, each once.
LightPassPlanes color_planes(const film::Film& film) {
  LightPassPlanes colors;
  for (const film::Channel* plane : light_planes(film)) {
    const film::Channel* const color = color_plane(film, *plane);
    if (color != nullptr && std::find(colors.begin(), colors.end(), color) == colors.end()) colors.push_back(color);
  }
  return colors;
}

// Returns the colour of a light pass among the sampled terms, or nullptr if it has none.
const reconstruct::Field* color_of(const film::Film& film, const film::Channel& plane,
                                   const reconstruct::SampledTerms& sampled) {
  const film::Channel* const color = color_plane(film, plane);
  if (color == nullptr) return nullptr;
  const LightPassPlanes planes = color_planes(film);
  return &sampled.colors[size_t(std::find(planes.begin(), planes.end(), color) - planes.begin())];
}

// Returns the pixels of a field of the whole film region that lie in `region`, multiplied by `factor`.
reconstruct::Field crop(const reconstruct::Field& field, const film::Film& film, const Region& region,
                        float factor = 1.0f) {
  reconstruct::Field term(region.width(), region.height(), field.channels());
  const int x0 = region.x0 - film.region.x0, y0 = region.y0 - film.region.y0;
  for_values(&term, [&](float& value, int x, int y, int c) {
    value = std::clamp(factor * field.row(y + y0, c)[x + x0], -kMaxFloat, kMaxFloat);
  });
  return term;
}

// Returns the weight, 0 to 1, with which a pass may take up light that is missing in the sum of all passes. It is small
// at silhouettes, where a surface covers little of a pixel and missing light would become a large quotient.
reconstruct::Field capacity_of(const reconstruct::Field& color) {
  reconstruct::Field capacity = reconstruct::box_mean(color, 1);
  for_values(&capacity, [&](float& value, int x, int y, int c) {
    const float own = color.row(y, c)[x];
    value = own >= kMinColor ? std::min(own / value, 1.0f) : 0.0f;
  });
  return capacity;
}

void divide(const reconstruct::Field& color, reconstruct::Field* light) {
  for_values(light, [&](float& value, int x, int y, int c) {
    const float divisor = color.row(y, c)[x];
    value = divisor >= kMinColor ? std::clamp(value / divisor, -kMaxFloat, kMaxFloat) : 0.0f;
  });
}

// The features that light passes are regressed on.
class Guides {
 public:
  // `picture` is the reconstructed picture of the region.
  Guides(const film::Film& film, const Region& region, const reconstruct::Field& picture)
      : has_features_(film::has_features(film)),
        shared_(has_features_ ? reconstruct::filter_features(film::read_features(film))
                              : features_of(picture, film, region)) {}

  const film::Features& shared() const { return shared_; }
  // Returns the features for one light pass, whose colour is `color`; null if it has none. Diffuse light has the
  // texture of its own colour pass. Reflections and refractions have the texture of the surfaces that the mirror or the
  // glass shows, which the albedo of the film's features holds. The colour pass serves for them only if the film has no
  // features.
  film::Features of(const film::Film& film, const film::Channel& plane, const reconstruct::Field* color) const {
    film::Features own = shared_;
    if (color != nullptr && (!has_features_ || color_plane(film, plane)->pass == GRADUS_PASS_DIFFUSE_COLOR))
      own.albedo = {3, reconstruct::interleave(*color), {}};
    return own;
  }

 private:
  // Returns features for a film that has none. The reconstructed picture stands in for them, because light passes have
  // the same edges. Pixels outside of the region take the value of the nearest pixel inside.
  static film::Features features_of(const reconstruct::Field& picture, const film::Film& film, const Region& region) {
    const int w = film.region.width(), h = film.region.height();
    const size_t pixels = size_t(w) * size_t(h);
    const float scale = reconstruct::robust_scale(picture);
    film::Features features{w,
                            h,
                            {3, std::vector<float>(3 * pixels), {}},
                            {3, std::vector<float>(3 * pixels), {}},
                            {1, std::vector<float>(pixels), {}}};
    for_rows(h, [&](int y) {
      const int from_y = std::clamp(y + film.region.y0 - region.y0, 0, region.height() - 1);
      for (int x = 0; x < w; ++x) {
        const int from_x = std::clamp(x + film.region.x0 - region.x0, 0, region.width() - 1);
        for (int c = 0; c < 3; ++c) {
          const float value = picture.row(from_y, c)[from_x];
          features.normal.values[3 * (size_t(y) * size_t(w) + size_t(x)) + size_t(c)] =
              value / (std::fabs(value) + scale);
        }
      }
    });
    return features;
  }

  bool has_features_;
  film::Features shared_;
};

reconstruct::PictureTerm make_term(const film::Film& film, const Region& region, const film::Features& guides,
                                   reconstruct::HalvedImage sampled, const CancelCheck& cancel) {
  throw_if_cancelled(cancel);
  reconstruct::PictureTerm term = reconstruct::regress_term(guides, std::move(sampled), cancel);
  const float exposure = GRADUS_FAULT(light_passes_lack_exposure) ? 1.0f : film.settings.film_exposure;
  term.image = crop(term.image, film, region, exposure);
  term.error = crop(term.error, film, region, exposure * exposure);
  return term;
}

}  // namespace

reconstruct::SampledTerms read_light_terms(const film::Film& film) {
  reconstruct::SampledTerms terms;
  for (const Split& split : splits_of(film)) {
    for (const film::Channel* plane : split.planes) terms.light.push_back(read_light_pass(film, *plane));
    if (split.has_remainder) terms.light.push_back(read_remainder(film, split.planes, split.hidden));
  }
  if (const film::Channel* hidden = hidden_light(film)) terms.light.push_back(read_light_pass(film, *hidden));
  for (const film::Channel* color : color_planes(film))
    terms.colors.push_back(
        reconstruct::colors_of(read_color(film, *color).values, film.region.width(), film.region.height()));
  return terms;
}

bool has_light_passes(const film::Film& film) { return !splits_of(film).empty() || hidden_light(film) != nullptr; }

SplitLight split_light(const film::Film& film, const Region& region, const std::vector<float>& rgba,
                       reconstruct::SampledTerms sampled, const CancelCheck& cancel) {
  const reconstruct::Field whole = reconstruct::colors_of(rgba, region.width(), region.height());
  const Guides guides(film, region, whole);
  SplitLight result;
  reconstruct::Field with_hidden;
  if (hidden_light(film) != nullptr) {
    with_hidden = whole;
    const reconstruct::PictureTerm hidden =
        make_term(film, region, guides.shared(), std::move(sampled.light.back()), cancel);
    for_values(&with_hidden, [&](float& value, int x, int y, int c) { value += hidden.image.row(y, c)[x]; });
    result.passes[GRADUS_PASS_ENVIRONMENT] = reconstruct::interleave(hidden.image);
  }
  size_t first = 0;  // term of the split's first channel
  for (const Split& split : splits_of(film)) {
    const size_t count = split.planes.size() + (split.has_remainder ? 1 : 0);
    std::vector<reconstruct::PictureTerm> terms;
    std::vector<reconstruct::Field> colors;
    for (size_t k = 0; k < count; ++k) {
      const film::Channel* const plane = k < split.planes.size() ? split.planes[k] : nullptr;
      const reconstruct::Field* const color = plane != nullptr ? color_of(film, *plane, sampled) : nullptr;
      terms.push_back(make_term(film, region, plane != nullptr ? guides.of(film, *plane, color) : guides.shared(),
                                std::move(sampled.light[first + k]), cancel));
      colors.push_back(color != nullptr ? crop(*color, film, region) : reconstruct::Field());
      if (color != nullptr) terms.back().capacity = capacity_of(colors.back());
    }
    throw_if_cancelled(cancel);
    reconstruct::add_up(split.hidden != nullptr ? with_hidden : whole, &terms);
    for (size_t k = 0; k < split.planes.size(); ++k) {
      if (colors[k].width() > 0) divide(colors[k], &terms[k].image);
      const film::Channel& plane = *split.planes[k];
      (film::is_light_group(plane) ? result.groups[plane.info.name] : result.passes[plane.pass]) =
          reconstruct::interleave(terms[k].image);
    }
    first += count;
  }
  return result;
}

LightPasses color_passes(const film::Film& film, const Region& region, const reconstruct::SampledTerms& sampled) {
  LightPasses passes;
  const LightPassPlanes planes = color_planes(film);
  for (size_t k = 0; k < planes.size(); ++k)
    passes[planes[k]->pass] = reconstruct::interleave(crop(sampled.colors[k], film, region));
  return passes;
}

}  // namespace gradus::output
