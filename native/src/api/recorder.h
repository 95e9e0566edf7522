// Recording of scene calls. The last value of each call is stored as bytes, so that a scene can be saved.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "gradus/gradus.h"

namespace gradus::image {
class ColorManager;
}  // namespace gradus::image

namespace gradus::scene {
class Scene;
}  // namespace gradus::scene

namespace gradus::api {

// Kinds of records, in the order of a file but for the last one, End. A reader sets them in this order, too.
enum class RecordKind : uint32_t {
  Settings = 1,
  Image = 2,
  Material = 3,
  Mesh = 4,
  Instances = 5,
  Lights = 6,
  Camera = 7,
  World = 8,
  End = 9,
  Channels = 10,
  DicingCamera = 11
};

class SceneRecorder {
 public:
  // Record a call. Structs must be complete and checked, as the functions of scene_args.h return them. The record of an
  // image holds the bytes of its files, or scene-linear pixels if only `color` can convert its colour space.
  void set_mesh(uint64_t key, const GradusMesh& mesh);
  void set_image(uint64_t key, const GradusImage& image, const image::ColorManager& color);
  void set_material(uint64_t key, const GradusMaterial& material);
  void set_instances(const GradusInstances& instances);
  void set_lights(const std::vector<GradusLight>& lights);
  void set_camera(const GradusCamera& camera);
  void set_dicing_camera(const GradusCamera& camera);
  void remove_dicing_camera();
  void set_world(const GradusWorld& world);
  void set_channels(const std::vector<GradusChannel>& channels);
  void remove(GradusObjectKind kind, uint64_t key);
  // Writes the scene file. Throws Error with path and reason.
  void save(const std::string& path, const GradusSettings& settings) const;

 private:
  template <class T>
  void store(RecordKind kind, uint64_t key, T value);
  std::map<std::pair<RecordKind, uint64_t>, std::vector<char>> records_;
};

// Sets all objects of a file in `scene`, and returns its settings. Throws invalid_argument, with path and reason, for a
// file that is missing, damaged or of another version.
GradusSettings load_scene(const std::string& path, scene::Scene* scene);

// The contents of a scene file in numbers. summarize_scene() reads them without building a scene, and throws as
// load_scene() does.
struct SceneSummary {
  GradusSettings settings{};
  size_t meshes = 0, vertices = 0, triangles = 0, instances = 0, lights = 0, materials = 0, nodes = 0, images = 0;
  uint64_t image_bytes = 0, file_bytes = 0;
  bool has_camera = false;
};
SceneSummary summarize_scene(const std::string& path);

}  // namespace gradus::api
