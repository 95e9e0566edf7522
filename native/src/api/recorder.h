// Keeps the last value of each scene call as bytes, so that a scene can be saved.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "gradus/gradus.h"

namespace gradus::scene {
class Scene;
}  // namespace gradus::scene

namespace gradus::api {

// Kinds of records, in the order in which a file holds and a reader sets them.
enum class RecordKind : uint32_t {
  Settings = 1,
  Image = 2,
  Material = 3,
  Mesh = 4,
  Instances = 5,
  Lights = 6,
  Camera = 7,
  World = 8,
  End = 9
};

class SceneRecorder {
 public:
  // Structs must be complete and checked (scene_args.h). Image files are packed: the record holds their bytes.
  void set_mesh(uint64_t key, const GradusMesh& mesh);
  void set_image(uint64_t key, const GradusImage& image);
  void set_material(uint64_t key, const GradusMaterial& material);
  void set_instances(const GradusInstances& instances);
  void set_lights(const std::vector<GradusLight>& lights);
  void set_camera(const GradusCamera& camera);
  void set_world(const GradusWorld& world);
  void remove(GradusObjectKind kind, uint64_t key);
  // Throws Error with path and reason.
  void save(const std::string& path, const GradusSettings& settings) const;

 private:
  template <class T>
  void keep(RecordKind kind, uint64_t key, T value);
  std::map<std::pair<RecordKind, uint64_t>, std::vector<char>> records_;
};

// Sets everything that the file holds; returns its settings. Throws invalid_argument with path and reason for a file
// that is missing, damaged or of another version.
GradusSettings load_scene(const std::string& path, scene::Scene* scene);

// What a scene file holds, without building it.
struct SceneSummary {
  GradusSettings settings{};
  size_t meshes = 0, vertices = 0, triangles = 0, instances = 0, lights = 0, materials = 0, nodes = 0, images = 0;
  uint64_t image_bytes = 0, file_bytes = 0;
  bool has_camera = false;
};
SceneSummary summarize_scene(const std::string& path);

}  // namespace gradus::api
