// Small scenes for integrators: materials from a few lobes, cameras, and renders of a few pixels.
#pragma once

#include <string>
#include <vector>

#include "integrator/integrator.h"
#include "scene/scene_fixture.h"

namespace gradus::test {

// A surface: a sum of lobes, emission, and a transparent share.
struct Surface {
  Rgb diffuse = Rgb(0.0f);
  Rgb glossy = Rgb(0.0f);
  float glossy_roughness = 0.0f;  // Blender's: alpha is its square
  float glass = 0.0f;             // weight
  float glass_roughness = 0.0f;
  float ior = 1.5f;
  Rgb subsurface = Rgb(0.0f);
  Rgb subsurface_radius = Rgb(0.0f);
  float subsurface_roughness = 1.0f;
  uint32_t subsurface_mode = 2;  // GradusSubsurface
  Rgb emission = Rgb(0.0f);
  int emission_kind = -1;  // GradusLightPathMode: the emission is multiplied by it
  float transparent = 0.0f;
  bool sampled_as_light = true;
};

class PathScene {
 public:
  // Adds a material and returns its key, for instances.
  uint64_t material(const Surface& surface);
  uint64_t material(const GradusMaterial& desc);
  // Adds a parallelogram from a corner and two edges; its normal is along a × b.
  void quad(const Vec3& corner, const Vec3& a, const Vec3& b, uint64_t material,
            uint32_t visibility = GRADUS_VISIBLE_ALL);
  // smooth: with the normals of the true sphere.
  void ball(const Vec3& centre, float radius, uint64_t material, int rings = 12, bool smooth = false);
  void light(const GradusLight& light) { lights_.push_back(light); }
  void world(const Rgb& radiance);
  // Sets the world. map_size: width of its importance map.
  void world(uint64_t material, uint32_t map_size) { scene.world(material, map_size); }
  // Opens the shutter from half a frame before the frame to half a frame after it. An empty curve is constant.
  void open_shutter(std::vector<float> curve = {}, std::vector<Mat4> camera_motion = {});
  // Places a camera at `from`, looking at `at`, y up; field: width of the film at distance 1 (orthographic: in metres;
  // panorama: see GradusPanorama).
  void camera(const Vec3& from, const Vec3& at, float field, GradusCameraType type = GRADUS_CAMERA_PERSPECTIVE);

  GradusCamera camera_desc{};
  // Transforms quads, balls and the camera that are added later by a translation and a scale.
  Mat4 place = Mat4(1.0f);
  // Balls that are added later grow by this factor while the shutter is open.
  float swelling = 1.0f;
  // Commits. settings.width and height give the camera's aspect.
  integrator::IntegratorContext context(const GradusSettings& settings);

  TestScene scene;

 private:
  std::vector<GradusLight> lights_;
  uint64_t next_key_ = 1;
  std::vector<float> curve_;
  std::vector<Mat4> camera_motion_;  // multiplied by its matrix
  std::vector<Mat4> camera_keys_;
  Vec3 camera_from_ = Vec3(0.0f);
  float field_ = 1.0f;
};

// Returns settings with a small film, independent random numbers, and unlimited bounces.
GradusSettings test_settings(uint32_t width, uint32_t height);
// Samples pixel centres: pixels of a block share their sub-pixel jitter; without any, their errors are independent.
void sample_at_pixel_centres(GradusSettings* settings);

// Adds the samples [first, first + count) of all pixels.
void sample_film(const integrator::Integrator& integrator, uint32_t first, uint32_t count, film::Film* film);
film::Film make_test_film(const GradusSettings& settings, bool gradients, int components = 1);

// Adds an open box with two coloured walls, seen from its open side, and a square light below its ceiling.
void add_box(PathScene* scene, const Surface& floor);
void add_ceiling_light(PathScene* scene, float strength, float size);
Surface matte(const Rgb& color);
Surface glossy(float roughness);
Surface glass(float roughness);

// Cornell-like scenes, each for one case of the shift.
enum class Scenario {
  DiffuseArea,
  PointAndSun,
  World,
  GlossyFloor,
  RoughMetal,
  Mirror,
  Glass,
  RoughGlass,
  Transparent,
  LightsSeen,
  LightsUnseen,
  Facets,
  Fisheye,
  Moving,
  Subsurface,
  Linked,
  Count
};
const char* name_of(Scenario scenario);
void build(Scenario scenario, PathScene* scene);

}  // namespace gradus::test
