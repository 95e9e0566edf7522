#include "light/light_table.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/cone.h"
#include "light/eighths.h"

namespace gradus::light {

GroupChoice choose_group(const GroupIrradiance& irradiance, const GroupFactors& factors) {
  GroupChoice choice{irradiance.tree * factors.tree, irradiance.suns * factors.suns, irradiance.world * factors.world};
  const double sum = choice.tree + choice.suns + choice.world;
  if (!(sum > 0.0) || !std::isfinite(sum)) return {};
  if (choice.tree == sum) return {1.0, 0.0, 0.0};  // the result of the code below, for the most common case
  double* const groups[] = {&choice.tree, &choice.suns, &choice.world};
  double* const largest =
      *std::max_element(std::begin(groups), std::end(groups), [](const double* a, const double* b) { return *a < *b; });
  double rest = 1.0;
  for (double* group : groups) {
    if (group == largest) continue;
    if (*group > 0.0) *group = std::max(kEighth, in_eighths(*group / sum));
    rest -= *group;
  }
  *largest = rest;
  return choice;
}

const LightChoice& LightTable::choose(const Receiver& receiver, LightChoice* storage) const {
  LightChoice* choice = receiver.memo != nullptr ? receiver.memo : storage;
  if (!choice->known || !(choice->receiver == receiver)) {
    tree.cut(receiver, &choice->cut);
    choice->group = choose_group(irradiance(receiver, choice->cut), factors);
    choice->receiver = receiver;
    choice->known = true;
  }
  return *choice;
}

GroupIrradiance LightTable::irradiance(const Receiver& receiver, const LightTree::Cut& cut) const {
  return {cut.irradiance(), irradiance_of_suns(receiver), world.irradiance(receiver)};
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
