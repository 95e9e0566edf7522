// Small scenes for tests, built through gradus::Scene like the C API does.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "gradus/gradus_nodes.h"
#include "scene/device.h"
#include "scene/scene.h"
#include "scene/snapshot.h"

namespace gradus::test {

inline std::shared_ptr<scene::Device> test_device() {
  static const auto device = [] {
    GradusDeviceSettings settings{};
    settings.struct_size = sizeof(settings);
    settings.threads = 2;
    return std::make_shared<scene::Device>(settings);
  }();
  return device;
}

// Triangles: 3 position values per vertex, 3 vertex indices per triangle.
struct Soup {
  std::string name = "mesh";
  std::vector<Vec3> positions;
  std::vector<int32_t> vertices;  // by corner; triangle i has the corners 3i to 3i+2

  void triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
    for (const Vec3& p : {a, b, c}) {
      vertices.push_back(int32_t(positions.size()));
      positions.push_back(p);
    }
  }
};

// Keeps the arrays of a GradusMesh alive.
class MeshDesc {
 public:
  explicit MeshDesc(Soup soup) : soup_(std::move(soup)) {
    corners_.resize(soup_.vertices.size());
    for (uint32_t i = 0; i < corners_.size(); ++i) corners_[i] = i;
    desc.struct_size = sizeof(desc);
    desc.key_count = 1;
    desc.vertex_count = soup_.positions.size();
    desc.positions = soup_.positions.empty() ? nullptr : &soup_.positions[0].x;
    desc.corner_count = soup_.vertices.size();
    desc.corner_vertices = soup_.vertices.data();
    desc.triangle_count = soup_.vertices.size() / 3;
    desc.triangle_corners = corners_.data();
    desc.normal_domain = GRADUS_DOMAIN_FACE;
    for (float& s : desc.generated_size) s = 1.0f;
    desc.name = soup_.name.c_str();
  }
  MeshDesc(const MeshDesc&) = delete;
  GradusMesh desc{};

 private:
  Soup soup_;
  std::vector<uint32_t> corners_;
};

inline Mat4 translation(const Vec3& t) {
  Mat4 m(1.0f);
  m[3] = Vec4(t, 1.0f);
  return m;
}

inline Mat4 scaling(const Vec3& s) {
  Mat4 m(1.0f);
  for (int i = 0; i < 3; ++i) m[i][i] = s[i];
  return m;
}

// Returns a material with a program that refers to the arguments.
inline GradusMaterial material_of(const std::vector<GradusNode>& nodes, const std::vector<GradusInput>& inputs,
                                  int32_t surface, const char* name) {
  GradusMaterial d{};
  d.struct_size = sizeof(d);
  d.node_count = uint32_t(nodes.size());
  d.nodes = nodes.data();
  d.inputs = inputs.data();
  d.input_count = inputs.size();
  d.surface = surface;
  d.sample_as_light = 1;
  d.transparent_shadow = 1;
  d.name = name;
  return d;
}

// A program of at most two nodes: a value and a closure.
class MaterialDesc {
 public:
  MaterialDesc(uint32_t closure, const Rgb& color, float strength = 1.0f) {
    nodes_.push_back({closure, 0, 0, closure == GRADUS_OP_EMISSION || closure == GRADUS_OP_DIFFUSE ? 2u : 1u, 0, 0, 0});
    inputs_.push_back({-1, 0, {color.x, color.y, color.z, 1.0f}});
    inputs_.push_back({-1, 0, {strength, strength, strength, strength}});
    if (closure == GRADUS_OP_DIFFUSE) complete_diffuse();
  }
  // An emission with the coordinates Generated as colour: for a world, the direction.
  static MaterialDesc colored_by_generated() {
    MaterialDesc m(GRADUS_OP_EMISSION, Rgb(1.0f));
    m.nodes_.insert(m.nodes_.begin(), {GRADUS_OP_TEX_COORD, GRADUS_TEX_COORD_GENERATED, 0, 0, 0, 0, 0});
    m.inputs_[0].node = 0;
    return m;
  }
  GradusMaterial desc() const { return material_of(nodes_, inputs_, int32_t(nodes_.size()) - 1, "material"); }

 private:
  // DIFFUSE has color, roughness and normal; a normal of 0 is the shading normal.
  void complete_diffuse() {
    inputs_[1] = {-1, 0, {0, 0, 0, 0}};
    inputs_.push_back({-1, 0, {0, 0, 0, 0}});
    nodes_[0].input_count = 3;
  }
  std::vector<GradusNode> nodes_;
  std::vector<GradusInput> inputs_;
};

inline GradusLight make_light(GradusLightType type, const Mat4& matrix, const Rgb& strength) {
  GradusLight light{};
  light.struct_size = sizeof(light);
  light.type = type;
  light.visibility = GRADUS_VISIBLE_ALL;
  for (int i = 0; i < 16; ++i) light.matrix[i] = matrix[i / 4][i % 4];
  for (int i = 0; i < 3; ++i) light.strength[i] = strength[i];
  light.size[0] = light.size[1] = 1.0f;
  light.spread = kPi;
  light.cone = kPi / 2;
  light.max_bounces = UINT32_MAX;
  light.name = "light";
  return light;
}

class TestScene {
 public:
  explicit TestScene(std::shared_ptr<scene::Device> device = test_device()) : scene(std::move(device)) {}

  void mesh(uint64_t key, const Soup& soup) { scene.set_mesh(key, MeshDesc(soup).desc); }
  void material(uint64_t key, const MaterialDesc& material) { scene.set_material(key, material.desc()); }
  void lights(const std::vector<GradusLight>& lights) { scene.set_lights(lights.data(), lights.size()); }
  void world(uint64_t material_key, uint32_t map_size = 0) {
    GradusWorld w{};
    w.struct_size = sizeof(w);
    w.visibility = GRADUS_VISIBLE_ALL;
    w.material = material_key;
    w.importance = map_size ? 2 : 1;
    w.map_size = map_size;
    scene.set_world(w);
  }
  void instance(uint64_t mesh_key, const Mat4& matrix = Mat4(1.0f), uint32_t visibility = GRADUS_VISIBLE_ALL,
                uint64_t material = 0) {
    meshes_.push_back(mesh_key);
    matrices_.push_back(matrix);
    visibility_.push_back(visibility);
    first_.push_back(uint32_t(materials_.size()));
    count_.push_back(1);
    materials_.push_back(material);
    terminators_.push_back(shadow_terminator_offset);
    shading_offsets_.push_back(shading_offset);
    receiver_sets_.push_back(links.receiver_set);
    receiver_masks_.push_back(links.receiver_mask);
    blocker_sets_.push_back(links.blocker_set);
    blocker_masks_.push_back(links.blocker_mask);
    pass_indices_.push_back(pass_index);
    shutter_first_.push_back(uint32_t(shutter_matrices_.size()));
    shutter_count_.push_back(uint32_t(shutter_poses.size()));
    for (const Mat4& m : shutter_poses) shutter_matrices_.push_back(m * matrix);
  }
  // Sets the pose of the instance that was added as number i for the next commit.
  void move(size_t i, const Mat4& matrix) { matrices_[i] = matrix; }
  void dress(size_t i, uint64_t material) { materials_[i] = material; }
  void replace_mesh(size_t i, uint64_t mesh_key) { meshes_[i] = mesh_key; }
  size_t instance_count() const { return meshes_.size(); }
  void remove_last() {
    for (auto* values : {&meshes_, &materials_}) values->pop_back();
    for (auto* values : {&visibility_, &first_, &count_, &shutter_first_, &shutter_count_}) values->pop_back();
    matrices_.pop_back();
    terminators_.pop_back();
    shading_offsets_.pop_back();
    for (auto* sets : {&receiver_sets_, &blocker_sets_}) sets->pop_back();
    for (auto* masks : {&receiver_masks_, &blocker_masks_}) masks->pop_back();
    pass_indices_.pop_back();
  }
  // Commits the scene. Throws Error CANCELLED if *cancel becomes non-zero.
  std::shared_ptr<const scene::Snapshot> commit(const volatile int32_t* cancel = nullptr) {
    GradusInstances instances{};
    instances.struct_size = sizeof(instances);
    instances.count = meshes_.size();
    instances.meshes = meshes_.data();
    if (!matrices_.empty()) {
      instances.matrices = &matrices_[0][0][0];
      if (matrices_before.size() == matrices_.size()) instances.matrices_previous = &matrices_before[0][0][0];
      if (matrices_after.size() == matrices_.size()) instances.matrices_next = &matrices_after[0][0][0];
    }
    instances.visibility = visibility_.data();
    instances.pass_indices = pass_indices_.data();
    instances.material_first = first_.data();
    instances.material_count = count_.data();
    instances.materials = materials_.data();
    instances.materials_size = materials_.size();
    instances.shadow_terminator_offsets = terminators_.data();
    instances.shadow_terminator_shading_offsets = shading_offsets_.data();
    instances.receiver_sets = receiver_sets_.data();
    instances.receiver_masks = receiver_masks_.data();
    instances.blocker_sets = blocker_sets_.data();
    instances.blocker_masks = blocker_masks_.data();
    instances.shutter_first = shutter_first_.data();
    instances.shutter_count = shutter_count_.data();
    instances.shutter_size = shutter_matrices_.size();
    instances.shutter_matrices = shutter_matrices_.empty() ? nullptr : &shutter_matrices_[0][0][0];
    scene.set_instances(instances);
    scene.commit(cancel, nullptr);
    return scene.snapshot();
  }

  scene::Scene scene;
  std::vector<Mat4> matrices_before;      // of all instances one frame earlier; if the number differs: static
  std::vector<Mat4> matrices_after;       // of all instances one frame later; if the number differs: static
  float shadow_terminator_offset = 0.0f;  // of instances added later
  float shading_offset = 0.0f;            // of the shadow terminator of instances added later
  int32_t pass_index = 0;                 // of instances added later
  // Light and shadow links of instances that are added later.
  struct Links {
    uint32_t receiver_set = 0;
    uint64_t receiver_mask = 0;
    uint32_t blocker_set = 0;
    uint64_t blocker_mask = 0;
  } links;
  // Poses, while the shutter is open, of instances that are added later, multiplied by their matrix; empty: static.
  std::vector<Mat4> shutter_poses;

 private:
  std::vector<float> terminators_, shading_offsets_;
  std::vector<uint32_t> receiver_sets_, blocker_sets_;
  std::vector<uint64_t> receiver_masks_, blocker_masks_;
  std::vector<int32_t> pass_indices_;
  std::vector<uint32_t> shutter_first_, shutter_count_;
  std::vector<Mat4> shutter_matrices_;
  std::vector<uint64_t> meshes_, materials_;
  std::vector<Mat4> matrices_;
  std::vector<uint32_t> visibility_, first_, count_;
};

// Returns a closed sphere of 2·rings·segments - 2·segments triangles.
inline Soup sphere(const Vec3& centre, float radius, int rings, int segments) {
  Soup soup;
  const auto vertex = [&](int r, int s) -> Vec3 {
    if (r == 0) return centre + Vec3(0, 0, radius);
    if (r == rings) return centre - Vec3(0, 0, radius);
    const double theta = 3.14159265358979 * r / rings, phi = 2 * 3.14159265358979 * (s % segments) / segments;
    return centre + Vec3(glm::dvec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)) *
                         double(radius));
  };
  for (int r = 0; r <= rings; ++r)
    for (int s = 0; s < segments; ++s) soup.positions.push_back(vertex(r, s));
  const auto id = [&](int r, int s) { return r == 0 || r == rings ? r * segments : r * segments + s % segments; };
  for (int r = 0; r < rings; ++r)
    for (int s = 0; s < segments; ++s) {
      if (r > 0) soup.vertices.insert(soup.vertices.end(), {id(r, s), id(r + 1, s), id(r, s + 1)});
      if (r + 1 < rings) soup.vertices.insert(soup.vertices.end(), {id(r, s + 1), id(r + 1, s), id(r + 1, s + 1)});
    }
  return soup;
}

inline Vec3 random_direction(std::mt19937& random) {
  std::normal_distribution<float> normal;
  Vec3 v;
  do v = Vec3(normal(random), normal(random), normal(random));
  while (glm::dot(v, v) < 1e-6f);
  return glm::normalize(v);
}

// Gives all three frames of a camera the same pose and window, a clip range, and a focus at 4 m. window: 4 values.
inline void set_static(GradusCamera* camera, const float* window, const Mat4& pose) {
  for (float* to : {camera->window, camera->window_previous, camera->window_next}) std::copy(window, window + 4, to);
  for (float* to : {camera->matrix, camera->matrix_previous, camera->matrix_next})
    std::copy(&pose[0][0], &pose[0][0] + 16, to);
  camera->clip_start = 0.1f;
  camera->clip_end = 1000.0f;
  camera->aperture_ratio = 1.0f;
  camera->focus_distance = 4.0f;
}

}  // namespace gradus::test
