// How much of an image one look-up averages.
#include "shading/texture_extent.h"

#include <gtest/gtest.h>

#include "image/image_test_support.h"
#include "scene/scene_fixture.h"
#include "shading/context.h"
#include "shading/graph.h"
#include "shading/program_builder.h"

namespace gradus::test::texture_extent_test {
namespace {

constexpr float kPixelAngle = 0.01f;

// A triangle in z = 0 whose UV map is half as long as the surface along x, and a quarter along y. The image of its
// material is looked up at the origin, 10 m below the camera.
class ShadedTriangle {
 public:
  ShadedTriangle() {
    Soup soup;
    soup.triangle(Vec3(0.0f), Vec3(2, 0, 0), Vec3(0, 4, 0));
    MeshDesc mesh(soup);
    GradusAttribute map{};
    map.name = "UVMap";
    map.domain = GRADUS_DOMAIN_CORNER;
    map.channels = 2;
    map.is_uv = 1;
    map.data = uv_;
    mesh.desc.attributes = &map;
    mesh.desc.attribute_count = 1;
    mesh.desc.default_uv = "UVMap";
    scene_.scene.set_mesh(1, mesh.desc);
    scene_.instance(1);
    GradusCamera camera{};
    camera.struct_size = sizeof(camera);
    const float window[4] = {-1, 1, -1, 1};
    set_static(&camera, window, translation(Vec3(0.1f, 0.1f, 10.0f)));
    scene_.scene.set_camera(camera);
    snapshot_ = scene_.commit();
  }

  shading::ShadeContext context(uint32_t flags = shading::kRayCamera) const {
    geometry::Hit hit;
    EXPECT_TRUE(snapshot_->intersect({Vec3(0.1f, 0.1f, 1.0f), 0.0f, Vec3(0, 0, -1)}, GRADUS_VISIBLE_ALL, &hit));
    shading::RayState ray;
    ray.flags = flags;
    ray.pixel_angle = kPixelAngle;
    return shading::surface_context(*snapshot_, snapshot_->surface_point(hit), Vec3(0, 0, 1), ray);
  }

 private:
  TestScene scene_;
  const float uv_[6] = {0, 0, 1, 0, 0, 1};
  std::shared_ptr<const scene::Snapshot> snapshot_;
};

using Source = shading::TextureMap::Source;

TEST(TextureExtent, IsHalfAPixelSeenByTheCamera) {
  const ShadedTriangle triangle;
  // A pixel is 10 m · 0.01 long there, which is at least a quarter as long in the UV map.
  EXPECT_NEAR(texture_extent({Source::UvMap, "", 1.0f}, triangle.context()), 0.5f * 0.1f * 0.25f, 1e-5f);
  EXPECT_NEAR(texture_extent({Source::UvMap, "UVMap", 3.0f}, triangle.context()), 1.5f * 0.1f * 0.25f, 1e-5f);
  EXPECT_NEAR(texture_extent({Source::Object, "", 1.0f}, triangle.context()), 0.5f * 0.1f, 1e-5f);
  EXPECT_NEAR(texture_extent({Source::Generated, "", 1.0f}, triangle.context()), 0.5f * 0.1f * 0.5f, 1e-5f);
  EXPECT_EQ(texture_extent({Source::UvMap, "absent", 1.0f}, triangle.context()), 0.0f);
}

TEST(TextureExtent, DependsOnTheKindOfTheRay) {
  const ShadedTriangle triangle;
  const shading::TextureMap map{Source::Object, "", 1.0f};
  const float seen = texture_extent(map, triangle.context());
  EXPECT_GT(texture_extent(map, triangle.context(shading::kRayDiffuse | shading::kRayDiffuseAncestor)), seen);
  EXPECT_EQ(texture_extent(map, triangle.context(shading::kRayGlossy | shading::kRaySingular)), 0.0f);
  EXPECT_EQ(texture_extent(map, triangle.context(shading::kRayShadow)), 0.0f);
  shading::ShadeContext behind_portal = triangle.context();
  behind_portal.ray.portal_depth = 1;
  EXPECT_EQ(texture_extent(map, behind_portal), 0.0f);
  shading::ShadeContext without_pixels = triangle.context();
  without_pixels.ray.pixel_angle = 0.0f;
  EXPECT_EQ(texture_extent(map, without_pixels), 0.0f);
}

// Returns the map of coordinates that a program computes in its last node.
shading::TextureMap map_of(ProgramBuilder* b, int vector) {
  const int emission = b->add(GRADUS_OP_EMISSION, {In::from(vector), In(1.0f)});
  const shading::Graph graph = shading::build_graph(b->desc(emission), image::ImageStore());
  return shading::texture_map(graph, graph.nodes[size_t(emission)].inputs[0]);
}

TEST(TextureMap, FollowsMovesTurnsAndScales) {
  const auto mapped = [](uint32_t mode, const Vec3& rotation, const Vec3& scale) {
    ProgramBuilder b;
    const int uv = b.add(GRADUS_OP_TEX_COORD, {}, GRADUS_TEX_COORD_UV);
    const int mapping = b.add(GRADUS_OP_MAPPING, {In::from(uv), In(Vec3(1, 2, 3)), In(rotation), In(scale)}, mode);
    const int sum =
        b.add(GRADUS_OP_VECTOR_MATH, {In::from(mapping), In(Vec3(0.5f)), In(0.0f), In(1.0f)}, GRADUS_VECTOR_ADD);
    return map_of(&b, sum).scale;
  };
  EXPECT_EQ(mapped(GRADUS_MAPPING_POINT, Vec3(0, 0, 0.3f), Vec3(3, -4, 1)), 3.0f);
  EXPECT_EQ(mapped(GRADUS_MAPPING_TEXTURE, Vec3(0.0f), Vec3(2, 4, 1)), 0.25f);
  EXPECT_EQ(mapped(GRADUS_MAPPING_TEXTURE, Vec3(0.0f), Vec3(0, 4, 1)), 0.0f);
}

// Regression: each node asked for the coordinates of its input twice, so that a chain took exponential time.
TEST(TextureMap, OfALongChain) {
  ProgramBuilder b;
  int last = b.add(GRADUS_OP_TEX_COORD, {}, GRADUS_TEX_COORD_UV);
  for (int i = 0; i < 200; ++i)
    last = b.add(GRADUS_OP_VECTOR_MATH, {In::from(last), In(Vec3(1.0f)), In(0.0f), In(1.0f)}, GRADUS_VECTOR_MULTIPLY);
  EXPECT_EQ(map_of(&b, last).scale, 1.0f);
}

// Coordinates that a texture distorts, or that another object gives, are not known.
TEST(TextureMap, IsUnknownBehindOtherNodes) {
  ProgramBuilder b;
  const int uv = b.add(GRADUS_OP_TEX_COORD, {}, GRADUS_TEX_COORD_UV);
  const int sine = b.add(GRADUS_OP_VECTOR_MATH, {In::from(uv), In(0.0f), In(0.0f), In(1.0f)}, GRADUS_VECTOR_SINE);
  EXPECT_EQ(map_of(&b, sine).source, Source::Unknown);
  ProgramBuilder turned;  // out of the plane of the UV map
  const int map = turned.add(GRADUS_OP_TEX_COORD, {}, GRADUS_TEX_COORD_UV);
  const int mapping =
      turned.add(GRADUS_OP_MAPPING, {In::from(map), In(0.0f), In(Vec3(0.3f, 0, 0)), In(1.0f)}, GRADUS_MAPPING_POINT);
  EXPECT_EQ(map_of(&turned, mapping).source, Source::Unknown);
  ProgramBuilder other;
  const int object = other.add(GRADUS_OP_TEX_COORD, {}, GRADUS_TEX_COORD_OBJECT, std::vector<float>(16, 1.0f));
  EXPECT_EQ(map_of(&other, object).source, Source::Unknown);
}

// Returns an image of black and white columns.
StoredImage stripes() {
  image::ImageSource source;
  source.color_space = "Non-Color";
  source.tiles.resize(1);
  source.tiles[0].source = GRADUS_IMAGE_BYTE;
  source.tiles[0].width = source.tiles[0].height = 64;
  for (uint32_t i = 0; i < 64 * 64; ++i) {
    const uint8_t v = i % 2 ? 255 : 0;
    source.tiles[0].data.insert(source.tiles[0].data.end(), {v, v, v, 255});
  }
  return with_coarser(store_source(source));
}

// A material shows the mean of the columns in its reflection, and one that emits shows the columns.
TEST(TextureExtent, LightSourcesAreShownInFull) {
  const ShadedTriangle triangle;
  const StoredImage image = stripes();
  for (const bool emits : {false, true}) {
    ProgramBuilder b;
    const int uv = b.add(GRADUS_OP_TEX_COORD, {}, GRADUS_TEX_COORD_UV);
    const int texture = b.add(GRADUS_OP_IMAGE, {In::from(uv)}, 0, {}, 7);
    const int closure = emits ? b.add(GRADUS_OP_EMISSION, {In::from(texture), In(1.0f)})
                              : b.add(GRADUS_OP_DIFFUSE, {In::from(texture), In(0.0f), In(Vec3(0.0f))});
    const auto material = shading::compile_material(b.desc(closure), image.store);
    shading::ShadeContext c = triangle.context(shading::kRayDiffuse | shading::kRayDiffuseAncestor);
    c.images = &image.store;
    const shading::ShadeResult result = run(material->surface, c);
    const float full =
        image.store.lookup(image.index, Vec2(0.05f, 0.025f), image::Interpolation::Linear, image::Extension::Repeat).x;
    if (emits) {
      EXPECT_NEAR(result.emission.x, full, 1e-4f);
    } else {
      EXPECT_NEAR(result.closures.lobe(0).weight.x, 0.5f, 0.003f);
    }
  }
}

}  // namespace
}  // namespace gradus::test::texture_extent_test
