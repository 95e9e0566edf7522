#include "scene/dice_instances.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "geometry/diced_mesh.h"
#include "geometry/mesh.h"

namespace gradus::scene {

namespace {

// Maximum number of triangles of a diced mesh, which take about 300 MB.
constexpr uint64_t kMaxTriangles = uint64_t(1) << 21;

// Measures lengths at points of internal space as shares of the picture's width.
class Picture {
 public:
  explicit Picture(const GradusCamera& camera) : camera_(camera), to_camera_(inverse_of(camera)) {}

  float share(const Vec3& a, const Vec3& b) const {
    const float length = glm::distance(a, b);
    if (camera_.type == GRADUS_CAMERA_ORTHOGRAPHIC) return length / width();
    const float distance = std::max(glm::length(Vec3(to_camera_ * Vec4((a + b) * 0.5f, 1.0f))), camera_.clip_start);
    const float angle = length / std::max(distance, 1e-6f);
    return camera_.type == GRADUS_CAMERA_PANORAMA ? angle / (2.0f * kPi) : angle / width();
  }

  bool shows(const Vec3& point) const {
    if (camera_.type == GRADUS_CAMERA_PANORAMA) return true;
    const Vec3 p(to_camera_ * Vec4(point, 1.0f));
    if (!(p.z < 0.0f)) return false;
    const Vec2 place = camera_.type == GRADUS_CAMERA_ORTHOGRAPHIC ? Vec2(p) : Vec2(p) / -p.z;
    const float* w = camera_.window;
    return place.x >= w[0] && place.x <= w[1] && place.y >= w[2] && place.y <= w[3];
  }

 private:
  static Mat4 inverse_of(const GradusCamera& camera) {
    Mat4 m;
    std::copy_n(camera.matrix, 16, &m[0][0]);
    return glm::inverse(m);
  }
  float width() const { return std::max(camera_.window[1] - camera_.window[0], 1e-6f); }

  const GradusCamera& camera_;
  Mat4 to_camera_;
};

// Returns by how many times the longest edge of an instance exceeds what its mesh asks for.
float excess_of(const Picture& picture, const geometry::InstanceData& instance) {
  const geometry::MeshData& mesh = *instance.mesh;
  float most = 0.0f;
  for (uint32_t t = 0; t < mesh.triangle_count; ++t) {
    if (mesh.is_dropped(t)) continue;
    const std::array<Vec3, 3> local = geometry::triangle_positions(mesh, t);
    std::array<Vec3, 3> p = local;
    for (Vec3& v : p) v = Vec3(instance.to_world * Vec4(v, 1.0f));
    for (size_t k = 0; k < 3; ++k) {
      const size_t next = (k + 1) % 3;
      if (mesh.dicing_rate > 0.0f) {
        const bool is_seen = picture.shows(p[k]) || picture.shows(p[next]);
        const float rate = mesh.dicing_rate * (is_seen ? 1.0f : mesh.offscreen_dicing_scale);
        most = std::max(most, picture.share(p[k], p[next]) / rate);
      } else if (mesh.dicing_length > 0.0f) {
        most = std::max(most, glm::distance(local[k], local[next]) / mesh.dicing_length);
      }
    }
  }
  return most;
}

// Returns how often a mesh is divided. Sets *is_coarse if the limit on triangles decides.
uint32_t levels_of(const Picture& picture, const geometry::InstanceData& instance, bool* is_coarse) {
  const geometry::MeshData& mesh = *instance.mesh;
  const float excess = excess_of(picture, instance);
  uint32_t levels = 0;
  while (levels < mesh.dicing_levels && std::exp2(float(levels)) < excess) {
    if ((uint64_t{mesh.triangle_count} << (2 * (levels + 1))) > kMaxTriangles) {
      *is_coarse = true;
      break;
    }
    ++levels;
  }
  return levels;
}

}  // namespace

std::vector<size_t> dice_instances(const CommitMonitor& monitor, std::vector<DicedMesh>* known, Snapshot* snapshot) {
  std::vector<size_t> coarse;
  std::map<const geometry::MeshData*, DicedMesh> diced;
  const Picture picture(snapshot->camera);
  for (size_t k = 0; k < snapshot->instances.size(); ++k) {
    geometry::InstanceData& instance = snapshot->instances[k];
    if (instance.mesh->dicing_levels == 0) continue;
    DicedMesh& result = diced[instance.mesh.get()];
    if (!result.from) {
      monitor.check();
      bool is_coarse = false;
      result.from = instance.mesh;
      result.levels = levels_of(picture, instance, &is_coarse);
      if (is_coarse) coarse.push_back(k);
      const auto old = std::find_if(known->begin(), known->end(), [&](const DicedMesh& d) {
        return d.from == result.from && d.levels == result.levels;
      });
      result.mesh = old != known->end() ? old->mesh : geometry::diced_mesh(result.from, result.levels);
    }
    instance.mesh = result.mesh;
  }
  known->clear();
  for (auto& [from, result] : diced) known->push_back(std::move(result));
  return coarse;
}

}  // namespace gradus::scene
