#include "light/light_table.h"

#include <algorithm>
#include <cmath>

#include "base/cone.h"

namespace gradus::light {

namespace {

// Fraction of the samples that is divided equally among all groups whose estimate is not zero, because the estimates
// ignore occlusion.
constexpr double kDefensive = 0.2;

// Returns the probability of a group with this weight, where `groups` groups have a weight above 0.
double defended(double weight, double sum, int groups) {
  return weight > 0.0 ? (1.0 - kDefensive) * weight / sum + kDefensive / groups : 0.0;
}

}  // namespace

const LightChoice& LightTable::choose(const Receiver& receiver, LightChoice* storage) const {
  LightChoice* choice = receiver.memo != nullptr ? receiver.memo : storage;
  if (!choice->known || !(choice->receiver == receiver)) {
    tree.cut(receiver, &choice->cut);
    choice->group = choose_group(receiver, choice->cut);
    choice->receiver = receiver;
    choice->known = true;
  }
  return *choice;
}

GroupChoice LightTable::choose_group(const Receiver& receiver, const LightTree::Cut& cut) const {
  if (suns.empty() && world.black()) return {tree.empty() ? 0.0 : 1.0, 0.0, 0.0};
  if (suns.empty() && tree.empty()) return {0.0, 0.0, 1.0};
  const double in_tree = cut.irradiance();
  const double in_suns = irradiance_of_suns(receiver);
  const double in_world = world.irradiance(receiver);
  const double sum = in_tree + in_suns + in_world;
  const int groups = (in_tree > 0.0) + (in_suns > 0.0) + (in_world > 0.0);
  if (groups == 0 || !std::isfinite(sum)) return {};
  return {defended(in_tree, sum, groups), defended(in_suns, sum, groups), defended(in_world, sum, groups)};
}

float LightTable::sun_importance(size_t sun, const Receiver& receiver) const {
  const AnalyticLight& light = analytic_lights[suns[sun]];
  if ((light.links.receivers & receiver.light_sets) == 0) return 0.0f;
  return sun_irradiance[sun] *
         Cone{-light.emission_direction, light.one_minus_cos_sun}.highest_cosine(receiver.normal, receiver.transmits);
}

double LightTable::irradiance_of_suns(const Receiver& receiver) const {
  double sum = 0.0;
  for (size_t i = 0; i < suns.size(); ++i) sum += sun_importance(i, receiver);
  return sum;
}

double LightTable::sun_probability(size_t sun, const Receiver& receiver) const {
  const double sum = irradiance_of_suns(receiver);
  return sum > 0.0 ? sun_importance(sun, receiver) / sum : 0.0;
}

uint32_t LightTable::sample_sun(const Receiver& receiver, double u, double* probability) const {
  const double sum = irradiance_of_suns(receiver);
  double below = 0.0;
  for (size_t i = 0;; ++i) {
    *probability = sum > 0.0 ? sun_importance(i, receiver) / sum : 0.0;
    below += *probability;
    if (u < below || i + 1 == suns.size()) return suns[i];
  }
}

uint32_t LightTable::find_triangle(uint32_t instance, uint32_t triangle) const {
  const auto first = triangles.begin() + first_triangle[instance],
             last = triangles.begin() + first_triangle[instance + 1];
  const auto found =
      std::lower_bound(first, last, triangle, [](const EmissiveTriangle& t, uint32_t id) { return t.triangle < id; });
  return found != last && found->triangle == triangle ? uint32_t(found - triangles.begin()) : UINT32_MAX;
}

}  // namespace gradus::light
