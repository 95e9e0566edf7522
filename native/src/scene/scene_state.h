// The data that a Scene stores between calls; private to scene/.
#pragma once

#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
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
#include "scene/dice_instances.h"
#include "scene/displace_instances.h"
#include "scene/material_source.h"
#include "scene/scene.h"

namespace gradus::shading {
struct MaterialData;
}  // namespace gradus::shading

namespace gradus::scene {

// A light as the caller has set it. The pointers of `desc` are null, and copies hold what they led to.
struct LightSource {
  GradusLight desc{};
  std::string name;
  std::vector<Vec4> attributes;
};

struct LoadedImage {
  image::ImageSource source;
  std::shared_ptr<const image::Image> image;  // nullptr if the next commit has to load it
};

// Maps the keys of images to their pixels.
using StoredImages = std::map<uint64_t, std::shared_ptr<const image::Image>>;

// Maps images to copies that have lower resolutions, too.
using CoarserImages = std::map<std::shared_ptr<const image::Image>, std::shared_ptr<const image::Image>>;

struct CompiledMaterial {
  std::shared_ptr<const MaterialSource> source;
  std::shared_ptr<const shading::MaterialData> data;
  std::string warning;  // reason for a fallback in `data`, or how its emission was limited; else empty
};

// Maps the keys of materials to indices in Snapshot::materials.
using MaterialIndex = std::unordered_map<uint64_t, uint32_t>;

struct Scene::State {
  mutable std::mutex mutex;
  std::unordered_map<uint64_t, std::shared_ptr<const geometry::MeshData>> meshes;
  std::map<uint64_t, LoadedImage> images;
  std::map<uint64_t, std::shared_ptr<const MaterialSource>> materials;
  geometry::InstanceArrays instances;
  std::vector<LightSource> lights;
  GradusCamera camera{};  // its arrays belong to `camera_keys`
  camera::CameraKeys camera_keys;
  bool has_camera = false;
  std::optional<GradusCamera> dicing_camera;  // its arrays are not used
  GradusWorld world{};
  bool has_world = false;
  SceneChannels channels;

  // Results of the last commit that the next commit may reuse.
  std::shared_ptr<const Snapshot> current;
  std::shared_ptr<const image::ImageStore> image_store;
  StoredImages stored_images;  // those in `image_store`
  CoarserImages coarser_images;
  std::map<uint64_t, CompiledMaterial> compiled;
  std::vector<DicedMesh> diced;
  std::vector<DisplacedMesh> displaced;
  std::shared_ptr<const geometry::Accelerator> accelerator;
  light::WorldMap world_map;
};

// The objects that have the same problem, for one warning with the name of the first.
struct AffectedObjects {
  size_t count = 0;
  std::string first;

  void add(const std::string& name) {
    if (count++ == 0) first = name;
  }
  // Appends the warning, if there are objects. `what` is the predicate for one object, `of_several` that for more, and
  // `why` is the reason.
  void warn(const std::string& what, const std::string& of_several, const std::string& why,
            std::vector<std::string>* warnings) const {
    if (count == 0) return;
    warnings->push_back(count == 1 ? "object '" + first + "' " + what + ": " + why
                                   : std::to_string(count) + " objects " + of_several + ", the first is '" + first +
                                         "': " + why);
  }
};

// Returns whether the matrix of an instance is finite and has a volume, so that it has an inverse.
bool is_usable(const Mat4& matrix);
// Returns the exact matrix of an instance in internal space.
glm::dmat4 internal_matrix(const Mat4& matrix, const Vec3& origin);

// Sets the instances, without materials, the origin, the radius and warnings of a snapshot. Returns the index in
// InstanceArrays of each instance.
std::vector<size_t> place_instances(const Scene::State& state, Snapshot* snapshot);
// Sets the radius of a snapshot from the bounds of its instances.
void set_radius(Snapshot* snapshot);

// Loads new images and sets the images and warnings of a snapshot.
void load_images(Device& device, const CommitMonitor& monitor, Scene::State* state, Snapshot* snapshot);
// Sets the materials of a snapshot, the default material first, and warnings. load_images() must have been called.
MaterialIndex compile_materials(const CommitMonitor& monitor, Scene::State* state, Snapshot* snapshot);
// Gives lower resolutions to the images of a snapshot of which its materials average texels.
void add_coarser_images(const CommitMonitor& monitor, Scene::State* state, Snapshot* snapshot);
// Returns a hash of everything that the caller set.
uint64_t content_key(const Scene::State& state);

}  // namespace gradus::scene
