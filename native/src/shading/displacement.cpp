#include "shading/displacement.h"

#include <atomic>

#include "base/parallel_each.h"
#include "geometry/mesh.h"
#include "geometry/smooth_normals.h"
#include "shading/interpreter.h"
#include "shading/material.h"
#include "shading/scalar.h"

namespace gradus::shading {
namespace {

// Maximum length of an offset along an axis. Together with the largest coordinate of a mesh it stays below the limit of
// Embree.
constexpr float kMaxOffset = 5e17f;

// A corner of a triangle, at which a vertex is evaluated.
struct Corner {
  uint32_t triangle = 0;
  uint32_t k = 0;
};

bool is_usable(const Vec3& v) {
  return std::fabs(v.x) < kMaxOffset && std::fabs(v.y) < kMaxOffset && std::fabs(v.z) < kMaxOffset;
}

class Evaluation {
 public:
  Evaluation(const ShadedScene& scene, uint32_t index, const geometry::InstanceData& instance,
             const CommitMonitor& monitor)
      : scene_(scene), index_(index), instance_(instance), mesh_(*instance.mesh), monitor_(monitor) {
    if (mesh_.normals.empty() || mesh_.normal_domain == GRADUS_DOMAIN_FACE)
      vertex_normals_ = geometry::smooth_normals(mesh_, mesh_.frame_positions(), monitor);
  }

  VertexOffsets run() const {
    VertexOffsets result;
    result.offsets.assign(mesh_.vertex_count, Vec3(0.0f));
    result.moves.assign(mesh_.triangle_count, false);
    const std::vector<Corner> corners = choose_corners(&result);
    std::atomic<size_t> not_finite{0};
    parallel_each(corners.size(), monitor_, [&](size_t i) {
      const Vec3 offset = offset_at(corners[i]);
      if (is_usable(offset))
        result.offsets[vertex(corners[i])] = offset;
      else
        ++not_finite;
    });
    result.not_finite = not_finite;
    return result;
  }

 private:
  const MaterialData& material_of(uint32_t triangle) const {
    if (instance_.materials.empty()) return *scene_.materials[0];
    const size_t slot = std::min<size_t>(mesh_.material_slot(triangle), instance_.materials.size() - 1);
    return *scene_.materials[instance_.materials[slot]];
  }

  uint32_t vertex(const Corner& corner) const {
    return mesh_.triangle_vertices[size_t{corner.triangle} * 3 + corner.k];
  }

  // Chooses the corner of each vertex that moves, and sets `moves`.
  std::vector<Corner> choose_corners(VertexOffsets* result) const {
    std::vector<Corner> chosen;
    std::vector<bool> done(mesh_.vertex_count);
    for (uint32_t t = 0; t < mesh_.triangle_count; ++t) {
      monitor_.check_at(t);
      if (mesh_.is_dropped(t) || !material_of(t).displaces) continue;
      result->moves[t] = true;
      for (uint32_t k = 0; k < 3; ++k) {
        const Corner corner{t, k};
        if (done[vertex(corner)]) continue;
        done[vertex(corner)] = true;
        chosen.push_back(corner);
      }
    }
    return chosen;
  }

  // Returns the smooth normal at a corner, also of flat meshes, because a displacement must not tear them apart.
  Vec3 normal_at(const Corner& corner) const {
    if (!vertex_normals_.empty()) return vertex_normals_[vertex(corner)];
    const bool by_vertex = mesh_.normal_domain == GRADUS_DOMAIN_POINT;
    return mesh_.normals[by_vertex ? vertex(corner) : mesh_.triangle_corners[size_t{corner.triangle} * 3 + corner.k]];
  }

  ShadeContext context_at(const Corner& corner) const {
    ShadeContext c;
    c.scene = &scene_;
    c.images = scene_.images.get();
    c.instance = &instance_;
    c.hit.instance = index_;
    c.hit.primitive = corner.triangle;
    c.hit.uv = Vec2(corner.k == 1 ? 1.0f : 0.0f, corner.k == 2 ? 1.0f : 0.0f);
    c.hit.time = 0.5f;
    std::array<Vec3, 3> p = geometry::triangle_positions(mesh_, corner.triangle);
    for (Vec3& v : p) v = Vec3(instance_.to_world * Vec4(v, 1.0f));
    c.position = p[corner.k];
    const Vec3 across = safe_normalize(glm::cross(p[1] - p[0], p[2] - p[0]));
    c.geometric_normal = instance_.mirrored ? -across : across;
    c.normal = safe_normalize(instance_.normal_to_world * normal_at(corner));
    if (c.normal == Vec3(0.0f)) c.normal = c.geometric_normal;
    c.wo = c.normal;
    c.ray.flags = 0;
    return c;
  }

  Vec3 offset_at(const Corner& corner) const {
    const Vec3 offset(run_block(material_of(corner.triangle).displacement, 0, context_at(corner)));
    return Mat3(instance_.to_local) * offset;
  }

  const ShadedScene& scene_;
  uint32_t index_;
  const geometry::InstanceData& instance_;
  const geometry::MeshData& mesh_;
  const CommitMonitor& monitor_;
  std::vector<Vec3> vertex_normals_;  // only where the mesh has no smooth ones
};

}  // namespace

VertexOffsets evaluate_offsets(const ShadedScene& scene, uint32_t index, const geometry::InstanceData& instance,
                               const CommitMonitor& monitor) {
  return Evaluation(scene, index, instance, monitor).run();
}

}  // namespace gradus::shading
