// Correspondences for every type of camera: a pixel corresponds to the pixel whose ray passes nearest to the point that
// it shows. The expected pixel is found from the closed forms of rays (camera_test.cpp, panorama_test.cpp), not from
// the projection of points to the film, which the tested code uses.
#include <cmath>
#include <set>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "motion/pixel_matching.h"
#include "support/path_scene.h"

namespace gradus::test::camera_correspondence_test {
namespace {

constexpr int kWidth = 48, kHeight = 32;
constexpr float kEye = 0.1f;
constexpr float kRoom = 3.0f, kFarAway = 1e4f;  // radii of spheres around the camera
constexpr float kTurn = 6.2831853f;

struct CameraType {
  const char* name;
  uint32_t type;
  float window[4];
  uint32_t panorama = 0;
  float fov = 0.0f, eye = 0.0f, convergence = 0.0f;

  // Returns whether the film closes on itself horizontally.
  bool is_all_around() const {
    return type == GRADUS_CAMERA_PANORAMA &&
           (panorama == GRADUS_PANORAMA_EQUIRECTANGULAR || panorama == GRADUS_PANORAMA_CYLINDER) &&
           window[1] - window[0] >= kTurn;
  }
};

constexpr uint32_t kPerspective = GRADUS_CAMERA_PERSPECTIVE, kPanorama = GRADUS_CAMERA_PANORAMA;
constexpr float kHalf = kTurn / 2, kQuarter = kTurn / 4, kEighth = kTurn / 8;
constexpr CameraType kCameras[] = {
    {"Perspective", kPerspective, {-0.9f, 0.9f, -0.6f, 0.6f}},
    {"PerspectiveLeft", kPerspective, {-0.9f, 0.9f, -0.6f, 0.6f}, 0, 0.0f, -kEye, 2.0f},
    {"PerspectiveRight", kPerspective, {-0.9f, 0.9f, -0.6f, 0.6f}, 0, 0.0f, kEye, 2.0f},
    {"Orthographic", GRADUS_CAMERA_ORTHOGRAPHIC, {-1.5f, 1.5f, -1.0f, 1.0f}},
    {"Equirectangular", kPanorama, {-kHalf, kHalf, -kQuarter, kQuarter}, GRADUS_PANORAMA_EQUIRECTANGULAR},
    {"EquirectangularLeft",
     kPanorama,
     {-kHalf, kHalf, -kQuarter, kQuarter},
     GRADUS_PANORAMA_EQUIRECTANGULAR,
     0.0f,
     -kEye,
     2.0f},
    {"EquirectangularRight",
     kPanorama,
     {-kHalf, kHalf, -kQuarter, kQuarter},
     GRADUS_PANORAMA_EQUIRECTANGULAR,
     0.0f,
     kEye},
    {"EquirectangularPart", kPanorama, {2.0f, 4.5f, -0.5f, 1.2f}, GRADUS_PANORAMA_EQUIRECTANGULAR},
    {"CubeFace", kPanorama, {-kEighth, kEighth, -kEighth, kEighth}, GRADUS_PANORAMA_CUBE_FACE},
    {"MirrorBall", kPanorama, {-1.5f, 1.5f, -1.0f, 1.0f}, GRADUS_PANORAMA_MIRROR_BALL},
    {"Equidistant", kPanorama, {-2.3f, 2.3f, -1.53f, 1.53f}, GRADUS_PANORAMA_FISHEYE_EQUIDISTANT, 2.8f},
    {"EquidistantRight", kPanorama, {-2.3f, 2.3f, -1.53f, 1.53f}, GRADUS_PANORAMA_FISHEYE_EQUIDISTANT, 2.8f, kEye},
    {"Equisolid", kPanorama, {-1.2f, 1.2f, -0.8f, 0.8f}, GRADUS_PANORAMA_FISHEYE_EQUISOLID, 3.0f},
    {"Polynomial", kPanorama, {-18.0f, 18.0f, -12.0f, 12.0f}, GRADUS_PANORAMA_FISHEYE_POLYNOMIAL, 2.5f},
    {"Cylinder", kPanorama, {-kHalf, kHalf, -1.5f, 1.5f}, GRADUS_PANORAMA_CYLINDER},
};

enum class Change { None, Move, Zoom, Blur };
constexpr const char* kChanges[] = {"Rests", "Moves", "Zooms", "BlursAsItMoves"};

struct Case {
  CameraType camera;
  Change change;
  bool in_room;
};

std::vector<Case> all_cases() {
  std::vector<Case> cases;
  for (const CameraType& camera : kCameras) {
    for (const Change change : {Change::None, Change::Move, Change::Zoom, Change::Blur}) {
      for (const bool in_room : {true, false}) cases.push_back({camera, change, in_room});
    }
  }
  return cases;
}

GradusCamera camera_of(const CameraType& type, const Mat4& pose, float zoom) {
  GradusCamera camera{};
  camera.struct_size = sizeof(camera);
  camera.type = type.type;
  camera.panorama = type.panorama;
  camera.fisheye_fov = type.fov;
  const float lens[5] = {-1.17e-5f, -0.12f, -3.3525e-6f, 3.0993e-6f, -2.61e-8f};
  std::copy_n(lens, 5, camera.fisheye_polynomial);
  camera.eye_offset = type.eye;
  camera.convergence_distance = type.convergence;
  camera.pole_merge_from = 1.0f;
  camera.pole_merge_to = type.panorama == GRADUS_PANORAMA_EQUIRECTANGULAR ? 1.4f : 0.0f;
  float window[4];
  for (int k = 0; k < 4; ++k) {
    const bool is_a_turn = type.is_all_around() && k < 2;
    window[k] = type.window[k] / (is_a_turn ? 1.0f : zoom);
  }
  set_static(&camera, window, pose);
  camera.clip_start = 1e-3f;
  camera.clip_end = 1e5f;
  return camera;
}

// World-space rays of the pixel centres of a static camera.
class TestFilm {
 public:
  TestFilm(const GradusCamera& desc, bool wraps) : wraps_(wraps) {
    const camera::Camera camera(desc, kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) rays_.push_back(camera.ray({Vec2(float(x) + 0.5f, float(y) + 0.5f)}));
    }
  }
  bool sees(size_t pixel) const { return !is_none(rays_[pixel]); }
  // Returns the point that a pixel shows on a sphere around the world's origin.
  Vec3 point(size_t pixel, float radius) const {
    const Ray& ray = rays_[pixel];
    const float middle = glm::dot(ray.origin, ray.direction);
    return ray.origin +
           ray.direction * (std::sqrt(middle * middle + radius * radius - glm::dot(ray.origin, ray.origin)) - middle);
  }
  // Returns the pixel whose ray has the smallest angle to the point.
  int nearest(const Vec3& point) const {
    int best = -1;
    float minimum = kInfinity;
    for (size_t j = 0; j < rays_.size(); ++j) {
      if (!sees(j)) continue;
      const float away = glm::length(glm::normalize(point - rays_[j].origin) - rays_[j].direction);
      if (away < minimum) minimum = away, best = int(j);
    }
    return best;
  }
  // Returns the distance in x or in y, whichever is larger.
  int pixels_between(int a, int b) const {
    const int x = std::abs(a % kWidth - b % kWidth);
    return std::max(wraps_ ? std::min(x, kWidth - x) : x, std::abs(a / kWidth - b / kWidth));
  }
  // Returns whether all neighbouring pixels have rays. At the rim, the nearest ray may lie outside of the film.
  bool is_inside(int pixel) const {
    const int y = pixel / kWidth;
    if (y == 0 || y == kHeight - 1) return false;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const int x = pixel % kWidth + dx;
        if (!wraps_ && (x < 0 || x >= kWidth)) return false;
        if (!sees(size_t((y + dy) * kWidth + (x + kWidth) % kWidth))) return false;
      }
    }
    return true;
  }

 private:
  bool wraps_;
  std::vector<Ray> rays_;
};

class CorrespondenceOfCameras : public testing::TestWithParam<Case> {
 protected:
  CorrespondenceOfCameras() {
    if (GetParam().in_room) scene_.ball(Vec3(0.0f), kRoom, scene_.material(matte(Rgb(0.5f))), 24);
  }
  // Adds a frame. If it is blurred, the shutter opens at the pose and closes elsewhere; the middle of the exposure has
  // the pose half way between.
  void add_frame(const Mat4& pose, float zoom, bool is_blurred) {
    const auto shifted = [](float x) { return translation(Vec3(x, 0.5f * x, 0.0f)); };
    films_.emplace_back(camera_of(GetParam().camera, is_blurred ? shifted(0.15f) * pose : pose, zoom),
                        GetParam().camera.is_all_around());
    GradusCamera camera = camera_of(GetParam().camera, pose, zoom);
    const Mat4 keys[2] = {pose, shifted(0.3f) * pose};
    if (is_blurred) {
      camera.aperture_radius = 0.2f;
      camera.shutter_open = -0.25f;
      camera.shutter_close = 0.25f;
      camera.shutter_key_count = 2;
      camera.shutter_matrices = &keys[0][0][0];
    }
    scene_.scene.scene.set_camera(camera);
    snapshots_.push_back(scene_.scene.commit());
    views_.push_back(motion::view_centres(*snapshots_.back(), kWidth, kHeight, Region{0, 0, kWidth, kHeight}));
  }

  PathScene scene_;
  std::vector<std::shared_ptr<const scene::Snapshot>> snapshots_;
  std::vector<motion::CentreView> views_;
  std::vector<TestFilm> films_;
};

TEST_P(CorrespondenceOfCameras, LeadToThePixelThatShowsTheSamePoint) {
  const auto& [type, change, in_room] = GetParam();
  const Mat4 pose = glm::rotate(translation(Vec3(0.2f, -0.1f, 0.3f)), 0.4f, glm::normalize(Vec3(0.2f, 1.0f, 0.1f)));
  const Mat4 step =
      glm::rotate(translation(Vec3(0.11f, -0.05f, -0.07f)), 0.13f, glm::normalize(Vec3(0.1f, 1.0f, 0.2f)));
  const bool moves = change == Change::Move || change == Change::Blur;
  add_frame(pose, 1.0f, change == Change::Blur);
  add_frame(moves ? step * pose : pose, change == Change::Zoom ? 1.12f : 1.0f, change == Change::Blur);
  const std::vector<int32_t> correspondence = motion::match_pixels(views_[0], views_[1]).pixel;
  const bool is_static_at_infinity = type.type == GRADUS_CAMERA_ORTHOGRAPHIC && !in_room;
  std::set<int> wanted;  // pixels that several others correspond to
  int linked = 0, astray = 0, reached = 0;
  for (size_t i = 0; i < correspondence.size(); ++i) {
    if (!films_[0].sees(i)) {
      EXPECT_EQ(correspondence[i], film::kNoCorrespondence) << "beyond the image circle: " << i;
      continue;
    }
    const int expected =
        is_static_at_infinity ? int(i) : films_[1].nearest(films_[0].point(i, in_room ? kRoom : kFarAway));
    if (correspondence[i] != film::kNoCorrespondence) {
      ++linked;
      astray += films_[1].pixels_between(correspondence[i], expected) > 1 ? 1 : 0;
      if (change == Change::None) {
        EXPECT_EQ(correspondence[i], int32_t(i));
      }
    }
    if (films_[1].is_inside(expected)) {
      wanted.insert(expected);
      reached += correspondence[i] != film::kNoCorrespondence ? 1 : 0;
    }
  }
  const bool has_steep_rim = type.type == kPanorama && type.panorama == GRADUS_PANORAMA_MIRROR_BALL;
  EXPECT_LE(astray, has_steep_rim ? linked / 40 : 0) << "of " << linked;
  EXPECT_GT(wanted.size(), 450u);
  EXPECT_GE(reached, int(0.98 * double(wanted.size()))) << "of " << wanted.size();
}

INSTANTIATE_TEST_SUITE_P(All, CorrespondenceOfCameras, testing::ValuesIn(all_cases()), [](const auto& info) {
  return std::string(info.param.camera.name) + kChanges[int(info.param.change)] +
         (info.param.in_room ? "InARoom" : "UnderTheSky");
});

}  // namespace
}  // namespace gradus::test::camera_correspondence_test
