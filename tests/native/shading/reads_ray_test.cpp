// Every operation says in which of its modes it reads the ray: the gradient integrator reuses the shading of a point
// for other rays unless an operation says so.
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "scene/scene_fixture.h"
#include "shading/closure_ops.h"
#include "shading/context.h"
#include "shading/op_info.h"
#include "shading/program_builder.h"

namespace gradus::test::reads_ray_test {
namespace {

constexpr uint64_t kMesh = 1, kMaterial = 2, kImage = 3;

void set_image(scene::Scene* scene) {
  const float pixels[] = {0.1f, 0.2f, 0.3f, 1.0f, 0.9f, 0.5f, 0.4f, 0.5f,
                          0.2f, 0.8f, 0.6f, 1.0f, 0.7f, 0.3f, 0.9f, 1.0f};
  GradusImageTile tile{};
  tile.struct_size = sizeof(tile);
  tile.source = GRADUS_IMAGE_FLOAT;
  tile.width = tile.height = 2;
  tile.data = pixels;
  tile.data_size = sizeof(pixels);
  GradusImage image{};
  image.struct_size = sizeof(image);
  image.color_space = "Non-Color";
  image.name = "image";
  image.is_float = 1;
  image.tiles = &tile;
  image.tile_count = 1;
  scene->set_image(kImage, image);
}

// A triangle with smooth normals, a UV map and an attribute.
void set_mesh(scene::Scene* scene) {
  Soup soup;
  soup.triangle(Vec3(-1.0f, -1.0f, 0.2f), Vec3(1.5f, -1.0f, 0.0f), Vec3(0.0f, 1.5f, -0.3f));
  MeshDesc mesh(soup);
  const float uv[] = {0.0f, 0.1f, 1.0f, 0.2f, 0.4f, 0.9f}, heat[] = {0.2f, 0.5f, 0.9f};
  const GradusAttribute attributes[] = {{sizeof(GradusAttribute), GRADUS_DOMAIN_CORNER, 2, 1, "map", uv},
                                        {sizeof(GradusAttribute), GRADUS_DOMAIN_POINT, 1, 0, "heat", heat}};
  const float normals[] = {-0.3f, 0.0f, 0.95f, 0.3f, 0.1f, 0.95f, 0.0f, 0.3f, 0.95f};
  mesh.desc.attributes = attributes;
  mesh.desc.attribute_count = 2;
  mesh.desc.normal_domain = GRADUS_DOMAIN_CORNER;
  mesh.desc.normals = normals;
  scene->set_mesh(kMesh, mesh.desc);
}

// Has a normal map, so that the mesh gets tangents.
void set_material(scene::Scene* scene) {
  ProgramBuilder b;
  const int normal = b.add(GRADUS_OP_NORMAL_MAP, {In(1.0f), In(Vec3(0.6f, 0.4f, 0.9f))}, GRADUS_NORMAL_TANGENT);
  const int surface = b.add(GRADUS_OP_DIFFUSE, {In(0.5f), In(0.0f), In::from(normal)});
  scene->set_material(kMaterial, b.desc(surface));
}

std::shared_ptr<const scene::Snapshot> make_scene() {
  TestScene scene;
  set_image(&scene.scene);
  set_mesh(&scene.scene);
  set_material(&scene.scene);
  GradusCamera camera{};
  camera.struct_size = sizeof(camera);
  camera.type = GRADUS_CAMERA_PERSPECTIVE;
  const Mat4 place = translation(Vec3(0.3f, 0.2f, 5.0f));
  for (int i = 0; i < 16; ++i) camera.matrix[i] = place[i / 4][i % 4];
  camera.window[0] = camera.window[2] = -0.5f;
  camera.window[1] = camera.window[3] = 0.5f;
  camera.clip_start = 0.1f;
  camera.clip_end = 1e6f;
  scene.scene.set_camera(camera);
  scene.instance(kMesh, translation(Vec3(0.1f, -0.2f, 0.3f)) * scaling(Vec3(1.0f, 2.0f, 1.5f)), GRADUS_VISIBLE_ALL,
                 kMaterial);
  return scene.commit();
}

// A ray that arrives: from where it is seen, and its history.
struct Arrival {
  Vec3 wo;
  shading::RayState ray;
};

const Arrival kFirst{glm::normalize(Vec3(0.3f, 0.2f, 0.9f)), {shading::kRayCamera, 2.5f, 0, 0, 0, 0, 0}};

// Rays that differ from kFirst in one property each, from the same side of the surface.
std::vector<Arrival> rays_of_the_same_side() {
  std::vector<Arrival> rays{{glm::normalize(Vec3(-0.6f, 0.3f, 0.5f)), kFirst.ray}, kFirst, kFirst};
  rays[1].ray.length = 7.0f;
  rays[2].ray.flags = shading::kRayShadow;
  return rays;
}

// Rays that differ in their depths, and in their kind other than camera and shadow.
std::vector<Arrival> rays_of_other_history() {
  std::vector<Arrival> rays;
  for (const uint32_t flag : {shading::kRayDiffuse, shading::kRayGlossy, shading::kRaySingular, shading::kRayReflection,
                              shading::kRayTransmission}) {
    rays.push_back(kFirst);
    rays.back().ray.flags |= flag;
  }
  for (uint16_t shading::RayState::*depth : {&shading::RayState::depth, &shading::RayState::diffuse_depth,
                                             &shading::RayState::glossy_depth, &shading::RayState::transmission_depth,
                                             &shading::RayState::transparent_depth, &shading::RayState::portal_depth}) {
    rays.push_back(kFirst);
    rays.back().ray.*depth = 2;
  }
  return rays;
}

// Evaluates operations at one point of a surface.
class OpsAtAPoint : public testing::Test {
 protected:
  OpsAtAPoint() : scene_(make_scene()) {
    geometry::Hit hit;
    const bool met =
        scene_->intersect({Vec3(0.2f, 0.1f, 4.0f), 0.0f, Vec3(0.0f, 0.0f, -1.0f), kInfinity}, GRADUS_VISIBLE_ALL, &hit);
    EXPECT_TRUE(met);
    point_ = scene_->surface_point(hit);
  }

  shading::ShadeContext context(const Arrival& arrival) const {
    return shading::surface_context(*scene_, point_, arrival.wo, arrival.ray);
  }

  // Returns all outputs of an operation for some inputs, one after another. The input `zero` is 0, as a normal input to
  // which nothing is linked.
  std::vector<float> evaluate(uint32_t op, uint32_t mode, float inputs, const Arrival& arrival, int zero = -1) const {
    const std::string name = op == GRADUS_OP_ATTRIBUTE ? "heat" : "map";
    const std::vector<float> floats(16, 0.3f);
    std::vector<Vec4> in;
    for (int k = 0; k < shading::kMaxInputs; ++k)
      in.push_back(k == zero ? Vec4(0.0f)
                             : Vec4(inputs * 0.7f, inputs * 0.4f, inputs * (0.5f + 0.02f * float(k)), 1.0f));
    shading::ResourceArgs args;
    args.mode = mode;
    args.in = in.data();
    args.floats = floats.data();
    args.name = &name;
    args.resource = scene_->images->index_of(kImage);
    args.float_count = op == GRADUS_OP_IMAGE ? 1 : 0;
    Vec4 out[shading::kMaxOutputs] = {};
    EXPECT_TRUE(shading::evaluate_context(op, args, context(arrival), out)) << op;
    return std::vector<float>(&out[0].x, &out[0].x + 4 * shading::op_info(op)->outputs);
  }

  // Returns whether a value of the operation differs between kFirst and one of the rays.
  bool changes(uint32_t op, uint32_t mode, const std::vector<Arrival>& rays) const {
    for (const float inputs : {0.0f, 1.0f, -0.6f}) {
      const std::vector<float> first = evaluate(op, mode, inputs, kFirst);
      for (const Arrival& ray : rays) {
        if (evaluate(op, mode, inputs, ray) != first) return true;
      }
    }
    return false;
  }

  const std::shared_ptr<const scene::Snapshot> scene_;
  geometry::SurfacePoint point_;
};

// Calls visit(op, mode) for all operations of a kind in all of their modes.
void for_each_op(shading::OpKind kind, const std::function<void(uint32_t op, uint32_t mode)>& visit) {
  for (uint32_t op = 0; op < GRADUS_OP_LIMIT; ++op) {
    const shading::OpInfo* info = shading::op_info(op);
    if (info == nullptr || info->kind != kind) continue;
    for (uint32_t mode = 0; mode <= info->last_mode; ++mode) visit(op, mode);
  }
}

std::string text_of(uint32_t op, uint32_t mode) {
  return std::string(shading::op_info(op)->name) + ", mode " + std::to_string(mode);
}

TEST_F(OpsAtAPoint, ThatReadTheRaySaySo) {
  std::vector<Arrival> others = rays_of_the_same_side(), from_behind = {{-kFirst.wo, kFirst.ray}};
  for (const Arrival& ray : rays_of_other_history()) others.push_back(ray);
  for_each_op(shading::OpKind::Context, [&](uint32_t op, uint32_t mode) {
    const bool says_so = shading::reads_ray(op, mode);
    if (changes(op, mode, others)) {
      EXPECT_TRUE(says_so) << text_of(op, mode);
    } else if (says_so) {
      EXPECT_TRUE(changes(op, mode, from_behind)) << text_of(op, mode) << " prevents reuse without a reason";
    }
  });
}

TEST_F(OpsAtAPoint, ThatReadTheHistoryOfTheRaySaySo) {
  for_each_op(shading::OpKind::Context, [&](uint32_t op, uint32_t mode) {
    EXPECT_EQ(changes(op, mode, rays_of_other_history()), shading::reads_history(op, mode)) << text_of(op, mode);
  });
}

// The bump of a displacement is left out where a program says that it does not read the normal.
TEST_F(OpsAtAPoint, ThatReadTheNormalSaySo) {
  for_each_op(shading::OpKind::Context, [&](uint32_t op, uint32_t mode) {
    bool changes = false;
    const Vec3 normal = point_.shading_normal, other = glm::normalize(normal + Vec3(2.0f, -0.8f, 0.1f));
    for (const int zero : {-1, 1, 3}) {
      const std::vector<float> first = evaluate(op, mode, 0.9f, kFirst, zero);
      point_.shading_normal = other;
      changes |= evaluate(op, mode, 0.9f, kFirst, zero) != first;
      point_.shading_normal = normal;
    }
    // These do so by other rays and inputs than those of this test.
    if (op == GRADUS_OP_AMBIENT_OCCLUSION || op == GRADUS_OP_BEVEL || op == GRADUS_OP_NORMAL_MAP ||
        op == GRADUS_OP_DISPLACEMENT) {
      EXPECT_TRUE(shading::reads_normal(op, mode)) << text_of(op, mode);
    } else {
      EXPECT_EQ(changes, shading::reads_normal(op, mode)) << text_of(op, mode);
    }
  });
  for_each_op(shading::OpKind::Pure,
              [&](uint32_t op, uint32_t mode) { EXPECT_FALSE(shading::reads_normal(op, mode)) << text_of(op, mode); });
}

// The functions of pure operations get nothing of the ray. For closures their lobes say it.
TEST_F(OpsAtAPoint, ThatDoNotReadThePointReadNoRay) {
  for (const shading::OpKind kind : {shading::OpKind::Pure, shading::OpKind::Closure}) {
    for_each_op(kind, [&](uint32_t op, uint32_t mode) {
      EXPECT_FALSE(shading::reads_ray(op, mode) || shading::reads_history(op, mode)) << text_of(op, mode);
    });
  }
}

TEST_F(OpsAtAPoint, BumpReadsTheRayThroughItsHeightAlone) {
  for (const auto& [mode, reads] :
       {std::pair(uint32_t(GRADUS_GEOMETRY_POSITION), false), std::pair(uint32_t(GRADUS_GEOMETRY_INCOMING), true)}) {
    for (uint32_t inverted = 0; inverted <= 1; ++inverted) {
      ProgramBuilder b;
      const int value = b.add(GRADUS_OP_GEOMETRY, {}, mode);
      const int height =
          b.add(GRADUS_OP_NOISE,
                {In::from(value), In(0.0f), In(1.0f), In(1.0f), In(0.5f), In(2.0f), In(0.0f), In(1.0f), In(0.0f)},
                GRADUS_NOISE_MODE(3, 0, 1, 0));
      const int bump = b.add(GRADUS_OP_BUMP, {In(0.8f), In(0.2f), In::from(height), In(0.0f), In(1.0f)}, inverted);
      const auto material = b.compile(b.add(GRADUS_OP_EMISSION, {In::from(bump), In(1.0f)}));
      EXPECT_FALSE(shading::reads_ray(GRADUS_OP_BUMP, inverted));
      EXPECT_EQ(material->values_depend_on_ray, reads);
      const Rgb first = run(material->surface, context(kFirst)).emission;
      EXPECT_NE(first, Rgb(context(kFirst).normal)) << "the height bends nothing: nothing is tested";
      for (const Arrival& ray : rays_of_the_same_side()) {
        if (!reads) {
          EXPECT_EQ(run(material->surface, context(ray)).emission, first);
        }
      }
    }
  }
}

void expect_equal_lobes(const bsdf::Closures& a, const bsdf::Closures& b, const std::string& what) {
  ASSERT_EQ(a.count(), b.count()) << what;
  for (int i = 0; i < a.count(); ++i) {
    EXPECT_EQ(a.lobe(i).type, b.lobe(i).type) << what;
    EXPECT_EQ(a.lobe(i).weight, b.lobe(i).weight) << what;
    EXPECT_EQ(a.lobe(i).alpha_x, b.lobe(i).alpha_x) << what;
    EXPECT_EQ(a.lobe(i).alpha_y, b.lobe(i).alpha_y) << what;
    EXPECT_EQ(a.lobe(i).normal, b.lobe(i).normal) << what;
  }
}

// A closure whose lobes are the same for all directions adds the same light to them.
TEST_F(OpsAtAPoint, ClosuresOfEqualLobesAreEqual) {
  int equal = 0;
  for_each_op(shading::OpKind::Closure, [&](uint32_t op, uint32_t mode) {
    for (const float inputs : {0.0f, 0.3f, 1.0f}) {
      const std::vector<Vec4> in(shading::kMaxInputs, Vec4(inputs));
      const auto result_for = [&](const Arrival& arrival) {
        shading::ClosureArgs args;
        args.op = op;
        args.mode = mode;
        args.in = in.data();
        shading::ShadeResult result;
        shading::add_closure(args, context(arrival), &result);
        result.closures.finish(arrival.wo, context(arrival).geometric_normal, 0.1f);
        return result;
      };
      const shading::ShadeResult first = result_for(kFirst);
      if (!first.closures.ignores_wo()) continue;
      ++equal;
      for (const Arrival& ray : rays_of_the_same_side()) {
        const shading::ShadeResult other = result_for(ray);
        EXPECT_TRUE(other.closures.ignores_wo()) << text_of(op, mode);
        expect_equal_lobes(other.closures, first.closures, text_of(op, mode));
        EXPECT_EQ(other.emission, first.emission) << text_of(op, mode);
        EXPECT_EQ(other.transparency, first.transparency) << text_of(op, mode);
        EXPECT_EQ(other.holdout, first.holdout) << text_of(op, mode);
      }
    }
  });
  EXPECT_GT(equal, 5);
}

}  // namespace
}  // namespace gradus::test::reads_ray_test
