// The editable scene of the C API. It stores the caller's data and makes snapshots of them.
#pragma once

#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "base/types.h"
#include "gradus/gradus.h"
#include "scene/snapshot.h"

namespace gradus::scene {

class Device;  // scene/device.h: Embree device, thread arena, colour, warnings

class Scene {
 public:
  explicit Scene(std::shared_ptr<Device> device);
  ~Scene();
  // Copies the arrays of a mesh. Throws Error INVALID_ARGUMENT, with the name of the mesh, if the arrays contradict
  // each other. Values that are not finite and triangles without area are allowed here. The commit leaves them out,
  // with one warning, so that damaged data does not prevent the render.
  void set_mesh(uint64_t key, const GradusMesh& mesh);
  void set_image(uint64_t key, const GradusImage& image);
  void set_material(uint64_t key, const GradusMaterial& material);
  void set_instances(const GradusInstances& instances);
  void set_lights(const GradusLight* lights, size_t count);
  void set_camera(const GradusCamera& camera);
  // Sets the camera in whose picture meshes are diced; nullptr: the one that renders.
  void set_dicing_camera(const GradusCamera* camera);
  void set_world(const GradusWorld& world);
  void set_channels(const GradusChannel* channels, size_t count);
  void remove(GradusObjectKind kind, uint64_t key);
  // Makes a new snapshot. *progress rises from 0 to 1. Throws Error CANCELLED if *cancel becomes non-zero; the previous
  // snapshot then remains.
  void commit(const volatile int32_t* cancel, float* progress);
  // Returns the names of all objects, materials or assets and their hashes as a JSON object, for the Cryptomatte
  // `kind`.
  std::string manifest(uint32_t kind) const;
  // Returns the snapshot of the last commit, or nullptr if there was none.
  std::shared_ptr<const Snapshot> snapshot() const;
  const std::shared_ptr<Device>& device() const { return device_; }

  struct State;  // scene/scene_state.h

 private:
  std::unique_ptr<State> state_;
  std::shared_ptr<Device> device_;
};

}  // namespace gradus::scene
