#include "animation/component_flows.h"

#include <algorithm>

#include "film/region_pixels.h"
#include "lpe/components.h"
#include "schema/pass_table.h"

namespace gradus::animation {
namespace {

// Motion of a component towards the previous or the next frame, found by following surfaces and specular chains.
struct KnownMotion {
  std::vector<Vec2> vectors;   // to the other frame, in pixels, for each delivered pixel
  std::vector<float> tracked;  // kTracked or a negative cause (motion/tracking.h)
};

KnownMotion known_motion(const output::DevelopedFilm& developed, size_t component, Side side) {
  const film::ComponentPlanes& planes = developed.film->components[component];
  const auto pixels = size_t(developed.region.area());
  KnownMotion known{std::vector<Vec2>(pixels), std::vector<float>(pixels)};
  for_pixels(*developed.film, developed.region, [&](size_t i, size_t out) {
    const Vec4& motion = planes.motion[i];
    known.vectors[out] = side == Side::Previous ? Vec2(motion) : -Vec2(motion.z, motion.w);
    known.tracked[out] = planes.tracked[i];
  });
  return known;
}

// Returns the radiance or irradiance on which the flow is estimated. The film's exposure is divided out, because it may
// change from frame to frame.
std::vector<Rgb> light_of(const output::DevelopedFilm& developed, const FlowKind& kind) {
  const Region& region = developed.region;
  const uint32_t pass =
      kind.domain == motion::FlowDomain::Logarithmic ? GRADUS_COMPONENT_IRRADIANCE : GRADUS_COMPONENT_COLOR;
  std::vector<float> values(3 * size_t(region.area()));
  developed.read_component(developed.film->components[kind.component].name, pass, values.data());
  const float exposure = developed.film->settings.film_exposure, factor = exposure > 0.0f ? 1.0f / exposure : 1.0f;
  std::vector<Rgb> light(values.size() / 3);
  for_pixels(*developed.film, region, [&](size_t, size_t out) {
    const float* const value = &values[3 * out];
    light[out] = factor * Rgb(value[0], value[1], value[2]);
  });
  return light;
}

// Owns what optical flow reads of one component of one frame.
class FlowInput {
 public:
  FlowInput(const output::DevelopedFilm& developed, const FlowKind& kind, Side side)
      : light_(light_of(developed, kind)),
        known_(known_motion(developed, kind.component, side)),
        object_(light_.size()),
        depth_(light_.size()) {
    const std::vector<film::ShownPoint>& shown = developed.film->components[kind.component].shown;
    for_pixels(*developed.film, developed.region, [&](size_t i, size_t out) {
      object_[out] = int32_t(shown[i].object);
      depth_[out] = shown[i].depth;
    });
  }
  motion::ComponentFrame view() const { return {light_, known_.vectors, known_.tracked, object_, depth_}; }

 private:
  std::vector<Rgb> light_;
  KnownMotion known_;
  std::vector<int32_t> object_;
  std::vector<float> depth_;
};

// Returns the index in @p kinds of the flow of a component in a domain, or the size of @p kinds if there is none.
size_t place_of(const std::vector<FlowKind>& kinds, const output::DevelopedFilm& developed,
                const std::string& component, motion::FlowDomain domain) {
  const auto found = std::find_if(kinds.begin(), kinds.end(), [&](const FlowKind& kind) {
    return kind.domain == domain && developed.film->components[kind.component].name == component;
  });
  return size_t(found - kinds.begin());
}

}  // namespace

std::vector<FlowKind> wanted_flows(const film::Film& film) {
  std::vector<FlowKind> kinds;
  const uint32_t passes = film.settings.component_passes;
  const bool of_irradiance = schema::any_wanted(passes, schema::is_irradiance_motion);
  const bool of_residual =
      schema::has_bit(passes, GRADUS_COMPONENT_MOTION) || schema::has_bit(passes, GRADUS_COMPONENT_TRACKED);
  for (size_t c = 0; c < film.components.size(); ++c) {
    if (of_residual && film.components[c].name == lpe::kResidual) kinds.push_back({c, motion::FlowDomain::Linear});
    if (of_irradiance) kinds.push_back({c, motion::FlowDomain::Logarithmic});
  }
  return kinds;
}

std::array<FrameFlows, 2> flows_between(const motion::FlowLibrary& library, const output::DevelopedFilm& first,
                                        const output::DevelopedFilm& second) {
  const std::vector<FlowKind> kinds = wanted_flows(*first.film), others = wanted_flows(*second.film);
  std::array<FrameFlows, 2> flows{FrameFlows(kinds.size()), FrameFlows(others.size())};
  const Region& region = first.region;
  for (size_t k = 0; k < kinds.size(); ++k) {
    const std::string& name = first.film->components[kinds[k].component].name;
    const size_t other = place_of(others, second, name, kinds[k].domain);
    if (other == others.size()) continue;
    const FlowInput a(first, kinds[k], Side::Next), b(second, others[other], Side::Previous);
    std::array<motion::PixelMotion, 2> motion =
        motion::irradiance_motion(&library, region.width(), region.height(), a.view(), b.view(), kinds[k].domain);
    flows[0][k] = std::move(motion[0]);
    flows[1][other] = std::move(motion[1]);
  }
  return flows;
}

void complete_flows(const output::DevelopedFilm& frame, Side side, motion::Tracking cause, FrameFlows* flows) {
  const std::vector<FlowKind> kinds = wanted_flows(*frame.film);
  flows->resize(kinds.size());
  for (size_t k = 0; k < kinds.size(); ++k) {
    if (!(*flows)[k].vectors.empty()) continue;
    KnownMotion known = known_motion(frame, kinds[k].component, side);
    for (float& tracked : known.tracked) tracked = tracked == motion::kTracked ? float(cause) : tracked;
    (*flows)[k] = {std::move(known.vectors), std::move(known.tracked)};
  }
}

void store_flows(const FrameFlows& previous, const FrameFlows& next, output::DevelopedFilm* frame) {
  const std::vector<FlowKind> kinds = wanted_flows(*frame->film);
  for (size_t k = 0; k < kinds.size(); ++k) {
    const motion::PixelMotion &before = previous[k], &after = next[k];
    std::vector<float> vectors(4 * before.vectors.size()), tracked = before.tracked;
    for_pixels(*frame->film, frame->region, [&](size_t, size_t out) {
      const Vec4 vector(before.vectors[out], -after.vectors[out]);
      std::copy_n(&vector[0], 4, &vectors[4 * out]);
      if (tracked[out] == motion::kTracked) tracked[out] = after.tracked[out];
    });
    const bool of_irradiance = kinds[k].domain == motion::FlowDomain::Logarithmic;
    const uint32_t vector_pass = of_irradiance ? GRADUS_COMPONENT_IRRADIANCE_MOTION : GRADUS_COMPONENT_MOTION,
                   tracked_pass = of_irradiance ? GRADUS_COMPONENT_IRRADIANCE_TRACKED : GRADUS_COMPONENT_TRACKED;
    const int component = int(kinds[k].component);
    frame->component_passes[{component, vector_pass}] = output::make_image(std::move(vectors));
    frame->component_passes[{component, tracked_pass}] = output::make_image(std::move(tracked));
  }
}

}  // namespace gradus::animation
