// Makes the instances of a snapshot from those that the caller has set. Broken instances are left out. A scene that is
// far from the origin is moved to its centre, for float precision.
#include <algorithm>
#include <cmath>

#include "base/cryptomatte_id.h"
#include "base/hash.h"
#include "scene/scene_state.h"

namespace gradus::scene {

namespace {

// Distance from the origin, in radii of the scene, beyond which the scene is moved. Below it, positions keep 18 bits
// within the scene.
constexpr double kFarRadii = 64.0;
// Minimum relative volume of a matrix's columns. Below it, the inverse is not accurate enough in float.
constexpr double kMinVolume = 1e-10;

struct Bounds {
  glm::dvec3 lower{1e300}, upper{-1e300};
  void add(const glm::dvec3& p) {
    lower = glm::min(lower, p);
    upper = glm::max(upper, p);
  }
  bool empty() const { return lower.x > upper.x; }
  glm::dvec3 centre() const { return (lower + upper) * 0.5; }
  double radius() const { return glm::length(upper - lower) * 0.5; }
};

void add_box(const geometry::MeshData& mesh, const glm::dmat4& m, Bounds* bounds) {
  for (int i = 0; i < 8; ++i) {
    const glm::dvec4 corner((i & 1 ? mesh.upper : mesh.lower).x, (i & 2 ? mesh.upper : mesh.lower).y,
                            (i & 4 ? mesh.upper : mesh.lower).z, 1);
    bounds->add(glm::dvec3(m * corner));
  }
}

// Returns the origin of internal space. It lies on a coarse grid, so that it stays the same during an animation, and so
// that its subtraction is exact.
Vec3 choose_origin(const Bounds& bounds) {
  if (bounds.empty()) return Vec3(0.0f);
  const glm::dvec3 c = bounds.centre();
  const double far = std::max(std::fabs(c.x), std::max(std::fabs(c.y), std::fabs(c.z)));
  const double radius = std::max(bounds.radius(), 1e-6);
  if (far < kFarRadii * radius) return Vec3(0.0f);
  const double grid = std::exp2(std::ceil(std::log2(radius)));
  return Vec3(glm::round(c / grid) * grid);
}

std::vector<size_t> choose_usable(const Scene::State& state, Snapshot* snapshot) {
  const geometry::InstanceArrays& a = state.instances;
  std::vector<size_t> usable;
  usable.reserve(a.count);
  AffectedObjects broken, unknown, torn, lost;
  for (size_t i = 0; i < a.count; ++i) {
    const auto found = state.meshes.find(a.meshes[i]);
    if (found == state.meshes.end()) {
      unknown.add(a.name(i));
      continue;
    }
    const geometry::MeshData& mesh = *found->second;
    const bool visible = mesh.dropped_triangles < mesh.triangle_count;
    if (mesh.dropped_triangles > 0) (visible ? torn : lost).add(a.name(i));
    if (!is_usable(a.matrices[i])) {
      broken.add(a.name(i));
    } else if (visible) {
      usable.push_back(i);
    }
  }
  std::vector<std::string>* warnings = &snapshot->warnings;
  broken.warn("was left out", "were left out", "its matrix is singular or not finite", warnings);
  unknown.warn("was left out", "were left out", "it names a mesh that does not exist", warnings);
  lost.warn("was left out", "were left out", "no triangle has finite vertices", warnings);
  torn.warn("lost triangles", "lost triangles", "some vertices are not finite", warnings);
  return usable;
}

Mat4 moved(const Mat4& m, const Vec3& origin) { return Mat4(internal_matrix(m, origin)); }

void set_matrices(const geometry::InstanceArrays& a, size_t i, const Vec3& origin, geometry::InstanceData* out) {
  const glm::dmat4 m = internal_matrix(a.matrices[i], origin);
  static_cast<geometry::Placement&>(*out) = geometry::make_placement(m);
  out->mirrored = glm::determinant(glm::dmat3(m)) < 0.0;
  const bool previous = !a.matrices_previous.empty() && is_usable(a.matrices_previous[i]);
  const bool next = !a.matrices_next.empty() && is_usable(a.matrices_next[i]);
  out->was_there = a.matrices_previous.empty() || previous;
  out->will_be_there = a.matrices_next.empty() || next;
  out->to_world_previous = previous ? moved(a.matrices_previous[i], origin) : out->to_world;
  out->to_world_next = next ? moved(a.matrices_next[i], origin) : out->to_world;
}

// Sets the motion while the shutter is open. An instance with an unusable shutter matrix does not move.
void set_keys(const geometry::InstanceArrays& a, size_t i, const Vec3& origin, geometry::InstanceData* out) {
  out->deforms = out->mesh->shutter_keys > 0;
  if (a.shutter_first.empty() || a.shutter_count[i] == 0) return;
  std::vector<glm::dmat4> keys;
  for (uint32_t k = 0; k < a.shutter_count[i]; ++k) {
    const Mat4& m = a.shutter_matrices[a.shutter_first[i] + k];
    if (!is_usable(m)) return;
    keys.push_back(internal_matrix(m, origin));
  }
  out->keys = std::make_shared<const geometry::MatrixKeys>(keys);
}

void set_values(const geometry::InstanceArrays& a, size_t i, geometry::InstanceData* out) {
  out->id = a.ids.empty() ? i : a.ids[i];
  if (!a.visibility.empty()) out->visibility = a.visibility[i];
  if (!a.random_ids.empty()) out->random_id = a.random_ids[i];
  if (!a.pass_indices.empty()) out->pass_index = a.pass_indices[i];
  if (!a.colors.empty()) out->color = a.colors[i];
  if (!a.generated.empty()) out->generated = a.generated[i];
  if (!a.uvs.empty()) out->uv = a.uvs[i];
  if (!a.light_groups.empty()) out->light_group = a.light_groups[i];
  if (!a.shadow_terminator_offsets.empty()) out->shadow_terminator_offset = a.shadow_terminator_offsets[i];
  if (!a.shadow_terminator_shading_offsets.empty())
    out->terminator_frequency = 1.0f / (1.0f - 0.5f * std::clamp(a.shadow_terminator_shading_offsets[i], 0.0f, 1.0f));
  if (!a.receiver_sets.empty()) out->light_set = uint64_t{1} << a.receiver_sets[i];
  if (!a.blocker_sets.empty()) out->shadow_set = uint64_t{1} << a.blocker_sets[i];
  out->links = geometry::emitter_links(a.receiver_masks.empty() ? 0 : a.receiver_masks[i],
                                       a.blocker_masks.empty() ? 0 : a.blocker_masks[i]);
  for (size_t k = 0; k < a.attribute_names.size(); ++k) out->attributes.push_back(a.attributes[k * a.count + i]);
}

// Sets the identifiers of the instances' names for Cryptomattes. `usable`: the number in `a` of each instance.
void set_identifiers(const geometry::InstanceArrays& a, const std::vector<size_t>& usable, Snapshot* snapshot) {
  std::vector<float> ids;
  for (const std::string& name : a.names) ids.push_back(cryptomatte_id(name));
  ids.push_back(0.0f);  // of instances without a name
  for (size_t k = 0; k < usable.size(); ++k) {
    const size_t i = usable[k];
    snapshot->instances[k].cryptomatte_object = ids[a.object_name(i)];
    snapshot->instances[k].cryptomatte_asset = ids[a.asset_name(i)];
  }
}

}  // namespace

bool is_usable(const Mat4& m) {
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      if (!(std::fabs(m[i][j]) < 1e15f)) return false;
  const glm::dmat3 axes{glm::dmat4(m)};
  const double sizes = glm::length(axes[0]) * glm::length(axes[1]) * glm::length(axes[2]);
  return sizes > 1e-45 && std::fabs(glm::determinant(axes)) > kMinVolume * sizes;
}

glm::dmat4 internal_matrix(const Mat4& matrix, const Vec3& origin) {
  glm::dmat4 m(matrix);
  m[3] -= glm::dvec4(glm::dvec3(origin), 0.0);
  m[0].w = m[1].w = m[2].w = 0.0;
  m[3].w = 1.0;
  return m;
}

void set_radius(Snapshot* snapshot) {
  Bounds bounds;
  for (const geometry::InstanceData& instance : snapshot->instances)
    add_box(*instance.mesh, glm::dmat4(instance.to_world), &bounds);
  snapshot->radius = bounds.empty() ? 1.0f : float(std::max(bounds.radius(), 1e-6));
}

std::vector<size_t> place_instances(const Scene::State& state, Snapshot* snapshot) {
  const geometry::InstanceArrays& a = state.instances;
  std::vector<size_t> usable = choose_usable(state, snapshot);
  Bounds bounds;
  for (const size_t i : usable)
    add_box(*state.meshes.at(a.meshes[i]), internal_matrix(a.matrices[i], Vec3(0.0f)), &bounds);
  snapshot->origin = choose_origin(bounds);
  snapshot->radius = bounds.empty() ? 1.0f : float(std::max(bounds.radius(), 1e-6));
  snapshot->instances.resize(usable.size());
  snapshot->instance_attribute_names = a.attribute_names;
  for (size_t k = 0; k < usable.size(); ++k) {
    geometry::InstanceData& out = snapshot->instances[k];
    out.mesh = state.meshes.at(a.meshes[usable[k]]);
    set_matrices(a, usable[k], snapshot->origin, &out);
    set_keys(a, usable[k], snapshot->origin, &out);
    set_values(a, usable[k], &out);
  }
  if (has_cryptomatte(state.channels)) set_identifiers(a, usable, snapshot);
  return usable;
}

}  // namespace gradus::scene
