// One list of all planes of a film: of its components, counts, channels and replay map. The store, merging and the
// memory account walk this list, so that a new plane or channel is stored, merged and counted without a change there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "film/film.h"

namespace gradus::film {

// What happens to a plane when the samples of another film are added.
enum class MergeRule {
  kAdd,          // The sums are added.
  kFirstSample,  // The plane comes from the film that has the first sample.
  kKeep,         // The plane does not change: it does not consist of sums.
};

// One of the 32-bit numbers that a plane has for each pixel.
struct PlaneField {
  std::string name;
  size_t offset = 0;  // in bytes from the begin of the pixel's values
  bool is_integer = false;
};

// A plane of a film: a vector of values, row-major over the film's region.
struct Plane {
  using Values = std::variant<std::vector<float>*, std::vector<uint32_t>*, std::vector<int32_t>*, std::vector<Vec2>*,
                              std::vector<Vec4>*, std::vector<NonSpecularVertices>*, std::vector<NonSpecularDetails>*,
                              std::vector<ShownPoint>*>;
  std::string part;   // Planes of one part are stored together. One part can be read without the others.
  std::string layer;  // name of the plane; no other plane has it
  MergeRule merge = MergeRule::kAdd;
  std::vector<PlaneField> fields;
  size_t pixel_bytes = 0;  // distance between the values of neighbouring pixels
  Values values;
  const Channel* pairs = nullptr;  // channel with pairs of identifier and weight; nullptr if the plane holds none
  // Counter of the values that the finite check drops when films are merged.
  uint64_t Counters::*dropped = &Counters::nonfinite_feature;

  unsigned char* data() const;
  size_t bytes() const;
};

// The names of planes and parts: those of today, or those of stored films of the formats up to 11, which have "rough"
// in place of "non_specular" and "source" in place of "correspondence".
enum class PlaneNames { kCurrent, kOlder };

// Returns the planes that the film has, in the order of the stored file. They point into the film, which must not gain
// or lose planes meanwhile. Names of channels are always those of the film.
std::vector<Plane> planes_of(Film* film, PlaneNames names = PlaneNames::kCurrent);
// As above, for callers that only read: they must not write to the planes.
std::vector<Plane> planes_of(const Film& film);

// Returns the bytes per pixel of all planes of a film with this content. Film::memory_bytes() counts the same.
uint64_t film_bytes_per_pixel(int components, bool gradients, const std::vector<ChannelInfo>& channels,
                              const ComponentContent& content = {});

// Returns whether the films have the same full size, region, components and channels, so that add_sums() can add them.
bool can_add(const Film& film, const Film& other);
// Adds the sums and counts of `other`. Channels that keep the first sample come from the film with the lower first
// sample number, which is this one if the numbers are equal. A value of `other` with which a sum would be too large is
// dropped and counted (film/finite_check.h). Pixels are added in parallel; the result does not depend on threads.
void add_sums(Film* film, const Film& other);

}  // namespace gradus::film
