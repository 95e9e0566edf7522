#include "film/planes.h"

#include <algorithm>
#include <iterator>
#include <mutex>
#include <numeric>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "base/error.h"
#include "base/fpu.h"
#include "film/finite_check.h"
#include "film/plane_names.h"

namespace gradus::film {
namespace {

static_assert(std::size(plane_names::kHalfNames) == kHalves && std::size(plane_names::kOffsetNames) == kOffsets);
constexpr const char* kColorNames[4] = {"R", "G", "B", "A"};
constexpr const char* kVectorNames[4] = {"X", "Y", "Z", "W"};

std::vector<PlaneField> color_fields(int color_channels) {
  std::vector<PlaneField> fields;
  for (int c = 0; c < color_channels; ++c) fields.push_back({kColorNames[c], size_t(c) * sizeof(float)});
  return fields;
}

std::vector<PlaneField> vector_fields(uint32_t values) {
  std::vector<PlaneField> fields;
  for (uint32_t c = 0; c < values; ++c) fields.push_back({values == 1 ? "V" : kVectorNames[c], c * sizeof(float)});
  return fields;
}

std::vector<PlaneField> pair_fields(uint32_t values) {
  std::vector<PlaneField> fields;
  for (uint32_t c = 0; c < values; ++c)
    fields.push_back({(c % 2 == 0 ? "id" : "weight") + std::to_string(c / 2), c * sizeof(float)});
  return fields;
}

// Appends the fields of a member that is a vector of three floats.
void add_three(const std::string& name, const char* const* letters, size_t offset, std::vector<PlaneField>* fields) {
  for (size_t c = 0; c < 3; ++c) fields->push_back({name + "." + letters[c], offset + c * sizeof(float)});
}

// Appends the field of a member that is a float.
void add_one(const std::string& name, size_t offset, std::vector<PlaneField>* fields) {
  fields->push_back({name + ".V", offset});
}

std::vector<PlaneField> non_specular_fields() {
  std::vector<PlaneField> fields;
  add_three(plane_names::kReflectance, kColorNames, offsetof(NonSpecularVertices, reflectance), &fields);
  add_three(plane_names::kNormal, kVectorNames, offsetof(NonSpecularVertices, normal), &fields);
  add_one(plane_names::kInverseDepth, offsetof(NonSpecularVertices, inverse_depth), &fields);
  add_one(plane_names::kSamples, offsetof(NonSpecularVertices, samples), &fields);
  return fields;
}

std::vector<PlaneField> detail_fields() {
  std::vector<PlaneField> fields;
  add_three("uv", kVectorNames, offsetof(NonSpecularDetails, uv), &fields);
  add_three("emission", kColorNames, offsetof(NonSpecularDetails, emission), &fields);
  add_one("segments", offsetof(NonSpecularDetails, segments), &fields);
  add_one("object", offsetof(NonSpecularDetails, object), &fields);
  add_one("face", offsetof(NonSpecularDetails, face), &fields);
  fields.push_back({"sample.V", offsetof(NonSpecularDetails, sample), true});
  return fields;
}

std::string component_layer(size_t component) { return plane_names::kComponentPrefix + std::to_string(component); }

std::string half_name(int half) { return plane_names::kHalfNames[half]; }

// Returns the layer of a component's half-buffer. Component 0 has no prefix, so that programs show its layer as the
// main one.
std::string half_layer(size_t component, int half) {
  return (component == 0 ? "" : component_layer(component) + ".") + half_name(half);
}

std::string part_of(const std::string& name, size_t component) {
  return component == 0 ? name : name + "." + component_layer(component);
}

// Collects planes. Vectors without values are left out.
class PlaneList {
 public:
  PlaneList(Film* film, PlaneNames names)
      : film_(film),
        correspondence_(names == PlaneNames::kOlder ? plane_names::kOldCorrespondence : plane_names::kCorrespondence),
        non_specular_(names == PlaneNames::kOlder ? plane_names::kOldNonSpecular : plane_names::kNonSpecular) {}

  void add_samples(size_t component) {
    const std::string part = part_of(plane_names::kSamples, component);
    for (int half = 0; half < kHalves; ++half)
      add(part, half_layer(component, half), MergeRule::kAdd, color_fields(film_->color_channels),
          &film_->components[component].primal[half], &Counters::nonfinite_radiance);
    if (film_->replayed.has_component_map(int(component)))
      add_correspondence(part, component_layer(component) + "." + correspondence_,
                         &film_->replayed.of_component[component]);
  }

  void add_counts() {
    for (int half = 0; half < kHalves; ++half)
      add(plane_names::kCounts, half_name(half) + "." + plane_names::kCount, MergeRule::kAdd, {{"V", 0, true}},
          &film_->count[half]);
    add_correspondence(plane_names::kCounts, correspondence_, &film_->replayed.correspondence);
  }

  void add_gradients(size_t component) {
    for (int half = 0; half < kHalves; ++half) {
      for (int o = 0; o < kOffsets; ++o)
        add(part_of(plane_names::kGradients, component),
            half_layer(component, half) + "." + plane_names::kOffsetNames[o], MergeRule::kAdd,
            color_fields(film_->color_channels), &film_->components[component].gradient[half][o],
            &Counters::nonfinite_gradient);
    }
  }

  void add_pair_counts() {
    for (int half = 0; half < kHalves; ++half) {
      for (int o = 0; o < kOffsets; ++o)
        add(plane_names::kPairs, half_name(half) + "." + plane_names::kOffsetNames[o] + "." + plane_names::kPairs,
            MergeRule::kAdd, vector_fields(1), &film_->pair_count[half][o]);
    }
  }

  void add_non_specular(size_t component) {
    for (int half = 0; half < kHalves; ++half)
      add(part_of(non_specular_, component), half_layer(component, half), MergeRule::kAdd, non_specular_fields(),
          &film_->components[component].non_specular[half]);
  }

  void add_details(size_t component) {
    add(part_of(plane_names::kDetails, component), component_layer(component), MergeRule::kAdd, detail_fields(),
        &film_->components[component].details);
  }

  void add_motion(size_t component) {
    ComponentPlanes& planes = film_->components[component];
    const std::string part = part_of(plane_names::kMotion, component), layer = component_layer(component);
    add(part, layer + "." + plane_names::kMotion, MergeRule::kKeep, vector_fields(4), &planes.motion);
    add(part, layer + ".tracked", MergeRule::kKeep, vector_fields(1), &planes.tracked);
    add(part, layer + ".shown", MergeRule::kKeep,
        {{"object.V", offsetof(ShownPoint, object)}, {"depth.V", offsetof(ShownPoint, depth)}}, &planes.shown);
  }

  // Each channel in half-buffers is a part of its own, because such channels are large and some readers need only one.
  void add_channel(Channel* channel) {
    const ChannelInfo& info = channel->info;
    const std::string name = stored_name(info.name);
    const bool pairs = info.type == ValueType::kIdAndWeight;
    const MergeRule rule = channel->keeps_first_sample() ? MergeRule::kFirstSample : MergeRule::kAdd;
    for (int half = 0; half < kHalves; ++half) {
      if (channel->values[half].empty()) continue;
      add(info.in_halves ? name : plane_names::kPasses, info.in_halves ? half_name(half) + "." + name : name, rule,
          pairs ? pair_fields(info.values_per_pixel) : vector_fields(info.values_per_pixel), &channel->values[half]);
      list_.back().pixel_bytes = info.values_per_pixel * sizeof(float);
      if (pairs) list_.back().pairs = channel;
    }
    add(plane_names::kPasses, name + plane_names::kWeightSuffix, rule, vector_fields(1), &channel->weight);
  }

  std::vector<Plane> take() { return std::move(list_); }

 private:
  void add_correspondence(const std::string& part, const std::string& layer, PixelCorrespondence* correspondence) {
    add(part, layer, MergeRule::kKeep, {{"V", 0, true}}, &correspondence->pixel);
    add(part, layer + ".off_centre", MergeRule::kKeep, vector_fields(2), &correspondence->off_centre);
  }

  template <class T>
  void add(const std::string& part, const std::string& layer, MergeRule merge, std::vector<PlaneField> fields,
           std::vector<T>* values, uint64_t Counters::*dropped = &Counters::nonfinite_feature) {
    if (values->empty()) return;
    list_.push_back({part, layer, merge, std::move(fields), sizeof(T), values});
    list_.back().dropped = dropped;
  }

  Film* const film_;
  const std::string correspondence_, non_specular_;  // names of planes and parts
  std::vector<Plane> list_;
};

// The functions add_values() add `count` values to a plane of any type that consists of sums.
void add_values(const NonSpecularVertices* from, const Plane&, size_t count, NonSpecularVertices* to,
                Counters* counters) {
  for (size_t i = 0; i < count; ++i) add_non_specular(from[i], &to[i], counters);
}

void add_values(const NonSpecularDetails* from, const Plane&, size_t count, NonSpecularDetails* to,
                Counters* counters) {
  for (size_t i = 0; i < count; ++i) add_details(from[i], &to[i], counters);
}

void add_values(const uint32_t* from, const Plane&, size_t count, uint32_t* to, Counters*) {
  for (size_t i = 0; i < count; ++i) to[i] += from[i];
}

void add_pairs(const float* from, uint32_t values_per_pixel, size_t count, float* to, Counters* counters) {
  for (size_t first = 0; first < count; first += values_per_pixel) {
    for (size_t i = first; i < first + values_per_pixel; i += 2)
      add_pair(from[i], from[i + 1], values_per_pixel / 2, to + first, counters);
  }
}

template <class T>
uint64_t add_sums_that_fit(const T* from, size_t count, T* to) {
  uint64_t dropped = 0;
  for (size_t i = 0; i < count; ++i) {
    const T sum = to[i] + from[i];
    const bool fit = fits(sum);
    to[i] = fit ? sum : to[i];
    dropped += fit ? 0 : 1;
  }
  return dropped;
}

void add_values(const float* from, const Plane& plane, size_t count, float* to, Counters* counters) {
  if (plane.pairs != nullptr) return add_pairs(from, plane.pairs->info.values_per_pixel, count, to, counters);
  counters->*plane.dropped += add_sums_that_fit(from, count, to);
}

void add_values(const Vec4* from, const Plane& plane, size_t count, Vec4* to, Counters* counters) {
  counters->*plane.dropped += add_sums_that_fit(from, count, to);
}

template <class T>
void add_values(const T*, const Plane&, size_t, T*, Counters*) {
  throw invalid_operation("a plane of values that cannot be added has the merge rule kAdd");
}

using PixelRange = tbb::blocked_range<size_t>;

void add_pixels(const Plane& from, bool is_first, const PixelRange& pixels, const Plane& to, Counters* counters) {
  std::visit(
      [&](auto* values) {
        const size_t per_pixel = to.pixel_bytes / sizeof(values->front());
        const size_t first = pixels.begin() * per_pixel, count = pixels.size() * per_pixel;
        const auto* others = std::get<decltype(values)>(from.values)->data() + first;
        if (to.merge == MergeRule::kAdd) {
          add_values(others, to, count, values->data() + first, counters);
        } else if (to.merge == MergeRule::kFirstSample && is_first) {
          std::copy_n(others, count, values->data() + first);
        }
      },
      to.values);
}

// Returns the planes that change when films are merged.
std::vector<Plane> merged_planes(const Film& film) {
  std::vector<Plane> planes = planes_of(film);
  std::erase_if(planes, [](const Plane& plane) { return plane.merge == MergeRule::kKeep; });
  return planes;
}

bool same_kind(const Plane& a, const Plane& b) {
  return a.layer == b.layer && a.values.index() == b.values.index() && a.bytes() == b.bytes();
}

bool same_channels(const Film& a, const Film& b) {
  return std::ranges::equal(a.channels, b.channels,
                            [](const Channel& p, const Channel& q) { return p.info == q.info; });
}

}  // namespace

unsigned char* Plane::data() const {
  return std::visit([](auto* values) { return reinterpret_cast<unsigned char*>(values->data()); }, values);
}

size_t Plane::bytes() const {
  return std::visit([](auto* values) { return values->size() * sizeof((*values)[0]); }, values);
}

std::vector<Plane> planes_of(Film* film, PlaneNames names) {
  PlaneList list(film, names);
  const size_t components = film->components.size();
  for (size_t c = 0; c < components; ++c) list.add_samples(c);
  list.add_counts();
  for (size_t c = 0; c < components; ++c) list.add_gradients(c);
  list.add_pair_counts();
  for (size_t c = 0; c < components; ++c) list.add_non_specular(c);
  for (size_t c = 0; c < components; ++c) list.add_details(c);
  for (size_t c = 0; c < components; ++c) list.add_motion(c);
  for (Channel& channel : film->channels) list.add_channel(&channel);
  return list.take();
}

std::vector<Plane> planes_of(const Film& film) { return planes_of(const_cast<Film*>(&film)); }

uint64_t Film::memory_bytes() const {
  const std::vector<Plane> planes = planes_of(*this);
  const auto add = [](uint64_t sum, const Plane& plane) { return sum + plane.bytes(); };
  return std::accumulate(planes.begin(), planes.end(), uint64_t{sizeof(*this)}, add);
}

uint64_t film_bytes_per_pixel(int components, bool gradients, const std::vector<ChannelInfo>& channels,
                              const ComponentContent& content) {
  Film pixel(1, 1, Region{0, 0, 1, 1}, 3, components, gradients);
  allocate_component_content(content, &pixel);
  for (const ChannelInfo& info : channels) pixel.channels.add(info, 1);
  return pixel.memory_bytes() - sizeof(Film);
}

bool can_add(const Film& film, const Film& other) {
  return film.full_width == other.full_width && film.full_height == other.full_height && film.region == other.region &&
         film.color_channels == other.color_channels && same_components(film, other) && same_channels(film, other) &&
         std::ranges::equal(merged_planes(film), merged_planes(other), same_kind);
}

void add_sums(Film* film, const Film& other) {
  const bool other_is_first = other.settings.first_sample < film->settings.first_sample;
  const std::vector<Plane> planes = merged_planes(*film), others = merged_planes(other);
  constexpr size_t kPixels = 4096;  // pixels per task
  std::mutex counters_mutex;
  tbb::parallel_for(PixelRange(0, size_t(film->region.area()), kPixels), [&](const PixelRange& pixels) {
    const FlushDenormals flush;
    Counters dropped;
    for (size_t i = 0; i < planes.size(); ++i) add_pixels(others[i], other_is_first, pixels, planes[i], &dropped);
    const std::lock_guard lock(counters_mutex);
    film->counters.add(dropped);
  });
  for (size_t i = 0; i < film->channels.size(); ++i) {
    for (int half = 0; half < kHalves; ++half) film->channels[i].paths[half] += other.channels[i].paths[half];
  }
  film->counters.add(other.counters);
}

}  // namespace gradus::film
