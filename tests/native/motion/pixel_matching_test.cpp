// Pixel correspondences: known motions in pixels, one-to-one, and none for objects that are not found again.
#include "motion/pixel_matching.h"

#include <set>

#include <gtest/gtest.h>

#include "support/path_scene.h"

namespace gradus::test::pixel_matching_test {
namespace {

constexpr int kSize = 32;  // pixels of a side, over 4 m
constexpr float kPixel = 4.0f / kSize;

// A square of 1 m before a wall, seen by an orthographic camera. The square is the last instance.
class CorrespondingFrames : public testing::Test {
 protected:
  CorrespondingFrames() {
    const uint64_t grey = scene_.material(matte(Rgb(0.5f)));
    scene_.quad(Vec3(-1.75f, -4, -1), Vec3(8, 0, 0), Vec3(0, 8, 0), grey);  // leaves a strip of sky
    scene_.quad(Vec3(-0.5f, -0.5f, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), grey);
    look_from(Vec3(0, 0, 3));
  }
  void look_from(const Vec3& from) { scene_.camera(from, from - Vec3(0, 0, 1), 4.0f, GRADUS_CAMERA_ORTHOGRAPHIC); }
  // Returns the scene as built so far, as a frame.
  motion::CentreView* view() {
    frames_.push_back(std::make_unique<integrator::IntegratorContext>(scene_.context(test_settings(kSize, kSize))));
    const integrator::IntegratorContext& c = *frames_.back();
    views_.push_back(std::make_unique<motion::CentreView>(
        motion::view_centres(*c.snapshot, kSize, kSize, Region{0, 0, kSize, kSize})));
    return views_.back().get();
  }
  static std::vector<int32_t> correspondence(const motion::CentreView* from, const motion::CentreView* to) {
    const film::PixelCorrespondence correspondence = motion::match_pixels(*from, *to);
    const std::vector<int32_t>& found = correspondence.pixel;
    std::set<int32_t> taken;
    for (const int32_t target : found) {
      EXPECT_TRUE(target == film::kNoCorrespondence || taken.insert(target).second) << "two pixels lead to " << target;
    }
    const std::vector<int32_t> inverse = motion::inverse_correspondence(correspondence).pixel;
    for (size_t i = 0; i < found.size(); ++i) {
      EXPECT_TRUE(found[i] == film::kNoCorrespondence || inverse[size_t(found[i])] == int32_t(i));
    }
    return found;
  }
  static int32_t pixel(int x, int y) { return y * kSize + x; }
  static bool in_square(int x, int y) { return x >= 12 && x < 20 && y >= 12 && y < 20; }

  PathScene scene_;
  std::vector<std::unique_ptr<integrator::IntegratorContext>> frames_;
  std::vector<std::unique_ptr<motion::CentreView>> views_;
};

TEST_F(CorrespondingFrames, ACancelledViewTracesNothing) {
  const integrator::IntegratorContext c = scene_.context(test_settings(kSize, kSize));
  int traced = 0;
  const motion::CentreView cancelled =
      motion::view_centres(*c.snapshot, kSize, kSize, Region{0, 0, kSize, kSize}, [] { return true; });
  for (const geometry::Hit& hit : cancelled.hits) traced += hit.valid() ? 1 : 0;
  EXPECT_EQ(traced, 0);
}

TEST_F(CorrespondingFrames, StaticPixelsCorrespondToThemselves) {
  const std::vector<int32_t> found = correspondence(view(), view());
  for (size_t i = 0; i < found.size(); ++i) EXPECT_EQ(found[i], int32_t(i));
}

TEST_F(CorrespondingFrames, APannedCameraShiftsAll) {
  const motion::CentreView* from = view();
  look_from(Vec3(3 * kPixel, -2 * kPixel, 3));
  const std::vector<int32_t> found = correspondence(from, view());
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const bool sky = x < 2, stays = x >= 3 && y + 2 < kSize;
      if (!sky) {
        EXPECT_EQ(found[size_t(pixel(x, y))], stays ? pixel(x - 3, y + 2) : film::kNoCorrespondence) << x << ' ' << y;
      }
    }
}

TEST_F(CorrespondingFrames, KeepTheEndsOfDisplacementsInBothDirections) {
  const motion::CentreView* from = view();
  look_from(Vec3(3.25f * kPixel, -1.5f * kPixel, 3));
  const film::PixelCorrespondence correspondence = motion::match_pixels(*from, *view()),
                                  inverse = motion::inverse_correspondence(correspondence);
  int linked = 0;
  for (size_t i = 0; i < correspondence.pixel.size(); ++i) {
    if (correspondence.pixel[i] == film::kNoCorrespondence || !from->hits[i].valid()) continue;
    ++linked;
    EXPECT_EQ(correspondence.off_centre[i].x, -0.25f);
    EXPECT_EQ(std::abs(correspondence.off_centre[i].y), 0.5f);
    EXPECT_EQ(inverse.off_centre[size_t(correspondence.pixel[i])], correspondence.off_centre[i]);
  }
  EXPECT_GT(linked, kSize * kSize / 2);
}

TEST_F(CorrespondingFrames, AMovingObjectMovesItsPixels) {
  const motion::CentreView* from = view();
  scene_.scene.move(1, translation(Vec3(4 * kPixel, 0, 0)));
  const motion::CentreView* to = view();
  const std::vector<int32_t> found = correspondence(from, to);
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const bool covered = !in_square(x, y) && in_square(x - 4, y);
      const int32_t expected = in_square(x, y) ? pixel(x + 4, y) : covered ? film::kNoCorrespondence : pixel(x, y);
      EXPECT_EQ(found[size_t(pixel(x, y))], expected) << x << ' ' << y;
    }
  // Disoccluded pixels have no correspondence.
  const std::vector<int32_t> inverse = motion::inverse_correspondence({found}).pixel;
  for (int x = 12; x < 16; ++x) EXPECT_EQ(inverse[size_t(pixel(x, 15))], film::kNoCorrespondence);
}

TEST_F(CorrespondingFrames, AnObjectThatVanishesOrBecomesAnotherMeshHasNoPartner) {
  const motion::CentreView* from = view();
  scene_.scene.mesh(77, sphere(Vec3(0.0f), 0.5f, 8, 16));
  scene_.scene.replace_mesh(1, 77);
  const motion::CentreView* changed = view();
  scene_.scene.remove_last();
  const motion::CentreView* gone = view();
  for (const motion::CentreView* to : {changed, gone}) {
    const std::vector<int32_t> found = correspondence(from, to);
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x)
        EXPECT_EQ(found[size_t(pixel(x, y))], in_square(x, y) ? film::kNoCorrespondence : pixel(x, y));
  }
}

// The wall behind leads to its new pixels, and nothing leads back.
TEST_F(CorrespondingFrames, AnObjectThatAppearsHasNoPartner) {
  const motion::CentreView* there = view();
  scene_.scene.remove_last();
  const std::vector<int32_t> found = correspondence(view(), there);
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x)
      EXPECT_EQ(found[size_t(pixel(x, y))], in_square(x, y) ? film::kNoCorrespondence : pixel(x, y));
}

// If several pixels move to one, the nearest is kept: a square that shrinks to half its size.
TEST_F(CorrespondingFrames, ShrinkingIsOneToOne) {
  const motion::CentreView* from = view();
  scene_.scene.move(1, scaling(Vec3(0.5f)));
  const std::vector<int32_t> found = correspondence(from, view());
  int linked = 0;
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) linked += in_square(x, y) && found[size_t(pixel(x, y))] != film::kNoCorrespondence;
  EXPECT_EQ(linked, 16);
}

// A step of one pixel: what the square covers lies within a pixel of its old position, and leads to the same pixels.
TEST_F(CorrespondingFrames, OfTwoThatMeetInAPixelTheNearestHasIt) {
  const motion::CentreView* from = view();
  scene_.scene.move(1, translation(Vec3(kPixel, 0, 0)));
  const std::vector<int32_t> found = correspondence(from, view());
  for (int y = 12; y < 20; ++y) {
    for (int x = 12; x < 20; ++x) EXPECT_EQ(found[size_t(pixel(x, y))], pixel(x + 1, y)) << x << ' ' << y;
    EXPECT_EQ(found[size_t(pixel(20, y))], film::kNoCorrespondence) << "the wall that it covers";
  }
}

TEST_F(CorrespondingFrames, C8_AShotChangeIsNoMotion) {
  const GradusCamera camera = view()->snapshot->camera;
  GradusCamera turned = camera, zoomed = camera, other = camera;
  turned.matrix[8] = 0.6f, turned.matrix[10] = 0.8f;
  zoomed.window[1] *= 3.0f;
  other.type = GRADUS_CAMERA_PERSPECTIVE;
  EXPECT_FALSE(motion::is_shot_change(camera, camera));
  EXPECT_TRUE(motion::is_shot_change(camera, turned));
  EXPECT_TRUE(motion::is_shot_change(camera, zoomed));
  EXPECT_TRUE(motion::is_shot_change(camera, other));
}

}  // namespace
}  // namespace gradus::test::pixel_matching_test
