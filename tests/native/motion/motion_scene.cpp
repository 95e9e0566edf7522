#include "motion/motion_scene.h"

#include <cmath>
#include <sstream>

#include "gradus/gradus_nodes.h"

namespace gradus::test {

namespace {

std::vector<Vec3> positions_of(const Sheet& sheet) {
  std::vector<Vec3> positions;
  for (int y = 0; y <= sheet.cells; ++y)
    for (int x = 0; x <= sheet.cells; ++x) {
      const Vec2 p(2.0f * float(x) / float(sheet.cells) - 1.0f, 2.0f * float(y) / float(sheet.cells) - 1.0f);
      positions.emplace_back(
          p, sheet.height * std::sin(3.0f * p.x + sheet.phase) * std::cos(2.0f * p.y + 0.5f * sheet.phase));
    }
  return positions;
}

// A graph of nodes whose inputs are constants and earlier nodes.
class Nodes {
 public:
  static GradusInput value(float x, float y, float z) { return {-1, 0, {x, y, z, 0.0f}}; }
  static GradusInput value(float x) { return {-1, 0, {x, x, x, x}}; }
  static GradusInput of(int32_t node) { return {node, 0, {0, 0, 0, 0}}; }
  int32_t add(uint32_t op, uint32_t mode, const std::vector<GradusInput>& inputs) {
    nodes_.push_back({op, mode, uint32_t(inputs_.size()), uint32_t(inputs.size()), 0, 0, 0});
    inputs_.insert(inputs_.end(), inputs.begin(), inputs.end());
    return int32_t(nodes_.size()) - 1;
  }
  int32_t mirror(int32_t normal) {
    return add(GRADUS_OP_GLOSSY, 0, {value(0.8f), value(0.0f), value(0.0f), value(0.0f), of(normal)});
  }
  uint64_t material(PathScene* scene, int32_t surface) const {
    return scene->material(material_of(nodes_, inputs_, surface, "nodes"));
  }

 private:
  std::vector<GradusNode> nodes_;
  std::vector<GradusInput> inputs_;
};

}  // namespace

void set_sheet(PathScene* scene, uint64_t mesh_key, const Sheet& sheet, const Sheet* before, const Sheet* later) {
  Soup soup;
  soup.positions = positions_of(sheet);
  const int side = sheet.cells + 1;
  for (int y = 0; y < sheet.cells; ++y)
    for (int x = 0; x < sheet.cells; ++x) {
      const int i = y * side + x;
      soup.vertices.insert(soup.vertices.end(), {i, i + 1, i + side + 1, i, i + side + 1, i + side});
    }
  std::vector<Vec2> uvs;
  for (const Vec3& p : soup.positions) uvs.push_back(0.5f * (Vec2(p) + 1.0f));
  std::vector<Vec3> keys;
  const std::array<float, 3> times{-1.0f, 0.0f, 1.0f};
  if (before != nullptr && later != nullptr) {
    for (const Sheet* s : {before, &sheet, later}) {
      const std::vector<Vec3> p = positions_of(*s);
      keys.insert(keys.end(), p.begin(), p.end());
    }
  }
  GradusAttribute uv{sizeof(GradusAttribute), GRADUS_DOMAIN_POINT, 2, 1, "UVMap", &uvs[0].x};
  MeshDesc mesh(soup);
  mesh.desc.normal_domain = sheet.smooth ? GRADUS_DOMAIN_POINT : GRADUS_DOMAIN_FACE;
  if (sheet.has_uv) {
    mesh.desc.attribute_count = 1;
    mesh.desc.attributes = &uv;
    mesh.desc.default_uv = "UVMap";
  }
  if (!keys.empty()) {
    mesh.desc.key_count = 3;
    mesh.desc.key_times = times.data();
    mesh.desc.positions = &keys[0].x;
  }
  scene->scene.scene.set_mesh(mesh_key, mesh.desc);
}

uint64_t normal_mapped_mirror(PathScene* scene, float tilt, float waves) {
  Nodes n;
  const int32_t uv = n.add(GRADUS_OP_TEX_COORD, GRADUS_TEX_COORD_UV, {});
  const int32_t turns =
      n.add(GRADUS_OP_VECTOR_MATH, GRADUS_VECTOR_MULTIPLY, {Nodes::of(uv), Nodes::value(2.0f * kPi * waves)});
  const int32_t wave = n.add(GRADUS_OP_VECTOR_MATH, GRADUS_VECTOR_SINE, {Nodes::of(turns)});
  const int32_t color =
      n.add(GRADUS_OP_VECTOR_MATH, GRADUS_VECTOR_MULTIPLY_ADD,
            {Nodes::of(wave), Nodes::value(0.5f * tilt, 0.5f * tilt, 0.0f), Nodes::value(0.5f, 0.5f, 1.0f)});
  const int32_t normal = n.add(GRADUS_OP_NORMAL_MAP, GRADUS_NORMAL_TANGENT, {Nodes::value(1.0f), Nodes::of(color)});
  return n.material(scene, n.mirror(normal));
}

uint64_t bumped_mirror(PathScene* scene, float distance) {
  Nodes n;
  const int32_t place = n.add(GRADUS_OP_TEX_COORD, GRADUS_TEX_COORD_GENERATED, {});
  const int32_t noise =
      n.add(GRADUS_OP_NOISE, 3,
            {Nodes::of(place), Nodes::value(0.0f), Nodes::value(3.0f), Nodes::value(0.0f), Nodes::value(0.5f),
             Nodes::value(2.0f), Nodes::value(0.0f), Nodes::value(1.0f), Nodes::value(0.0f)});
  const int32_t normal =
      n.add(GRADUS_OP_BUMP, 0,
            {Nodes::value(1.0f), Nodes::value(distance), Nodes::of(noise), Nodes::value(0.0f), Nodes::value(1.0f)});
  return n.material(scene, n.mirror(normal));
}

void MotionTest::add_room() {
  const uint64_t matter = grey();
  scene_.quad(Vec3(-6, -1, 6), Vec3(12, 0, 0), Vec3(0, 0, -10), matter);
  scene_.quad(Vec3(-6, -1, -4), Vec3(12, 0, 0), Vec3(0, 8, 0), matter);
  scene_.quad(Vec3(-6, -1, 6), Vec3(0, 8, 0), Vec3(12, 0, 0), matter);
}

void MotionTest::add_ball(uint64_t material, int rings, bool smooth) {
  add_room();
  scene_.ball(Vec3(0, 0, 0), 0.8f, material, rings, smooth);
  scene_.camera(Vec3(0, 0.5f, 4), Vec3(0, 0, 0), 0.5f);
}

const MotionFrame* MotionTest::frame(const char* component) {
  frames_.push_back(motion_frame(scene_.context(test_settings(kSize, kSize)), components_, component));
  return frames_.back().get();
}

void MotionTest::expect_bounded(const motion::ChainMotion& motion) {
  for (size_t i = 0; i < motion.film.size(); ++i) {
    const Vec2 moved = motion.film[i] - Vec2(float(i % kSize) + 0.5f, float(i / kSize) + 0.5f);
    ASSERT_LE(std::max(std::fabs(moved.x), std::fabs(moved.y)), float(kSize));
    ASSERT_TRUE(motion.tracking[i] == motion::Tracking::Tracked || moved == Vec2(0.0f));
  }
}

motion::ChainMotion MotionTest::expect_motion(const char* component, const std::function<void(float)>& at) {
  constexpr int kBetween = 32;
  std::vector<const MotionFrame*> path;
  for (int k = 0; k <= kBetween; ++k) {
    at(float(k) / float(kBetween));
    path.push_back(frame(component));
  }
  const motion::ChainMotion found = motion(path.front(), path.back());
  expect_bounded(found);
  const size_t chains = path.front()->chains.chains.size();
  const MotionErrors e = errors_of(found, path, std::max<size_t>(1, chains / 80));
  std::ostringstream causes;
  for (const uint64_t count : found.counts.pixels) causes << ' ' << count;
  EXPECT_GT(e.pixels, 40u);
  EXPECT_GE(e.share(), 0.95f) << causes.str();
  EXPECT_EQ(e.invented, 0u);
  EXPECT_LE(e.quantile(0.5), 0.1f);
  EXPECT_LE(e.quantile(0.95), 0.5f);
  const motion::TrackingCounts& c = found.counts;
  const double searched = double(std::max<uint64_t>(c.searched, 1));
  RecordProperty("pixels", int(e.pixels));
  RecordProperty("invented", int(e.invented));
  RecordProperty("median", std::to_string(e.quantile(0.5)));
  RecordProperty("quantile95", std::to_string(e.quantile(0.95)));
  RecordProperty("share", std::to_string(e.share()));
  RecordProperty("space_steps", std::to_string(double(c.search.space) / searched));
  RecordProperty("time_steps", std::to_string(double(c.search.time) / searched));
  RecordProperty("traced", std::to_string(double(c.search.traced) / searched));
  return found;
}

}  // namespace gradus::test
