// Where the pixels of another frame lie in a picture.
#include "reconstruct/space_time/pixel_track.h"

#include <cmath>
#include <optional>

#include <gtest/gtest.h>

namespace gradus::pixel_track_test {
namespace {

constexpr int kWidth = 24, kHeight = 18;

size_t index_of(int x, int y) { return size_t(y) * kWidth + size_t(x); }

// Returns a picture whose columns from `kEdge` on show another surface than those before. 0 is the distance of the sky.
constexpr int kEdge = 12;
reconstruct::FrameRecords picture(float distance, float from_edge_on) {
  reconstruct::FrameRecords frame;
  frame.width = kWidth;
  frame.height = kHeight;
  frame.pixels.resize(size_t(kWidth) * kHeight);
  for (size_t i = 0; i < frame.pixels.size(); ++i)
    frame.pixels[i].values[reconstruct::kRecordDepth] = int(i % kWidth) < kEdge ? distance : from_edge_on;
  return frame;
}

// Extends a track of a picture that shows one surface.
reconstruct::PixelTrack extended(const reconstruct::PixelTrack& track,
                                 const film::PixelCorrespondence& correspondence) {
  return reconstruct::extended(track, correspondence, picture(2.0f, 2.0f));
}

// Returns the correspondence to the frame before of a picture that moves by (dx, dy) pixels from one frame to the next.
film::PixelCorrespondence panned(float dx, float dy) {
  film::PixelCorrespondence correspondence;
  const float right = std::round(dx), up = std::round(dy);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const int before_x = x - int(right), before_y = y - int(up);
      const bool inside = before_x >= 0 && before_x < kWidth && before_y >= 0 && before_y < kHeight;
      correspondence.pixel.push_back(inside ? int32_t(index_of(before_x, before_y)) : film::kNoCorrespondence);
      correspondence.off_centre.push_back({dx - right, dy - up});
    }
  }
  return correspondence;
}

// Expects that each pixel holds the one of the other frame whose centre, moved by (dx, dy), lies in it, and its exact
// place. Pixels within `border` of the border of the picture may hold none.
void expect_pan(const reconstruct::PixelTrack& track, float dx, float dy, int border) {
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const int32_t source = track.source[index_of(x, y)];
      if (source == film::kNoCorrespondence) {
        EXPECT_TRUE(x < border || y < border || x >= kWidth - border || y >= kHeight - border) << x << ' ' << y;
        continue;
      }
      const Vec2& d = track.displacement[index_of(x, y)];
      EXPECT_NEAR(float(x) + d.x, float(source % kWidth) + dx, 1e-4f) << x << ' ' << y;
      EXPECT_NEAR(float(y) + d.y, float(source / kWidth) + dy, 1e-4f) << x << ' ' << y;
      EXPECT_LE(std::max(std::fabs(d.x), std::fabs(d.y)), 0.5f + 1e-4f);
    }
  }
}

constexpr Vec2 kPans[] = {{0.0f, 0.0f}, {0.3f, 0.0f}, {0.375f, -0.2f}, {-0.45f, 0.45f}, {1.0f, 0.0f}, {-1.3f, 0.7f}};
constexpr int kFrames = 4;

TEST(B2_PixelTrack, OwnPixelsLieAtTheirCentres) {
  const reconstruct::PixelTrack track = reconstruct::own_pixels(kWidth, kHeight);
  for (size_t i = 0; i < track.source.size(); ++i) {
    EXPECT_EQ(track.source[i], int32_t(i));
    EXPECT_EQ(track.displacement[i].x, 0.0f);
    EXPECT_EQ(track.displacement[i].y, 0.0f);
  }
}

// Fractions of a pixel add up over frames and are neither rounded nor lost, in both directions of time.
TEST(B2_PixelTrack, APanIsFollowedExactlyBothWays) {
  for (const Vec2& pan : kPans) {
    const film::PixelCorrespondence step = panned(pan.x, pan.y);
    reconstruct::PixelTrack to_earlier = reconstruct::own_pixels(kWidth, kHeight), to_later = to_earlier;
    for (int frames = 1; frames <= kFrames; ++frames) {
      to_earlier = extended(to_earlier, step);
      to_later = extended(to_later, reconstruct::inverse(step));
      const auto moved = float(frames);
      const int border = int(std::ceil(moved * std::max(std::fabs(pan.x), std::fabs(pan.y)))) + 1;
      expect_pan(to_earlier, moved * pan.x, moved * pan.y, border);
      expect_pan(to_later, -moved * pan.x, -moved * pan.y, border);
    }
  }
}

// A pan that is taken back leads to the centres again.
TEST(B2_PixelTrack, LeadsThereAndBack) {
  const film::PixelCorrespondence step = panned(0.375f, -0.25f);
  reconstruct::PixelTrack track = reconstruct::own_pixels(kWidth, kHeight);
  for (int frames = 0; frames < kFrames; ++frames) track = extended(track, step);
  for (int frames = 0; frames < kFrames; ++frames) track = extended(track, reconstruct::inverse(step));
  for (int y = kFrames; y < kHeight - kFrames; ++y) {
    for (int x = kFrames; x < kWidth - kFrames; ++x) {
      EXPECT_EQ(track.source[index_of(x, y)], int32_t(index_of(x, y)));
      EXPECT_NEAR(track.displacement[index_of(x, y)].x, 0.0f, 1e-5f);
      EXPECT_NEAR(track.displacement[index_of(x, y)].y, 0.0f, 1e-5f);
    }
  }
}

// Correspondences without places end at the centres of pixels.
TEST(B2_PixelTrack, WithoutPlacesMotionIsByWholePixels) {
  film::PixelCorrespondence step = panned(2.0f, -1.0f);
  step.off_centre.clear();
  expect_pan(extended(reconstruct::own_pixels(kWidth, kHeight), step), 2.0f, -1.0f, 2);
  expect_pan(extended(reconstruct::own_pixels(kWidth, kHeight), reconstruct::inverse(step)), -2.0f, 1.0f, 2);
}

TEST(B2_PixelTrack, PixelsWithoutACorrespondenceHoldNone) {
  film::PixelCorrespondence step = panned(0.0f, 0.0f);
  const auto lost = index_of(7, 5);
  step.pixel[lost] = film::kNoCorrespondence;
  const reconstruct::PixelTrack own = reconstruct::own_pixels(kWidth, kHeight);
  for (const reconstruct::PixelTrack& track : {extended(own, step), extended(own, reconstruct::inverse(step))}) {
    for (size_t i = 0; i < track.source.size(); ++i)
      EXPECT_EQ(track.source[i], i == lost ? film::kNoCorrespondence : int32_t(i));
  }
  for (const reconstruct::PixelTrack& track :
       {extended(own, {std::vector<int32_t>(own.source.size(), film::kNoCorrespondence)}), extended(own, {}),
        extended(own, reconstruct::inverse({}))}) {
    for (const int32_t source : track.source) EXPECT_EQ(source, film::kNoCorrespondence);
  }
}

// Where two pixels arrive in one, the nearer one stays, whatever their order.
TEST(B2_PixelTrack, TheNearerOfTwoPixelsStays) {
  const auto target = int32_t(index_of(10, 8));
  for (const bool first_is_nearer : {true, false}) {
    film::PixelCorrespondence step{std::vector<int32_t>(size_t(kWidth) * kHeight, film::kNoCorrespondence),
                                   std::vector<Vec2>(size_t(kWidth) * kHeight)};
    const size_t first = index_of(3, 4), second = index_of(5, 6);
    step.pixel[first] = step.pixel[second] = target;
    step.off_centre[first] = first_is_nearer ? Vec2{0.1f, 0.0f} : Vec2{-0.3f, 0.2f};
    step.off_centre[second] = first_is_nearer ? Vec2{-0.3f, 0.2f} : Vec2{0.1f, 0.0f};
    const reconstruct::PixelTrack track =
        extended(reconstruct::own_pixels(kWidth, kHeight), reconstruct::inverse(step));
    EXPECT_EQ(track.source[size_t(target)], int32_t(first_is_nearer ? first : second));
    EXPECT_NEAR(track.displacement[size_t(target)].x, -0.1f, 1e-6f);
  }
}

// The displacements of two frames carry the pixel on the left into its neighbour, where another one lies nearer.
TEST(B2_PixelTrack, DisplacementsThatAddUpToAPixelMoveToTheNextOne) {
  film::PixelCorrespondence step = panned(0.0f, 0.0f);
  step.off_centre[index_of(9, 8)] = {0.4f, 0.0f};
  reconstruct::PixelTrack track = extended(reconstruct::own_pixels(kWidth, kHeight), step);
  EXPECT_EQ(track.source[index_of(9, 8)], int32_t(index_of(9, 8)));
  EXPECT_NEAR(track.displacement[index_of(9, 8)].x, 0.4f, 1e-6f);
  track = extended(track, step);
  EXPECT_EQ(track.source[index_of(9, 8)], film::kNoCorrespondence);
  EXPECT_EQ(track.source[index_of(10, 8)], int32_t(index_of(10, 8))) << "lies at its centre, the other one at -0.2";
}

// Returns a pan by 0.3 pixels to the right, in which the pixels from the edge on come from `offset` pixels further
// right, or have no correspondence.
film::PixelCorrespondence pan_beside(std::optional<int> offset) {
  film::PixelCorrespondence step = panned(0.3f, 0.0f);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = kEdge; x < kWidth; ++x) {
      const bool inside = offset && x + *offset < kWidth;
      step.pixel[index_of(x, y)] = inside ? int32_t(index_of(x + *offset, y)) : film::kNoCorrespondence;
      step.off_centre[index_of(x, y)] = {};
    }
  }
  return step;
}

// The pan leads the pixel before the edge across it after two frames. The second one shows nothing of what lies there.
bool crosses_the_edge(float distance, float from_edge_on, std::optional<int> offset) {
  const reconstruct::FrameRecords frame = picture(distance, from_edge_on);
  const reconstruct::PixelTrack first =
      reconstruct::extended(reconstruct::own_pixels(kWidth, kHeight), pan_beside(offset), frame);
  const int32_t source =
      reconstruct::extended(first, pan_beside(std::nullopt), frame).source[index_of(kEdge, kHeight / 2)];
  EXPECT_TRUE(source == film::kNoCorrespondence || source == int32_t(index_of(kEdge - 1, kHeight / 2))) << source;
  return source != film::kNoCorrespondence;
}

// A point lies up to a pixel away from the pixel that shows it. There, an object in front may hide it.
TEST(B2_PixelTrack, TheEdgeOfANearerSurfaceThatMovesHidesWhatLiesBehind) {
  for (const float distance : {2.0f, 1e6f, 0.0f}) {
    EXPECT_FALSE(crosses_the_edge(distance, 1.0f, std::nullopt)) << distance << ": has left";
    EXPECT_FALSE(crosses_the_edge(distance, 1.0f, 3)) << distance << ": moves in another way";
    EXPECT_TRUE(crosses_the_edge(distance, 1.0f, 0)) << distance << ": moves in the same way";
  }
  for (const std::optional<int> offset : {std::optional<int>(), std::optional<int>(3)}) {
    EXPECT_TRUE(crosses_the_edge(2.0f, 2.0f, offset)) << "the same surface";
    EXPECT_TRUE(crosses_the_edge(2.0f, 1.99f, offset)) << "an oblique surface";
    EXPECT_TRUE(crosses_the_edge(1.0f, 2.0f, offset)) << "the other surface is the one behind";
    EXPECT_TRUE(crosses_the_edge(1.0f, 0.0f, offset)) << "the sky is behind";
    EXPECT_TRUE(crosses_the_edge(0.0f, 0.0f, offset)) << "the sky alone";
  }
}

}  // namespace
}  // namespace gradus::pixel_track_test
