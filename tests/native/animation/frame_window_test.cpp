// Rows of the system of a window, which are computed from sampled frames and their correspondences.
#include "animation/frame_window.h"

#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <random>

#include <gtest/gtest.h>

#include "animation/spooled_frames.h"
#include "base/error.h"
#include "support/refusal.h"

namespace gradus::frame_window_test {
namespace {

// Returns a row of three pixels, equal in all channels: values, differences to the right, and half the differences
// between the half-buffers of both.
film::GradientImages row_of(const std::vector<float>& primal, const std::vector<float>& dx) {
  film::GradientImages images;
  images.width = 3;
  images.height = 1;
  for (const float v : primal) images.primal.insert(images.primal.end(), 3, v);
  for (const float v : dx) images.dx.insert(images.dx.end(), 3, v);
  images.dy.assign(9, 0.0f);
  return images;
}

class TwoFrames : public testing::Test {
 protected:
  TwoFrames() {
    auto first = std::make_shared<animation::TemporalFrame>(), second = std::make_shared<animation::TemporalFrame>();
    first->fresh = {row_of({1, 2, 3}, {10, 20, 0}), row_of({0.1f, 0.2f, 0.3f}, {1, 2, 0})};
    first->replay = first->fresh;  // a stream of its own for the first frame
    first->replay_share = {0.5f, 0.5f, 0.5f};
    second->fresh = {row_of({4, 5, 6}, {40, film::kAbsentPair, 0}), row_of({0.4f, 0.5f, 0.6f}, {4, 5, 0})};
    second->replay = {row_of({7, 8, 9}, {70, 80, 0}), row_of({0.7f, 0.8f, 0.9f}, {7, 8, 0})};
    second->replay_share = {0.5f, 0.5f, 0.25f};
    second->stream = 1;
    second->replayed = {first->stream, {{film::kNoCorrespondence, 0, 1}}};  // the picture moves to the right by a pixel
    frames_ = {first, second};
  }
  std::vector<float> row(reconstruct::RowKind kind, int t) const {
    std::vector<float> out(9);
    animation::FrameWindow(frames_).read_row(kind, t, 0, out.data());
    return {out[0], out[3], out[6]};
  }
  std::vector<float> half_differences(reconstruct::RowKind kind, int t) const {
    std::vector<float> out(9);
    animation::FrameWindow(frames_).read_half_differences(kind, t, 0, out.data());
    return {out[0], out[3], out[6]};
  }
  std::vector<std::shared_ptr<const animation::TemporalFrame>> frames_;
};

TEST_F(TwoFrames, RowsInSpaceAreMeansOverAllSamples) {
  EXPECT_EQ(row(reconstruct::RowKind::kPrimal, 0), (std::vector<float>{1, 2, 3}));
  EXPECT_EQ(row(reconstruct::RowKind::kPrimal, 1), (std::vector<float>{5.5f, 6.5f, 6.75f}));
  EXPECT_EQ(row(reconstruct::RowKind::kDx, 1)[0], 55.0f);
  EXPECT_EQ(row(reconstruct::RowKind::kDx, 1)[1], 80.0f) << "what one of the two lacks is the other's";
}

TEST_F(TwoFrames, RowsInTimeAreDifferencesAlongCorrespondences) {
  const std::vector<float> dt = row(reconstruct::RowKind::kDt, 0), dxdt = row(reconstruct::RowKind::kDxDt, 0);
  EXPECT_EQ(dt[0], 8.0f - 1.0f);
  EXPECT_EQ(dt[1], 9.0f - 2.0f);
  EXPECT_TRUE(std::isnan(dt[2])) << "a pixel without a correspondence has no difference";
  EXPECT_EQ(dxdt[0], 80.0f - 10.0f);
}

// Fresh and replayed samples use the same random numbers: their half-buffers differ alike, and the difference over time
// has less variance than either.
TEST_F(TwoFrames, HalfDifferencesAreThoseOfTheRows) {
  EXPECT_NEAR(half_differences(reconstruct::RowKind::kDt, 0)[1], 0.9f - 0.2f, 1e-6f);
  EXPECT_TRUE(std::isnan(half_differences(reconstruct::RowKind::kDt, 0)[2]));
}

film::Film sampled(int32_t number, uint32_t seed, int width = 20) {
  film::Film frame(uint32_t(width), 8, {0, 0, width, 8}, 4, 1, true);
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  const auto fill = [&](std::vector<Radiance>* plane) {
    for (Radiance& value : *plane) value = {uniform(random), uniform(random), uniform(random), uniform(random)};
  };
  for (int half = 0; half < film::kHalves; ++half) {
    fill(&frame.components[0].primal[half]);
    for (auto& plane : frame.components[0].gradient[half]) fill(&plane);
    for (uint32_t& count : frame.count[half]) count = uint32_t(random() % 3);
    for (auto& plane : frame.pair_count[half]) {
      for (float& count : plane) count = float(random() % 3);
    }
  }
  frame.frame_number = number;
  return frame;
}

// Five frames, of which the fourth equals the third. Each frame replays the one before, except for one pixel without a
// correspondence.
class FiveFrames : public testing::Test {
 protected:
  FiveFrames() {
    for (int place = 0; place < 5; ++place) {
      const int own = place == 3 ? 2 : place;
      fresh_.push_back(std::make_shared<film::Film>(sampled(own, uint32_t(own))));
      auto replay = std::make_shared<film::Film>(sampled(own, uint32_t(10 + own)));
      replay->replayed.stream_frame = place == 4 ? 2 : own - 1;
      for (int i = 0; i < 160; ++i)
        replay->replayed.correspondence.pixel.push_back(i == 7 ? film::kNoCorrespondence : (i + 3) % 160);
      replay_.push_back(std::move(replay));
    }
  }
  std::unique_ptr<reconstruct::HalvedWindowSource> spooled() const {
    return animation::SpooledFrames(load(fresh_), load(replay_), {}).window(0, 4);
  }
  // Returns the bits of all rows; absent differences are NaN.
  static std::vector<unsigned char> bits(const reconstruct::HalvedWindowSource& source, int t, bool is_last) {
    const auto [width, height, channels, frames] = source.size();
    std::vector<unsigned char> all;
    const auto add = [&](const void* row, size_t bytes) {
      all.insert(all.end(), static_cast<const unsigned char*>(row), static_cast<const unsigned char*>(row) + bytes);
    };
    std::vector<float> row(size_t(width) * size_t(channels));
    std::vector<int32_t> correspondence(static_cast<size_t>(width));
    for (int y = 0; y < height; ++y) {
      for (const reconstruct::RowKind kind : reconstruct::kRowKinds) {
        if (is_last && reconstruct::is_temporal(kind)) continue;
        source.read_row(kind, t, y, row.data());
        add(row.data(), row.size() * sizeof(float));
        source.read_half_differences(kind, t, y, row.data());
        add(row.data(), row.size() * sizeof(float));
      }
      if (is_last) continue;
      source.read_correspondence(t, y, correspondence.data());
      add(correspondence.data(), correspondence.size() * sizeof(int32_t));
    }
    return all;
  }
  static animation::LoadSamples load(const std::vector<std::shared_ptr<film::Film>>& frames) {
    return [&](int place, const CancelCheck&) { return std::make_shared<film::Film>(*frames[size_t(place)]); };
  }
  animation::FrameWindow in_memory() const {
    std::vector<std::shared_ptr<const animation::TemporalFrame>> frames;
    for (size_t t = 0; t < 5; ++t)
      frames.push_back(
          std::make_shared<animation::TemporalFrame>(animation::make_temporal_frame(*fresh_[t], *replay_[t])));
    return animation::FrameWindow(std::move(frames));
  }
  std::vector<std::shared_ptr<film::Film>> fresh_, replay_;
};

// All samples of a pixel have the same weight, fresh or replayed.
TEST_F(FiveFrames, SharesAreThoseOfTheSamples) {
  const film::Film &fresh = *fresh_[1], &replay = *replay_[1];
  const animation::TemporalFrame frame = animation::make_temporal_frame(fresh, replay);
  for (size_t i = 0; i < frame.replay_share.size(); ++i) {
    const uint32_t own = film::samples_at(fresh, i), other = film::samples_at(replay, i);
    EXPECT_NEAR(frame.replay_share[i] * float(own + other), float(other), 1e-5f) << own << ' ' << other;
  }
}

TEST_F(FiveFrames, SpooledRowsAreThoseOfTheFramesInMemory) {
  const animation::FrameWindow whole = in_memory();
  const auto spooled = this->spooled();
  EXPECT_EQ(spooled->size().frames, 5);
  for (int t = 0; t < 5; ++t) EXPECT_EQ(bits(*spooled, t, t == 4), bits(whole, t, t == 4)) << t;
}

// Regression: data that overlapping windows share was read for each of them.
TEST_F(FiveFrames, OverlappingWindowsReadEachFrameOnce) {
  const animation::FrameWindow whole = in_memory();
  std::array<int, 5> bases{}, replays{};
  const auto counted = [](const animation::LoadSamples& load, std::array<int, 5>* loads) {
    return [load, loads](int place, const CancelCheck& cancel) {
      ++loads->at(size_t(place));
      return load(place, cancel);
    };
  };
  animation::SpooledFrames frames(counted(load(fresh_), &bases), counted(load(replay_), &replays), {});
  for (const auto& [first, last] : {std::pair(0, 2), {1, 3}, {2, 4}}) {
    const auto window = frames.window(first, last);
    for (int t = first; t <= last; ++t)
      EXPECT_EQ(bits(*window, t - first, t == last), bits(whole, t, t == last)) << first << ", " << t;
  }
  for (size_t t = 0; t < 5; ++t) {
    EXPECT_EQ(bases[t], 1) << t;
    EXPECT_EQ(replays[t], 1) << t;
  }
}

// Regression: a cancel was noticed only between two frames, although the rows of each are written and read several
// times for their weights.
TEST_F(FiveFrames, K2_ACancelIsNoticedAtEveryRow) {
  std::atomic<int> requested{0};
  std::atomic<bool> is_cancelled{false};
  const auto window = animation::SpooledFrames(load(fresh_), load(replay_), {}).window(0, 4, [&] {
    ++requested;
    return is_cancelled.load();
  });
  EXPECT_GE(requested, 9 * 8) << "rows of five frames and of their differences";
  std::vector<float> row(20 * 4);
  std::vector<int32_t> correspondence(20);
  EXPECT_NO_THROW(window->read_row(reconstruct::RowKind::kPrimal, 0, 0, row.data()));
  is_cancelled = true;
  EXPECT_THROW(window->read_row(reconstruct::RowKind::kPrimal, 0, 0, row.data()), Error);
  EXPECT_THROW(window->read_half_differences(reconstruct::RowKind::kPrimal, 0, 0, row.data()), Error);
  EXPECT_THROW(window->read_correspondence(0, 0, correspondence.data()), Error);
}

TEST_F(FiveFrames, TheNoiseOfRowsIsMadeWhereRequested) {
  const auto window = animation::SpooledFrames(load(fresh_), load(replay_), {.halves = false}).window(0, 4);
  std::vector<float> row(20 * 4);
  EXPECT_NO_THROW(window->read_row(reconstruct::RowKind::kDxDt, 0, 0, row.data()));
  EXPECT_THROW(window->read_half_differences(reconstruct::RowKind::kPrimal, 0, 0, row.data()), Error);
}

TEST_F(FiveFrames, CorrespondencesAreThoseThatTheNextFrameReplayed) {
  const auto window = spooled();
  std::vector<int32_t> correspondence(20);
  window->read_correspondence(0, 0, correspondence.data());
  EXPECT_EQ(correspondence[3], 0);
  EXPECT_EQ(correspondence[10], film::kNoCorrespondence) << "no frame replays it";
  window->read_correspondence(2, 0, correspondence.data());
  EXPECT_EQ(correspondence[10], 10) << "the same frame again";
  window->read_correspondence(3, 0, correspondence.data());
  EXPECT_EQ(correspondence[3], 0);
}

TEST_F(FiveFrames, AFrameOfAnotherSizeOrWithoutGradientsIsNamed) {
  const auto refusal = [&] { return test::refusal_of([&] { spooled(); }); };
  replay_[4] = std::make_shared<film::Film>(sampled(4, 1, 21));
  EXPECT_EQ(refusal(), "stored frame 4 has another size or other planes than those beside it");
  fresh_[1] = std::make_shared<film::Film>(sampled(1, 1, 21));
  EXPECT_EQ(refusal().find("stored frame 1 has another size"), 0u);
  fresh_[0]->gradients = false;
  EXPECT_EQ(refusal().find("stored frame 0 has another size or other planes"), 0u);
}

// Regression: for plain paths, differences in space were read beyond the end of the data.
TEST_F(FiveFrames, WithoutGradientsThereArePixelsAndTheirDifferencesOverTime) {
  for (const auto& frames : {fresh_, replay_}) {
    for (const auto& frame : frames) frame->gradients = false;
  }
  const auto window = spooled();
  std::vector<float> row(20 * 4);
  EXPECT_NO_THROW(window->read_row(reconstruct::RowKind::kPrimal, 4, 7, row.data()));
  EXPECT_NO_THROW(window->read_half_differences(reconstruct::RowKind::kDt, 3, 7, row.data()));
  for (const reconstruct::RowKind kind : {reconstruct::RowKind::kDx, reconstruct::RowKind::kDy,
                                          reconstruct::RowKind::kDxDt, reconstruct::RowKind::kDyDt}) {
    EXPECT_THROW(window->read_row(kind, 0, 0, row.data()), Error);
  }
}

}  // namespace
}  // namespace gradus::frame_window_test
