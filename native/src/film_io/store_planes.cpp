#include "film_io/store_planes.h"

#include "schema/pass_table.h"

namespace gradus::film_io {
namespace {

constexpr const char* kHalfNames[film::kHalves] = {"A", "B"};
constexpr const char* kOffsetNames[film::kOffsets] = {"right", "up", "left", "down"};
constexpr const char* kColorNames[4] = {"R", "G", "B", "A"};
constexpr const char* kVectorNames[4] = {"X", "Y", "Z", "W"};

// Planes that the frame has not are left out.
class PlaneList {
 public:
  void radiance(const std::string& layer, int channels, std::vector<Radiance>* plane) {
    if (plane->empty()) return;
    for (int c = 0; c < channels; ++c) add(layer + "." + kColorNames[c], false, &(*plane)[0][c], sizeof(Radiance));
  }
  void vectors(const std::string& layer, uint32_t width, std::vector<float>* plane) {
    if (plane->empty()) return;
    for (uint32_t c = 0; c < width; ++c) {
      add(layer + "." + (width == 1 ? "V" : kVectorNames[c]), false, plane->data() + c, width * sizeof(float));
    }
  }
  void non_specular(const std::string& layer, std::vector<film::NonSpecularVertices>* plane) {
    if (plane->empty()) return;
    for (int c = 0; c < 3; ++c)
      add(layer + ".reflectance." + kColorNames[c], false, &(*plane)[0].reflectance[c],
          sizeof(film::NonSpecularVertices));
    for (int c = 0; c < 3; ++c)
      add(layer + ".normal." + kVectorNames[c], false, &(*plane)[0].normal[c], sizeof(film::NonSpecularVertices));
    add(layer + ".inverse_depth.V", false, &(*plane)[0].inverse_depth, sizeof(film::NonSpecularVertices));
    add(layer + ".samples.V", false, &(*plane)[0].samples, sizeof(film::NonSpecularVertices));
  }
  void details(const std::string& layer, std::vector<film::NonSpecularDetails>* plane) {
    if (plane->empty()) return;
    film::NonSpecularDetails& first = plane->front();
    for (int c = 0; c < 3; ++c)
      add(layer + ".uv." + kVectorNames[c], false, &first.uv[c], sizeof(film::NonSpecularDetails));
    for (int c = 0; c < 3; ++c)
      add(layer + ".emission." + kColorNames[c], false, &first.emission[c], sizeof(film::NonSpecularDetails));
    add(layer + ".segments.V", false, &first.segments, sizeof(film::NonSpecularDetails));
    add(layer + ".object.V", false, &first.object, sizeof(film::NonSpecularDetails));
    add(layer + ".face.V", false, &first.face, sizeof(film::NonSpecularDetails));
    add(layer + ".sample.V", true, &first.sample, sizeof(film::NonSpecularDetails));
  }
  void vectors(const std::string& layer, std::vector<Vec4>* plane) {
    if (plane->empty()) return;
    for (int c = 0; c < 4; ++c) add(layer + "." + kVectorNames[c], false, &(*plane)[0][c], sizeof(Vec4));
  }
  void shown(const std::string& layer, std::vector<film::ShownPoint>* plane) {
    if (plane->empty()) return;
    add(layer + ".object.V", false, &(*plane)[0].object, sizeof(film::ShownPoint));
    add(layer + ".depth.V", false, &(*plane)[0].depth, sizeof(film::ShownPoint));
  }
  void correspondence(const std::string& layer, film::PixelCorrespondence* correspondence) {
    if (!correspondence->pixel.empty()) add(layer + ".V", true, correspondence->pixel.data(), sizeof(int32_t));
    if (correspondence->off_centre.empty()) return;
    for (int c = 0; c < 2; ++c)
      add(layer + ".off_centre." + kVectorNames[c], false, &correspondence->off_centre[0][c], sizeof(Vec2));
  }
  void counts(const std::string& layer, std::vector<uint32_t>* plane) {
    add(layer + ".V", true, plane->data(), sizeof(uint32_t));
  }

  std::vector<StoredPlane> take() { return std::move(planes_); }

 private:
  template <class T>
  void add(const std::string& name, bool integer, T* data, size_t stride) {
    planes_.push_back({name, integer, reinterpret_cast<unsigned char*>(data), stride});
  }
  std::vector<StoredPlane> planes_;
};

std::string layer_of(size_t component) { return "component" + std::to_string(component); }

std::string layer_of(size_t component, int half) {
  return (component == 0 ? "" : layer_of(component) + ".") + kHalfNames[half];
}

std::string part_of(const std::string& name, size_t component) {
  return component == 0 ? name : name + "." + layer_of(component);
}

std::string layer_of(const film::Channel& plane) {
  std::string name = schema::pass_info(plane.pass).name;
  for (char& c : name) c = c == ' ' ? '_' : c;
  return name;
}

std::vector<StoredPlane> samples(film::Film* film, size_t component) {
  PlaneList list;
  for (int half = 0; half < film::kHalves; ++half) {
    list.radiance(layer_of(component, half), film->color_channels, &film->components[component].primal[half]);
  }
  film::ReplayMap& replayed = film->replayed;
  if (replayed.has_component_map(int(component)))
    list.correspondence(layer_of(component) + ".source", &replayed.of_component[component]);
  return list.take();
}

std::vector<StoredPlane> counts(film::Film* film) {
  PlaneList list;
  for (int half = 0; half < film::kHalves; ++half)
    list.counts(std::string(kHalfNames[half]) + ".count", &film->count[half]);
  list.correspondence("source", &film->replayed.correspondence);
  return list.take();
}

std::string layer_of(int half, int offset) { return std::string(kHalfNames[half]) + "." + kOffsetNames[offset]; }

std::vector<StoredPlane> gradients(film::Film* film, size_t component) {
  PlaneList list;
  for (int half = 0; half < film::kHalves; ++half) {
    for (int o = 0; o < film::kOffsets; ++o) {
      list.radiance(layer_of(component, half) + "." + kOffsetNames[o], film->color_channels,
                    &film->components[component].gradient[half][o]);
    }
  }
  return list.take();
}

std::vector<StoredPlane> pairs(film::Film* film) {
  PlaneList list;
  for (int half = 0; half < film::kHalves; ++half) {
    for (int o = 0; o < film::kOffsets; ++o) list.vectors(layer_of(half, o) + ".pairs", 1, &film->pair_count[half][o]);
  }
  return list.take();
}

std::vector<StoredPlane> feature(film::Channel* plane) {
  PlaneList list;
  for (int half = 0; half < film::kHalves; ++half) {
    list.vectors(std::string(kHalfNames[half]) + "." + layer_of(*plane), plane->info.values_per_pixel, &plane->values[half]);
  }
  return list.take();
}

std::vector<StoredPlane> non_specular(film::Film* film, size_t component) {
  PlaneList list;
  for (int half = 0; half < film::kHalves; ++half)
    list.non_specular(layer_of(component, half), &film->components[component].non_specular[half]);
  return list.take();
}

std::vector<StoredPlane> details(film::Film* film, size_t component) {
  PlaneList list;
  list.details(layer_of(component), &film->components[component].details);
  return list.take();
}

std::vector<StoredPlane> motion(film::Film* film, size_t component) {
  PlaneList list;
  film::ComponentPlanes& planes = film->components[component];
  const std::string layer = layer_of(component);
  list.vectors(layer + ".motion", &planes.motion);
  list.vectors(layer + ".tracked", 1, &planes.tracked);
  list.shown(layer + ".shown", &planes.shown);
  return list.take();
}

std::vector<StoredPlane> passes(film::Film* film) {
  PlaneList list;
  for (film::Channel& plane : film->channels) {
    if (plane.info.in_halves) continue;
    list.vectors(layer_of(plane), plane.info.values_per_pixel, &plane.values[0]);
    list.vectors(layer_of(plane) + ".weight", 1, &plane.weight);
  }
  list.vectors("Fallback", 1, &film->fallback);
  return list.take();
}

}  // namespace

std::vector<StoredPart> stored_parts(film::Film* film) {
  std::vector<StoredPart> parts;
  const size_t components = film->components.size();
  for (size_t c = 0; c < components; ++c) parts.push_back({part_of("samples", c), samples(film, c)});
  parts.push_back({"counts", counts(film)});
  for (size_t c = 0; c < components; ++c) parts.push_back({part_of("gradients", c), gradients(film, c)});
  parts.push_back({"pairs", pairs(film)});
  for (size_t c = 0; c < components; ++c) parts.push_back({part_of("rough", c), non_specular(film, c)});
  for (size_t c = 0; c < components; ++c) parts.push_back({part_of("details", c), details(film, c)});
  for (size_t c = 0; c < components; ++c) parts.push_back({part_of("motion", c), motion(film, c)});
  for (film::Channel& plane : film->channels) {
    if (plane.info.in_halves) parts.push_back({layer_of(plane), feature(&plane)});
  }
  parts.push_back({"passes", passes(film)});
  std::erase_if(parts, [](const StoredPart& part) { return part.planes.empty(); });
  return parts;
}

}  // namespace gradus::film_io
