// The data that a Scene stores between calls; private to scene/.
#pragma once

#include <functional>
#include <map>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "base/commit_monitor.h"
#include "base/hash.h"
#include "camera/camera_keys.h"
#include "geometry/accelerator.h"
#include "geometry/instance_arrays.h"
#include "geometry/mesh.h"
#include "image/image_store.h"
#include "light/world_map.h"
#include "scene/material_source.h"
#include "scene/scene.h"

namespace gradus::shading {
struct MaterialData;
}  // namespace gradus::shading

namespace gradus::scene {

// A light as set; the pointers of `desc` are null.
struct LightSource {
  GradusLight desc{};
  std::string name;
};

struct LoadedImage {
  image::ImageSource source;
  std::shared_ptr<const image::Image> image;  // nullptr: the next commit loads it
};

// Image key -> pixels.
using StoredImages = std::map<uint64_t, std::shared_ptr<const image::Image>>;

struct CompiledMaterial {
  std::shared_ptr<const MaterialSource> source;
  std::shared_ptr<const shading::MaterialData> data;
  std::string warning;  // reason for a fallback in `data`; else empty
};

// Material key -> index in Snapshot::materials.
using MaterialIndex = std::unordered_map<uint64_t, uint32_t>;

struct Scene::State {
  mutable std::mutex mutex;
  std::unordered_map<uint64_t, std::shared_ptr<const geometry::MeshData>> meshes;
  std::map<uint64_t, LoadedImage> images;
  std::map<uint64_t, std::shared_ptr<const MaterialSource>> materials;
  geometry::InstanceArrays instances;
  std::vector<LightSource> lights;
  GradusCamera camera{};  // its arrays are camera_keys'
  camera::CameraKeys camera_keys;
  bool has_camera = false;
  GradusWorld world{};
  bool has_world = false;

  // Results of the last commit that the next commit may reuse.
  std::shared_ptr<const Snapshot> current;
  std::shared_ptr<const image::ImageStore> image_store;
  StoredImages stored_images;  // in image_store
  std::map<uint64_t, CompiledMaterial> compiled;
  std::shared_ptr<const geometry::Accelerator> accelerator;
  light::WorldMap world_map;
};

// Exact matrix of an instance in internal space.
glm::dmat4 internal_matrix(const Mat4& matrix, const Vec3& origin);

// Fills instances (without materials), origin, radius and warnings; returns the index in InstanceArrays of each.
std::vector<size_t> place_instances(const Scene::State& state, Snapshot* snapshot);

// Fills images and warnings.
void load_images(Device& device, const CommitMonitor& monitor, Scene::State* state, Snapshot* snapshot);
// Fills materials, the default one first, and warnings. Needs load_images().
MaterialIndex compile_materials(const CommitMonitor& monitor, Scene::State* state, Snapshot* snapshot);
// Returns a hash of everything that the caller set.
uint64_t content_key(const Scene::State& state);

}  // namespace gradus::scene
