#include "frame/store_planes.h"

#include "settings/pass_table.h"

namespace gradus {
namespace {

constexpr const char* kHalfNames[kHalves] = {"A", "B"};
constexpr const char* kOffsetNames[kOffsets] = {"right", "up", "left", "down"};
constexpr const char* kColorNames[4] = {"R", "G", "B", "A"};
constexpr const char* kVectorNames[4] = {"X", "Y", "Z", "W"};

class PlaneList {
 public:
  explicit PlaneList(int channels) : channels_(channels) {}

  void radiance(const std::string& name, std::vector<Radiance>* plane) {
    if (plane->empty()) return;
    for (int c = 0; c < channels_; ++c) add(name + "." + kColorNames[c], false, &(*plane)[0][c], sizeof(Radiance));
  }
  void floats(const std::string& name, std::vector<float>* plane, size_t width = 1, size_t offset = 0) {
    if (!plane->empty()) add(name, false, plane->data() + offset, width * sizeof(float));
  }
  void counts(const std::string& name, std::vector<uint32_t>* plane) { add(name, true, plane->data(), sizeof(uint32_t)); }

  std::vector<StoredPlane> planes;

 private:
  template <class T>
  void add(const std::string& name, bool integer, T* data, size_t stride) {
    planes.push_back({name, integer, reinterpret_cast<unsigned char*>(data), stride});
  }
  int channels_;
};

std::string pass_channel(uint32_t pass) {
  std::string name = pass_info(pass).name;
  for (char& c : name) c = c == ' ' ? '_' : c;
  return "pass." + name;
}

}  // namespace

std::vector<StoredPlane> stored_planes(Frame* frame) {
  PlaneList list(frame->channels);
  for (int half = 0; half < kHalves; ++half) {
    const std::string h = kHalfNames[half];
    for (size_t c = 0; c < frame->components.size(); ++c) {
      const std::string name = "component" + std::to_string(c) + "." + h;
      list.radiance(name + ".primal", &frame->components[c].primal[half]);
      for (int o = 0; o < kOffsets; ++o) list.radiance(name + "." + kOffsetNames[o], &frame->components[c].gradient[half][o]);
    }
    list.counts("count." + h, &frame->count[half]);
    for (int o = 0; o < kOffsets; ++o) list.floats("pairs." + h + "." + kOffsetNames[o], &frame->pair_count[half][o]);
  }
  for (PassPlane& plane : frame->passes) {
    for (int half = 0; half < (plane.in_halves ? kHalves : 1); ++half) {
      const std::string name = pass_channel(plane.pass) + (plane.in_halves ? std::string(".") + kHalfNames[half] : "");
      for (uint32_t c = 0; c < plane.channels; ++c) {
        list.floats(name + "." + kVectorNames[c], &plane.values[half], plane.channels, c);
      }
    }
    list.floats(pass_channel(plane.pass) + ".weight", &plane.weight);
  }
  list.floats("fallback", &frame->fallback);
  return list.planes;
}

}  // namespace gradus
