#include "film/film.h"

#include <numeric>

#include <tbb/parallel_for.h>

#include "base/text_list.h"
#include "film/counter_fields.h"

namespace gradus::film {

void Counters::add(const Counters& other) {
  for (const CounterField& field : kCounterFields) this->*field.value += other.*field.value;
}

namespace {

// Returns zeroed planes of one component.
ComponentPlanes make_component(size_t pixels, bool gradients) {
  ComponentPlanes planes;
  for (int half = 0; half < kHalves; ++half) {
    planes.primal[half].assign(pixels, Radiance(0.0f));
    for (auto& plane : planes.gradient[half]) plane.assign(gradients ? pixels : 0, Radiance(0.0f));
  }
  return planes;
}

void allocate(const ComponentContent& content, size_t pixels, ComponentPlanes* planes) {
  for (auto& half : planes->non_specular) half.assign(content.non_specular ? pixels : 0, NonSpecularVertices{});
  planes->details.assign(content.details ? pixels : 0, NonSpecularDetails{});
  planes->motion.assign(content.motion ? pixels : 0, Vec4(0.0f));
  planes->tracked.assign(content.motion ? pixels : 0, kNothingToTrack);
  planes->shown.assign(content.shown ? pixels : 0, ShownPoint{});
}

}  // namespace

Film::Film(uint32_t full_width_, uint32_t full_height_, const Region& region_, int color_channels_, int components_,
           bool gradients_)
    : full_width(full_width_),
      full_height(full_height_),
      region(region_),
      color_channels(color_channels_),
      gradients(gradients_) {
  const auto pixels = static_cast<size_t>(region.area());
  components.reserve(size_t(components_));
  for (int c = 0; c < components_; ++c) components.push_back(make_component(pixels, gradients));
  for (int half = 0; half < kHalves; ++half) {
    count[half].assign(pixels, 0);
    for (auto& plane : pair_count[half]) plane.assign(gradients ? pixels : 0, 0.0f);
  }
}

void add_pass_channels(uint64_t passes, Film* film) {
  for (const ChannelInfo& info : channels_of_passes(passes)) film->channels.add(info, size_t(film->region.area()));
}

void allocate_component_content(const ComponentContent& content, Film* film) {
  for (ComponentPlanes& planes : film->components) allocate(content, size_t(film->region.area()), &planes);
}

ComponentContent component_content(const Film& film) {
  const ComponentPlanes& planes = film.components.front();
  return {!planes.non_specular[0].empty(), !planes.details.empty(), !planes.motion.empty(), !planes.shown.empty()};
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

void select_component(std::string_view name, Film* film) {
  select_components({std::string(name)}, film);
  ReplayMap& replayed = film->replayed;
  if (replayed.has_component_map(0)) replayed.correspondence = std::move(replayed.of_component[0]);
  replayed.of_component.clear();
}

void select_components(const std::vector<std::string>& names, Film* film) {
  const ComponentContent content = component_content(*film);
  std::vector<ComponentPlanes> kept;
  std::vector<PixelCorrespondence> correspondences;
  for (const std::string& name : names) {
    const int place = find_component(*film, name);
    const bool has_component_map = place >= 0 && film->replayed.has_component_map(place);
    kept.emplace_back();
    if (place < 0) {
      kept.back() = make_component(size_t(film->region.area()), film->gradients);
      allocate(content, size_t(film->region.area()), &kept.back());
      kept.back().name = name;
    }
    correspondences.push_back(has_component_map ? std::move(film->replayed.of_component[size_t(place)])
                                                : PixelCorrespondence{});
  }
  for (size_t k = 0; k < names.size(); ++k) {
    const int place = find_component(*film, names[k]);
    if (place >= 0) kept[k] = std::move(film->components[size_t(place)]);
  }
  film->components = std::move(kept);
  film->replayed.of_component = std::move(correspondences);
}

namespace {

void add(const std::vector<Radiance>& from, std::vector<Radiance>* to) {
  tbb::parallel_for(size_t{0}, to->size(), [&](size_t i) { (*to)[i] += from[i]; });
}

}  // namespace

Film sum_components(const Film& film) {
  Film sum(film.full_width, film.full_height, film.region, film.color_channels, 1, film.gradients);
  sum.count = film.count;
  sum.pair_count = film.pair_count;
  sum.settings = film.settings;
  ComponentPlanes& to = sum.components[0];
  for (const ComponentPlanes& from : film.components) {
    for (size_t half = 0; half < kHalves; ++half) {
      add(from.primal[half], &to.primal[half]);
      for (size_t offset = 0; offset < kOffsets; ++offset) add(from.gradient[half][offset], &to.gradient[half][offset]);
    }
  }
  return sum;
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
