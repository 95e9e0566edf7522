#include "support/path_scene.h"

#include <cmath>
#include <sstream>

#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>

#include "gradus/gradus_nodes.h"

namespace gradus::test {

namespace {

// Collects nodes of a program; closures take constants only.
class Program {
 public:
  int32_t closure(uint32_t op, const std::vector<Vec4>& values, uint32_t mode = 0) {
    for (const Vec4& v : values) {
      inputs_.push_back({-1, 0, {v.x, v.y, v.z, v.w}});
    }
    return node(op, static_cast<uint32_t>(values.size()), mode);
  }
  int32_t emission(const Vec4& color, int light_path) {
    const int32_t kind = node(GRADUS_OP_LIGHT_PATH, 0, static_cast<uint32_t>(light_path));
    inputs_.push_back({-1, 0, {color.x, color.y, color.z, color.w}});
    inputs_.push_back({kind, 0, {0, 0, 0, 0}});
    return node(GRADUS_OP_EMISSION, 2, 0);
  }
  int32_t combine(uint32_t op, int32_t a, int32_t b, float factor) {
    if (op == GRADUS_OP_MIX_SHADER) {
      inputs_.push_back({-1, 0, {factor, factor, factor, factor}});
    }
    inputs_.push_back({a, 0, {0, 0, 0, 0}});
    inputs_.push_back({b, 0, {0, 0, 0, 0}});
    return node(op, op == GRADUS_OP_MIX_SHADER ? 3 : 2, 0);
  }
  int32_t add(int32_t a, int32_t b) { return a < 0 ? b : combine(GRADUS_OP_ADD_SHADER, a, b, 0.0f); }
  GradusMaterial desc(int32_t surface, const char* name, int32_t index) const {
    GradusMaterial d = material_of(nodes_, inputs_, surface, name);
    d.pass_index = index;
    return d;
  }

 private:
  int32_t node(uint32_t op, uint32_t inputs, uint32_t mode) {
    nodes_.push_back({op, mode, static_cast<uint32_t>(inputs_.size()) - inputs, inputs, 0, 0, 0});
    return static_cast<int32_t>(nodes_.size()) - 1;
  }
  std::vector<GradusNode> nodes_;
  std::vector<GradusInput> inputs_;
};

Vec4 rgb(const Rgb& c) { return Vec4(c, 1.0f); }

int32_t build_surface(const Surface& s, Program* p) {
  int32_t surface = -1;
  if (!is_black(s.diffuse)) {
    surface = p->add(surface, p->closure(GRADUS_OP_DIFFUSE, {rgb(s.diffuse)}));
  }
  if (!is_black(s.glossy)) {
    surface = p->add(surface, p->closure(GRADUS_OP_GLOSSY, {rgb(s.glossy), Vec4(s.glossy_roughness)}));
  }
  if (s.glass > 0.0f) {
    surface = p->add(surface, p->closure(GRADUS_OP_GLASS, {Vec4(s.glass), Vec4(s.glass_roughness), Vec4(s.ior)}));
  }
  if (!is_black(s.subsurface)) {
    surface = p->add(surface, p->closure(GRADUS_OP_SUBSURFACE,
                                         {rgb(s.subsurface), Vec4(1.0f), rgb(s.subsurface_radius), Vec4(s.ior),
                                          Vec4(s.subsurface_roughness), Vec4(0.0f)},
                                         s.subsurface_mode));
  }
  if (!is_black(s.emission)) {
    surface = p->add(surface, s.emission_kind >= 0 ? p->emission(rgb(s.emission), s.emission_kind)
                                                   : p->closure(GRADUS_OP_EMISSION, {rgb(s.emission), Vec4(1.0f)}));
  }
  if (s.transparent > 0.0f) {
    surface = p->combine(GRADUS_OP_MIX_SHADER, surface, p->closure(GRADUS_OP_TRANSPARENT, {Vec4(1.0f)}), s.transparent);
  }
  return surface;
}

// Describes a surface in messages.
std::string text_of(const Surface& s) {
  std::ostringstream text;
  const auto color = [&text](const char* what, const Rgb& c) -> std::ostringstream& {
    text << ' ' << what << ' ' << c.x << ' ' << c.y << ' ' << c.z;
    return text;
  };
  if (!is_black(s.diffuse)) color("diffuse", s.diffuse);
  if (!is_black(s.glossy)) color("glossy", s.glossy) << ' ' << s.glossy_roughness * s.glossy_roughness;
  if (s.glass > 0.0f) text << " glass " << s.glass_roughness * s.glass_roughness << ' ' << s.ior;
  if (!is_black(s.subsurface)) color("subsurface", s.subsurface) << ' ' << s.subsurface_mode;
  if (!is_black(s.emission)) color("emit", s.emission);
  if (s.transparent > 0.0f) text << " transparent " << s.transparent;
  return text.str();
}

Mat4 look_at(const Vec3& from, const Vec3& at) {
  const Vec3 z = glm::normalize(from - at);
  const Vec3 up = std::fabs(z.y) > 0.99f ? Vec3(0, 0, -1) : Vec3(0, 1, 0);
  const Vec3 x = glm::normalize(glm::cross(up, z));
  Mat4 m(1.0f);
  m[0] = Vec4(x, 0.0f);
  m[1] = Vec4(glm::cross(z, x), 0.0f);
  m[2] = Vec4(z, 0.0f);
  m[3] = Vec4(from, 1.0f);
  return m;
}

}  // namespace

uint64_t PathScene::material(const Surface& surface) {
  const uint64_t key = next_key_++;
  Program program;
  const int32_t result = build_surface(surface, &program);
  const std::string name = text_of(surface);
  GradusMaterial desc = program.desc(result, name.c_str(), static_cast<int32_t>(key));
  desc.sample_as_light = surface.sampled_as_light ? 1 : 0;
  scene.scene.set_material(key, desc);
  return key;
}

uint64_t PathScene::material(const GradusMaterial& desc) {
  const uint64_t key = next_key_++;
  scene.scene.set_material(key, desc);
  return key;
}

void PathScene::quad(const Vec3& corner, const Vec3& a, const Vec3& b, uint64_t material, uint32_t visibility) {
  Soup soup;
  soup.triangle(corner, corner + a, corner + a + b);
  soup.triangle(corner, corner + a + b, corner + b);
  const uint64_t key = next_key_++;
  scene.mesh(key, soup);
  scene.instance(key, place, visibility, material);
}

void PathScene::ball(const Vec3& centre, float radius, uint64_t material, int rings, bool smooth) {
  const Soup soup = sphere(centre, radius, rings, 2 * rings);
  MeshDesc mesh(soup);
  std::vector<Vec3> normals;
  if (smooth) {
    for (const Vec3& p : soup.positions) {
      normals.push_back(glm::normalize(p - centre));
    }
    mesh.desc.normal_domain = GRADUS_DOMAIN_POINT;
    mesh.desc.normals = &normals[0].x;
  }
  std::vector<Vec3> keys;
  if (swelling != 1.0f) {
    for (const float factor : {1.0f, swelling}) {
      for (const Vec3& p : soup.positions) keys.push_back(centre + factor * (p - centre));
    }
    mesh.desc.shutter_key_count = 2;
    mesh.desc.shutter_positions = &keys[0].x;
  }
  const uint64_t key = next_key_++;
  scene.scene.set_mesh(key, mesh.desc);
  scene.instance(key, place, GRADUS_VISIBLE_ALL, material);
}

void PathScene::world(const Rgb& radiance) {
  Surface surface;
  surface.emission = radiance;
  scene.world(material(surface));
}

void PathScene::camera(const Vec3& from, const Vec3& at, float field, GradusCameraType type) {
  camera_desc.struct_size = sizeof(GradusCamera);
  camera_desc.type = type;
  Mat4 m = look_at(from, at);
  m[3] = place * m[3];
  for (int i = 0; i < 16; ++i) {
    camera_desc.matrix[i] = camera_desc.matrix_previous[i] = camera_desc.matrix_next[i] = m[i / 4][i % 4];
  }
  camera_desc.clip_start = 1e-3f;
  camera_desc.clip_end = 1e4f;
  camera_desc.aperture_ratio = 1.0f;
  camera_desc.focus_distance = 1.0f;
  field_ = field;
}

void PathScene::open_shutter(std::vector<float> curve, std::vector<Mat4> camera_motion) {
  camera_desc.shutter_open = -0.5f;
  camera_desc.shutter_close = 0.5f;
  curve_ = std::move(curve);
  camera_motion_ = std::move(camera_motion);
}

integrator::IntegratorContext PathScene::context(const GradusSettings& settings) {
  const float aspect = static_cast<float>(settings.height) / static_cast<float>(settings.width);
  const float window[4] = {-0.5f * field_, 0.5f * field_, -0.5f * field_ * aspect, 0.5f * field_ * aspect};
  for (int i = 0; i < 4; ++i) {
    camera_desc.window[i] = camera_desc.window_previous[i] = camera_desc.window_next[i] = window[i];
  }
  camera_desc.shutter_curve = curve_.empty() ? nullptr : curve_.data();
  camera_desc.shutter_curve_count = static_cast<uint32_t>(curve_.size());
  camera_keys_.clear();
  for (const Mat4& m : camera_motion_) camera_keys_.push_back(m * glm::make_mat4(camera_desc.matrix));
  camera_desc.shutter_key_count = static_cast<uint32_t>(camera_keys_.size());
  camera_desc.shutter_matrices = camera_keys_.empty() ? nullptr : &camera_keys_[0][0][0];
  scene.scene.set_camera(camera_desc);
  scene.lights(lights_);
  integrator::IntegratorContext context;
  context.snapshot = scene.commit();
  context.camera = camera::Camera(context.snapshot->camera, settings.width, settings.height);
  context.settings = settings;
  return context;
}

GradusSettings test_settings(uint32_t width, uint32_t height) {
  GradusSettings s{};
  s.struct_size = sizeof(s);
  s.width = width;
  s.height = height;
  s.max_bounces = s.diffuse_bounces = s.glossy_bounces = s.transmission_bounces = 64;
  s.transparent_max_bounces = 8;
  s.pixel_filter = GRADUS_FILTER_BOX;
  s.filter_width = 1.5f;
  s.film_exposure = 1.0f;
  s.roughness_threshold = 0.1f;
  s.use_sky = 1;
  s.caustics_reflective = s.caustics_refractive = 1;
  s.independent_sampler = 1;
  return s;
}

void sample_at_pixel_centres(GradusSettings* settings) {
  settings->pixel_filter = GRADUS_FILTER_GAUSSIAN;
  settings->filter_width = 1e-4f;
}

void sample_film(const integrator::Integrator& integrator, uint32_t first, uint32_t count, film::Film* film) {
  integrator::WorkUnit unit;
  unit.tile = film->region;
  unit.first_sample = first;
  unit.count = count;
  const std::atomic<bool> stop{false};
  integrator.sample(unit, film, &film->counters, stop);
}

film::Film make_test_film(const GradusSettings& settings, bool gradients, int components) {
  const Region region{0, 0, static_cast<int32_t>(settings.width), static_cast<int32_t>(settings.height)};
  return film::Film(settings.width, settings.height, region, settings.film_transparent != 0 ? 4 : 3, components,
                    gradients);
}

Surface matte(const Rgb& color) {
  Surface s;
  s.diffuse = color;
  return s;
}

void add_box(PathScene* scene, const Surface& floor) {
  const uint64_t white = scene->material(matte(Rgb(0.7f)));
  const uint64_t red = scene->material(matte(Rgb(0.7f, 0.2f, 0.1f)));
  const uint64_t green = scene->material(matte(Rgb(0.1f, 0.6f, 0.2f)));
  scene->quad(Vec3(-1, -1, 1), Vec3(2, 0, 0), Vec3(0, 0, -2), scene->material(floor));
  scene->quad(Vec3(-1, 1, -1), Vec3(2, 0, 0), Vec3(0, 0, 2), white);
  scene->quad(Vec3(-1, -1, -1), Vec3(2, 0, 0), Vec3(0, 2, 0), white);
  scene->quad(Vec3(-1, -1, 1), Vec3(0, 0, -2), Vec3(0, 2, 0), red);
  scene->quad(Vec3(1, -1, -1), Vec3(0, 0, 2), Vec3(0, 2, 0), green);
  scene->camera(Vec3(0, 0, 3.2f), Vec3(0, 0, 0), 0.9f);
}

void add_ceiling_light(PathScene* scene, float strength, float size) {
  Surface light;
  light.emission = Rgb(strength);
  scene->quad(Vec3(-0.5f * size, 0.98f, -0.5f * size), Vec3(size, 0, 0), Vec3(0, 0, size), scene->material(light));
}

Surface glossy(float roughness) {
  Surface s;
  s.glossy = Rgb(0.8f, 0.7f, 0.6f);
  s.glossy_roughness = roughness;
  return s;
}

Surface glass(float roughness) {
  Surface s;
  s.glass = 1.0f;
  s.glass_roughness = roughness;
  return s;
}

namespace {

GradusLight point_light(const Vec3& position, float radius, float intensity) {
  GradusLight light = make_light(GRADUS_LIGHT_POINT, translation(position), Rgb(intensity));
  light.radius = radius;
  return light;
}

// Adds a ball light and a rectangle light over a glossy ball.
void add_lights_with_extent(PathScene* scene, uint32_t flags, float roughness) {
  GradusLight ball = point_light(Vec3(0.3f, 0.2f, 0.2f), 0.15f, 0.5f);
  ball.flags |= flags;
  scene->light(ball);
  GradusLight area = make_light(GRADUS_LIGHT_RECTANGLE, translation(Vec3(-0.3f, 0.9f, 0.0f)), Rgb(4.0f));
  Mat4 down(1.0f);
  down[1] = Vec4(0, 0, -1, 0);
  down[2] = Vec4(0, 1, 0, 0);
  down[3] = Vec4(-0.3f, 0.9f, 0.0f, 1.0f);
  for (int i = 0; i < 16; ++i) area.matrix[i] = down[i / 4][i % 4];
  area.size[0] = area.size[1] = 0.4f;
  area.flags |= flags;
  scene->light(area);
  scene->ball(Vec3(0.0f, -0.5f, 0.0f), 0.4f, scene->material(glossy(roughness)), 8, true);
}

}  // namespace

const char* name_of(Scenario scenario) {
  static const char* const names[] = {
      "DiffuseArea", "PointAndSun", "World",       "GlossyFloor", "RoughMetal", "Mirror", "Glass",      "RoughGlass",
      "Transparent", "LampsSeen",   "LampsUnseen", "Facets",      "Fisheye",    "Moving", "Subsurface", "Linked"};
  return names[static_cast<int>(scenario)];
}

void build(Scenario scenario, PathScene* scene) {
  Surface floor = matte(Rgb(0.6f));
  if (scenario == Scenario::GlossyFloor) {
    floor = matte(Rgb(0.4f));
    floor.glossy = Rgb(0.4f);
    floor.glossy_roughness = 0.25f;  // class R, which light sampling reaches
  }
  add_box(scene, floor);
  switch (scenario) {
    case Scenario::DiffuseArea:
      add_ceiling_light(scene, 8.0f, 0.6f);
      scene->ball(Vec3(0.3f, -0.6f, 0.1f), 0.4f, scene->material(matte(Rgb(0.5f))), 6);
      break;
    case Scenario::PointAndSun: {
      scene->light(point_light(Vec3(0.1f, 0.6f, 0.4f), 0.0f, 0.6f));
      GradusLight sun = make_light(GRADUS_LIGHT_SUN, Mat4(1.0f), Rgb(1.0f));
      scene->light(sun);
      sun.angle = 0.5f;
      scene->light(sun);
      scene->ball(Vec3(0.3f, -0.6f, 0.1f), 0.4f, scene->material(matte(Rgb(0.5f))), 6);
      break;
    }
    case Scenario::World:
      scene->world(Rgb(0.8f, 1.0f, 1.2f));
      scene->camera(Vec3(0, 0, 3.2f), Vec3(0, 0, 0), 1.4f);  // the camera sees past the box
      scene->ball(Vec3(0.3f, -0.6f, 0.1f), 0.4f, scene->material(matte(Rgb(0.5f))), 6);
      break;
    case Scenario::GlossyFloor:
      add_ceiling_light(scene, 8.0f, 0.6f);
      scene->light(point_light(Vec3(-0.4f, 0.3f, 0.3f), 0.0f, 0.2f));
      break;
    case Scenario::Facets: {  // directions near the terminator, for lights found by both techniques or one of them
      scene->scene.shadow_terminator_offset = 0.4f;
      add_lights_with_extent(scene, 0, 0.6f);
      scene->ball(Vec3(0.5f, -0.6f, 0.4f), 0.35f, scene->material(matte(Rgb(0.6f))), 4, true);
      Surface leaf = matte(Rgb(0.5f));
      leaf.glass = 0.3f;
      leaf.glass_roughness = 0.6f;
      scene->ball(Vec3(-0.5f, -0.5f, 0.3f), 0.35f, scene->material(leaf), 4, true);
      add_ceiling_light(scene, 4.0f, 0.4f);
      scene->light(make_light(GRADUS_LIGHT_SUN, Mat4(1.0f), Rgb(0.5f)));
      break;
    }
    case Scenario::RoughMetal:
      add_ceiling_light(scene, 8.0f, 0.6f);
      scene->ball(Vec3(0.0f, -0.3f, 0.0f), 0.6f, scene->material(glossy(0.5f)), 10, true);
      break;
    case Scenario::Mirror:
      add_ceiling_light(scene, 8.0f, 0.6f);
      scene->ball(Vec3(0.0f, -0.3f, 0.0f), 0.6f, scene->material(glossy(0.0f)), 10, true);
      break;
    case Scenario::Glass:
      add_ceiling_light(scene, 8.0f, 1.2f);
      scene->ball(Vec3(0.0f, -0.3f, 0.0f), 0.6f, scene->material(glass(0.0f)), 10, true);
      break;
    case Scenario::RoughGlass:
      add_ceiling_light(scene, 8.0f, 1.2f);
      scene->ball(Vec3(0.0f, -0.3f, 0.0f), 0.6f, scene->material(glass(0.25f)), 10, true);
      break;
    case Scenario::Transparent: {
      add_ceiling_light(scene, 8.0f, 0.6f);
      Surface veil = matte(Rgb(0.5f, 0.4f, 0.3f));
      veil.transparent = 0.5f;
      scene->quad(Vec3(-0.7f, -0.7f, 0.4f), Vec3(1.2f, 0, 0.3f), Vec3(0, 1.1f, -0.2f), scene->material(veil));
      break;
    }
    case Scenario::LightsSeen:
      add_lights_with_extent(scene, 0, 0.2f);
      break;
    case Scenario::LightsUnseen:
      add_lights_with_extent(scene, GRADUS_LIGHT_NO_MIS, 0.6f);  // light sampling alone is noisy on narrower lobes
      break;
    case Scenario::Fisheye:  // from within the box; the image circle ends inside of the film
      add_ceiling_light(scene, 8.0f, 0.6f);
      scene->ball(Vec3(0.3f, -0.6f, -0.3f), 0.35f, scene->material(glossy(0.3f)), 10, true);
      scene->camera(Vec3(0, 0, 0.7f), Vec3(0, -0.1f, 0), 3.6f, GRADUS_CAMERA_PANORAMA);
      scene->camera_desc.panorama = GRADUS_PANORAMA_FISHEYE_EQUIDISTANT;
      scene->camera_desc.fisheye_fov = 3.0f;
      break;
    case Scenario::Moving: {  // a light that rotates, a ball that grows, a mirror and glass that move, a moving camera
      Surface light;
      light.emission = Rgb(4.0f, 3.2f, 2.4f);
      scene->scene.shutter_poses = {translation(Vec3(-0.3f, 0, 0)),
                                    glm::rotate(translation(Vec3(0.3f, 0, 0)), 1.2f, Vec3(0, 0, 1))};
      scene->quad(Vec3(-0.4f, 0.5f, -0.4f), Vec3(0.8f, 0, 0), Vec3(0, 0, 0.8f), scene->material(light));
      scene->scene.shutter_poses = {translation(Vec3(0, -0.15f, 0)), Mat4(1.0f), translation(Vec3(0.1f, 0.2f, 0))};
      scene->ball(Vec3(-0.5f, -0.6f, 0.3f), 0.3f, scene->material(glossy(0.0f)), 8, true);
      scene->scene.shutter_poses = {Mat4(1.0f), translation(Vec3(0, 0.2f, 0.1f))};
      scene->ball(Vec3(0.1f, -0.6f, 0.5f), 0.25f, scene->material(glass(0.0f)), 8, true);
      scene->scene.shutter_poses.clear();
      scene->swelling = 1.4f;
      scene->ball(Vec3(0.55f, -0.6f, 0.0f), 0.3f, scene->material(matte(Rgb(0.5f))), 6, true);
      scene->open_shutter({0.0f, 1.0f, 1.0f}, {Mat4(1.0f), translation(Vec3(0.05f, 0.02f, 0))});
      break;
    }
    case Scenario::Subsurface: {  // seen by the camera and by diffuse walls, beside a surface that is diffuse
      add_ceiling_light(scene, 8.0f, 0.6f);
      Surface wax;
      wax.subsurface = Rgb(0.8f, 0.6f, 0.4f);
      wax.subsurface_radius = Rgb(3.0f, 2.0f, 1.0f);
      scene->ball(Vec3(-0.4f, -0.5f, 0.1f), 0.4f, scene->material(wax), 8, true);
      wax.glossy = Rgb(0.2f);
      wax.glossy_roughness = 0.2f;
      wax.subsurface_roughness = 0.3f;
      wax.subsurface_mode = GRADUS_SUBSURFACE_DE_HULST;
      wax.subsurface_radius = Rgb(0.2f, 0.1f, 0.05f);
      scene->ball(Vec3(0.4f, -0.6f, 0.2f), 0.35f, scene->material(wax), 8, true);
      break;
    }
    case Scenario::Linked: {  // lights that light or are blocked by some objects only, and a shifted terminator
      constexpr uint64_t kUnlinked = 1, kFirst = 2, kSecond = 4;
      GradusLight ball = point_light(Vec3(0.3f, 0.2f, 0.2f), 0.15f, 0.5f);
      ball.receiver_mask = kUnlinked | kFirst;
      ball.blocker_mask = kSecond;
      scene->light(ball);
      GradusLight point = point_light(Vec3(-0.4f, 0.5f, 0.3f), 0.0f, 0.3f);
      point.receiver_mask = kSecond;
      scene->light(point);
      GradusLight sun = make_light(GRADUS_LIGHT_SUN, Mat4(1.0f), Rgb(1.0f));
      sun.angle = 0.4f;
      sun.receiver_mask = kUnlinked | kSecond;
      sun.blocker_mask = kFirst;
      scene->light(sun);
      scene->scene.links = {0, kUnlinked | kSecond, 0, kFirst};
      add_ceiling_light(scene, 6.0f, 0.6f);
      scene->scene.links = {1, 0, 1, 0};
      scene->ball(Vec3(-0.4f, -0.5f, 0.1f), 0.4f, scene->material(glossy(0.2f)), 8, true);
      scene->scene.links = {2, 0, 2, 0};
      scene->scene.shading_offset = 0.5f;
      scene->ball(Vec3(0.5f, -0.6f, 0.3f), 0.35f, scene->material(matte(Rgb(0.6f))), 6, true);
      Surface veil = matte(Rgb(0.5f, 0.4f, 0.3f));
      veil.transparent = 0.5f;
      scene->quad(Vec3(-0.7f, 0.1f, -0.3f), Vec3(1.2f, 0, 0.3f), Vec3(0, 0.1f, 0.8f), scene->material(veil));
      scene->scene.shading_offset = 0.0f;
      scene->scene.links = {};
      break;
    }
    case Scenario::Count:
      break;
  }
}

}  // namespace gradus::test
