/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * Gradus: the C API as C++ objects that release themselves and throw. Header only; adds nothing to gradus.h, which
 * documents what the calls do.
 */
#ifndef GRADUS_HPP
#define GRADUS_HPP

#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "gradus/gradus.h"

namespace gradus::client {

class Error : public std::runtime_error {
 public:
  Error(GradusError code, const std::string& text) : std::runtime_error(text), code_(code) {}
  GradusError code() const { return code_; }

 private:
  GradusError code_;
};

// Throws the error of the thread's error slot if `code` is not GRADUS_OK.
inline void check(GradusError code) {
  if (code == GRADUS_OK) return;
  const char* text = "";
  gradus_error(&text);
  throw Error(code, text);
}

// Returns a struct of the API whose struct_size is set and whose other members are 0.
template <class T>
T make() {
  T value{};
  value.struct_size = sizeof(T);
  return value;
}

// Owns a handle and releases it. Handles can be moved, but not copied.
template <class Id, GradusError (*Release)(Id)>
class Handle {
 public:
  Handle() = default;
  explicit Handle(Id id) : id_(id) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  ~Handle() {
    if (id_ != 0) Release(id_);
  }
  Id id() const { return id_; }

 protected:
  Id id_ = 0;
};

class Device : public Handle<GradusDevice, gradus_device_release> {
 public:
  explicit Device(uint32_t threads = 0, const char* color_config = nullptr, const char* denoiser_path = nullptr) {
    auto settings = make<GradusDeviceSettings>();
    settings.threads = threads;
    settings.color_config = color_config;
    settings.denoiser_path = denoiser_path;
    check(gradus_device_create(&settings, &id_));
  }
  // Removes and returns the oldest warning, or "" if there is none.
  std::string warning() const {
    const char* text = nullptr;
    check(gradus_device_warning(id_, &text));
    return text ? text : "";
  }
};

inline GradusSettings default_settings() {
  auto settings = make<GradusSettings>();
  check(gradus_settings_default(&settings));
  return settings;
}

class Scene : public Handle<GradusScene, gradus_scene_release> {
 public:
  explicit Scene(const Device& device) { check(gradus_scene_create(device.id(), &id_)); }
  static Scene load(const Device& device, const std::string& path, GradusSettings* settings) {
    GradusScene id = 0;
    check(gradus_scene_load(device.id(), path.c_str(), &id, settings));
    return Scene(id);
  }
  void set_mesh(uint64_t key, const GradusMesh& mesh) { check(gradus_scene_set_mesh(id_, key, &mesh)); }
  void set_image(uint64_t key, const GradusImage& image) { check(gradus_scene_set_image(id_, key, &image)); }
  void set_material(uint64_t key, const GradusMaterial& material) {
    check(gradus_scene_set_material(id_, key, &material));
  }
  void set_instances(const GradusInstances& instances) { check(gradus_scene_set_instances(id_, &instances)); }
  void set_lights(const std::vector<GradusLight>& lights) {
    check(gradus_scene_set_lights(id_, lights.data(), lights.size()));
  }
  void set_camera(const GradusCamera& camera) { check(gradus_scene_set_camera(id_, &camera)); }
  void set_dicing_camera(const GradusCamera* camera) { check(gradus_scene_set_dicing_camera(id_, camera)); }
  void set_world(const GradusWorld& world) { check(gradus_scene_set_world(id_, &world)); }
  void remove(GradusObjectKind kind, uint64_t key) { check(gradus_scene_remove(id_, kind, key)); }
  void commit() { check(gradus_scene_commit(id_, nullptr, nullptr)); }
  // Removes and returns the oldest warning, or "" if there is none.
  std::string warning() const {
    const char* text = nullptr;
    check(gradus_scene_warning(id_, &text));
    return text ? text : "";
  }
  void record(bool enabled) { check(gradus_scene_record(id_, enabled ? 1 : 0)); }
  void save(const GradusSettings& settings, const std::string& path) const {
    check(gradus_scene_save(id_, &settings, path.c_str()));
  }

 private:
  explicit Scene(GradusScene id) : Handle(id) {}
};

inline uint32_t pass_channels(uint32_t pass) {
  uint32_t channels = 0;
  check(gradus_pass_info(pass, nullptr, &channels));
  return channels;
}

inline std::string pass_name(uint32_t pass) {
  const char* name = "";
  check(gradus_pass_info(pass, &name, nullptr));
  return name;
}

class Film : public Handle<GradusFilm, gradus_film_release> {
 public:
  using Handle::Handle;
  static Film load(const Device& device, const std::string& path) {
    GradusFilm id = 0;
    check(gradus_film_load(device.id(), path.c_str(), &id));
    return Film(id);
  }
  void save(const std::string& path) const { check(gradus_film_save(id_, path.c_str())); }
  void merge(const Film& other) { check(gradus_film_merge(id_, other.id())); }
  std::pair<uint32_t, uint32_t> size() const {
    uint32_t width = 0, height = 0;
    check(gradus_film_size(id_, &width, &height));
    return {width, height};
  }
  // Returns the reconstructed picture. If `error` is given, it receives the Error pass.
  std::vector<float> reconstruct(uint32_t reconstruction, float alpha, uint32_t denoiser = GRADUS_DENOISER_NONE,
                                 std::vector<float>* error = nullptr) const {
    std::vector<float> rgba(pixels() * 4);
    if (error != nullptr) error->resize(pixels());
    float* wanted = error != nullptr ? error->data() : nullptr;
    check(gradus_film_reconstruct(id_, reconstruction, alpha, denoiser, rgba.data(), rgba.size(), wanted));
    return rgba;
  }
  std::vector<float> read_pass(uint32_t pass) const {
    std::vector<float> values(pixels() * pass_channels(pass));
    check(gradus_film_read_pass(id_, pass, values.data(), values.size()));
    return values;
  }
  // Reads a layer of a channel of GradusChannelKind `kind`, which has so many values for each pixel.
  std::vector<float> read_channel(uint32_t kind, const std::string& name, uint32_t layer, uint32_t values) const {
    std::vector<float> pixels_of(pixels() * values);
    check(gradus_film_read_channel(id_, kind, name.c_str(), layer, pixels_of.data(), pixels_of.size()));
    return pixels_of;
  }

 private:
  size_t pixels() const {
    const auto [width, height] = size();
    return size_t(width) * height;
  }
};

class Render : public Handle<GradusRender, gradus_render_release> {
 public:
  Render(const Scene& scene, const GradusSettings& settings) {
    check(gradus_render_start(scene.id(), &settings, &id_));
  }
  Render(const Scene& scene, const GradusSettings& settings, const Film& resumed) {
    check(gradus_render_resume(scene.id(), &settings, resumed.id(), &id_));
  }
  GradusProgress poll() const {
    auto progress = make<GradusProgress>();
    check(gradus_render_poll(id_, &progress));
    return progress;
  }
  // Reads a pass of the finished render.
  std::vector<float> read_pass(uint32_t pass, size_t pixels) const {
    std::vector<float> values(pixels * pass_channels(pass));
    check(gradus_render_read_pass(id_, pass, values.data(), values.size()));
    return values;
  }
  void cancel() { check(gradus_render_cancel(id_)); }
  void wait() const { check(gradus_render_wait(id_, -1.0)); }
  // Waits for the end of the render. Returns false if it is still running after this time.
  bool wait(double seconds) const {
    const GradusError code = gradus_render_wait(id_, seconds);
    if (code == GRADUS_TIMEOUT) return false;
    check(code);
    return true;
  }
  std::string stats() const {
    const char* json = nullptr;
    check(gradus_render_stats(id_, &json));
    return json;
  }
  Film film() const {
    GradusFilm id = 0;
    check(gradus_render_film(id_, &id));
    return Film(id);
  }

 private:
  friend class Sequence;
  explicit Render(GradusRender id) : Handle(id) {}
};

class Sequence : public Handle<GradusSequence, gradus_sequence_release> {
 public:
  Sequence(const Device& device, const GradusSequenceSettings& settings) {
    check(gradus_sequence_create(device.id(), &settings, &id_));
  }
  Render deliver(int32_t frame, const GradusSettings& settings) const {
    GradusRender render = 0;
    check(gradus_sequence_deliver(id_, frame, &settings, &render));
    return Render(render);
  }
};

}  // namespace gradus::client

#endif
