#include "film/film.h"

#include <numeric>

#include "base/text_list.h"

namespace gradus::film {

void Counters::add(const Counters& other) {
  static_assert(sizeof(Counters) % sizeof(uint64_t) == 0);
  auto* sum = reinterpret_cast<uint64_t*>(this);
  const auto* term = reinterpret_cast<const uint64_t*>(&other);
  for (size_t i = 0; i < sizeof(Counters) / sizeof(uint64_t); ++i) {
    sum[i] += term[i];
  }
}

Film::Film(uint32_t full_width_, uint32_t full_height_, const Region& region_, int channels_, int components_,
           bool gradients_)
    : full_width(full_width_), full_height(full_height_), region(region_), channels(channels_), gradients(gradients_) {
  const auto pixels = static_cast<size_t>(region.area());
  components.resize(static_cast<size_t>(components_));
  for (ComponentPlanes& component : components) {
    for (int half = 0; half < kHalves; ++half) {
      component.primal[half].assign(pixels, Radiance(0.0f));
      for (auto& plane : component.gradient[half]) {
        plane.assign(gradients ? pixels : 0, Radiance(0.0f));
      }
    }
  }
  for (int half = 0; half < kHalves; ++half) {
    count[half].assign(pixels, 0);
    for (auto& plane : pair_count[half]) {
      plane.assign(gradients ? pixels : 0, 0.0f);
    }
  }
}

namespace {

uint64_t bytes_of(const PixelCorrespondence& correspondence) {
  return correspondence.pixel.size() * sizeof(int32_t) + correspondence.off_centre.size() * sizeof(Vec2);
}

}  // namespace

uint64_t Film::memory_bytes() const {
  uint64_t bytes = sizeof(*this) + fallback.size() * sizeof(float) + bytes_of(replayed.correspondence);
  for (const PixelCorrespondence& own : replayed.of_component) bytes += bytes_of(own);
  for (const ComponentPlanes& component : components) {
    bytes += component.motion.size() * sizeof(Vec4) + component.tracked.size() * sizeof(float) +
             component.shown.size() * sizeof(ShownPoint);
    bytes += component.details.size() * sizeof(NonSpecularDetails);
    for (int half = 0; half < kHalves; ++half) {
      bytes += component.primal[half].size() * sizeof(Radiance) +
               component.non_specular[half].size() * sizeof(NonSpecularVertices);
      for (const auto& plane : component.gradient[half]) {
        bytes += plane.size() * sizeof(Radiance);
      }
    }
  }
  for (int half = 0; half < kHalves; ++half) {
    bytes += count[half].size() * sizeof(uint32_t);
    for (const auto& plane : pair_count[half]) {
      bytes += plane.size() * sizeof(float);
    }
  }
  for (const PassPlane& plane : passes) {
    bytes += (plane.values[0].size() + plane.values[1].size() + plane.weight.size()) * sizeof(float);
  }
  return bytes;
}

std::string component_names(const Film& film) {
  std::string names;
  for (const ComponentPlanes& planes : film.components) add_item(&names, planes.name);
  return names;
}

bool same_components(const Film& a, const Film& b) {
  const auto same = [](const ComponentPlanes& p, const ComponentPlanes& q) {
    return p.name == q.name && p.expression == q.expression;
  };
  return std::equal(a.components.begin(), a.components.end(), b.components.begin(), b.components.end(), same);
}

int find_component(const Film& film, std::string_view name) {
  const auto& list = film.components;
  const auto found =
      std::find_if(list.begin(), list.end(), [&](const ComponentPlanes& planes) { return planes.name == name; });
  return found != list.end() ? int(found - list.begin()) : -1;
}

namespace {

ComponentPlanes black_component(std::string_view name, const ComponentPlanes& like) {
  ComponentPlanes black = like;
  black.name = name;
  std::fill(black.motion.begin(), black.motion.end(), Vec4(0.0f));
  std::fill(black.tracked.begin(), black.tracked.end(), kNothingToTrack);
  std::fill(black.shown.begin(), black.shown.end(), ShownPoint{});
  std::fill(black.details.begin(), black.details.end(), NonSpecularDetails{});
  for (int half = 0; half < kHalves; ++half) {
    std::fill(black.primal[half].begin(), black.primal[half].end(), Radiance(0.0f));
    for (auto& plane : black.gradient[half]) std::fill(plane.begin(), plane.end(), Radiance(0.0f));
    std::fill(black.non_specular[half].begin(), black.non_specular[half].end(), NonSpecularVertices{});
  }
  return black;
}

}  // namespace

void select_component(std::string_view name, Film* film) {
  select_components({std::string(name)}, film);
  ReplayMap& replayed = film->replayed;
  if (replayed.has_component_map(0)) replayed.correspondence = std::move(replayed.of_component[0]);
  replayed.of_component.clear();
}

void select_components(const std::vector<std::string>& names, Film* film) {
  std::vector<ComponentPlanes> kept;
  std::vector<PixelCorrespondence> sources;
  for (const std::string& name : names) {
    const int place = find_component(*film, name);
    const bool has_component_map = place >= 0 && film->replayed.has_component_map(place);
    kept.push_back(place >= 0 ? ComponentPlanes{} : black_component(name, film->components[0]));
    sources.push_back(has_component_map ? std::move(film->replayed.of_component[size_t(place)])
                                        : PixelCorrespondence{});
  }
  for (size_t k = 0; k < names.size(); ++k) {
    const int place = find_component(*film, names[k]);
    if (place >= 0) kept[k] = std::move(film->components[size_t(place)]);
  }
  film->components = std::move(kept);
  film->replayed.of_component = std::move(sources);
}

double mean_samples(const Film& film) {
  uint64_t sum = 0;
  for (const std::vector<uint32_t>& counts : film.count) sum = std::accumulate(counts.begin(), counts.end(), sum);
  return film.region.area() > 0 ? double(sum) / double(film.region.area()) : 0.0;
}

std::vector<uint32_t> samples_of_pixels(const Film& film) {
  std::vector<uint32_t> samples = film.count[0];
  for (size_t i = 0; i < samples.size(); ++i) samples[i] += film.count[1][i];
  return samples;
}

Region delivered_region(const Film& film) {
  const uint32_t* r = film.settings.region;
  if (r[2] == 0 && r[3] == 0) return film.region;
  return {int32_t(r[0]), int32_t(r[1]), int32_t(r[2]), int32_t(r[3])};
}

}  // namespace gradus::film
