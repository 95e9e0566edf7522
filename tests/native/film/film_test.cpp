#include "film/film.h"

#include <cstring>
#include <limits>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/error.h"
#include "film/finite_check.h"
#include "film/planes.h"
#include "support/threads.h"

namespace gradus::film_test {
namespace {

film::Film small_film() { return film::Film(4, 3, Region{0, 0, 4, 3}, 3, 1, true); }

std::vector<float> variances(const film::Film& film) {
  const size_t row = size_t(film.region.width()) * size_t(film.color_channels);
  std::vector<float> values(row * size_t(film.region.height()));
  for (int y = 0; y < film.region.height(); ++y) film::read_variance_row(film, y, values.data() + row * size_t(y));
  return values;
}

TEST(B6_FiniteCheck, NonFiniteSamplesStayOutAndAreCounted) {
  film::Film film = small_film();
  film::Counters counters;
  const float bad[] = {std::numeric_limits<float>::quiet_NaN(), kInfinity, -kInfinity};
  for (float value : bad) {
    film::add_gradient(Radiance(1.0f, value, 0.0f, 0.0f), &film.components[0].gradient[0][film::kRight][5], &counters);
    film::add_radiance(Radiance(value, 0.0f, 0.0f, 0.0f), &film.components[0].primal[0][5], &counters);
  }
  EXPECT_EQ(counters.nonfinite_gradient, 3u);
  EXPECT_EQ(counters.nonfinite_radiance, 3u);
  for (const Radiance& value : film.components[0].gradient[0][film::kRight]) {
    EXPECT_EQ(value, Radiance(0.0f));
  }
}

// Regression: samples of 3e38 are finite, but their sum, the mean of both halves and the variance were not.
TEST(B6_FiniteCheck, SumsThatWouldOverflowStayOutAndAreCounted) {
  film::Film film = small_film();
  film::add_pass_channels(uint64_t{1} << GRADUS_PASS_DIFFUSE_COLOR, &film);
  film::Channel* const channel = film.channels.of_pass(GRADUS_PASS_DIFFUSE_COLOR);
  for (int half = 0; half < film::kHalves; ++half) {
    for (const float value : {3e38f, 6e36f, 6e36f}) {
      const std::vector<float> feature(3, value);
      film::add_radiance(Radiance(half == 0 ? value : -value), &film.components[0].primal[half][5], &film.counters);
      film::add_gradient(Radiance(value), &film.components[0].gradient[half][film::kRight][5], &film.counters);
      film::add_feature(feature.data(), 1.0f, 5, half, channel, &film.counters);
      ++film.count[half][5];
    }
  }
  EXPECT_EQ(film.counters.nonfinite_radiance, 4u);
  EXPECT_EQ(film.counters.nonfinite_gradient, 4u);
  EXPECT_EQ(film.counters.nonfinite_feature, 5u);
  EXPECT_EQ(film.components[0].primal[0][5].x, 6e36f);
  EXPECT_TRUE(is_finite(film::read_images(film, 0).primal[15]));
  EXPECT_TRUE(is_finite(variances(film)[15]));
}

TEST(B6_FiniteCheck, ObjectNumbersAreThoseOfTheFirstSample) {
  film::Counters counters;
  film::NonSpecularDetails sum;
  film::add_details({Vec3(0.0f), Rgb(5.0f), 1.0f}, &sum, &counters);  // a light has no object number
  EXPECT_EQ(sum.face, -1.0f);
  for (const auto& [object, sample] : {std::pair{3.0f, 6u}, {4.0f, 2u}, {5.0f, 2u}, {6.0f, 7u}}) {
    film::add_details({Vec3(1.0f), Rgb(1.0f), 1.0f, object, 10.0f * object, sample}, &sum, &counters);
  }
  EXPECT_EQ(sum.object, 4.0f);
  EXPECT_EQ(sum.face, 40.0f);
  EXPECT_EQ(sum.sample, 2u);
  EXPECT_EQ(sum.segments, 5.0f);
  EXPECT_EQ(sum.uv, Vec3(4.0f));
  EXPECT_EQ(sum.emission, Rgb(9.0f));
  film::add_details({Vec3(1.0f), Rgb(kInfinity), 1.0f}, &sum, &counters);
  EXPECT_EQ(sum.emission, Rgb(9.0f));
  EXPECT_EQ(sum.segments, 5.0f);
  EXPECT_EQ(counters.nonfinite_feature, 1u);
}

// Regression: the sums of two films were added without a check.
TEST(B6_FiniteCheck, MergedSumsThatWouldOverflowStayOutAndAreCounted) {
  film::Film film = small_film();
  film.channels.add({"fog", 1, film::ValueType::kData, film::Normalisation::kOwnWeight}, 12);
  film.components[0].primal[1][5].y = 6e36f;
  film.components[0].gradient[0][film::kUp][5].x = -6e36f;
  film.pair_count[0][film::kUp][5] = 6e36f;
  film.channels.find("fog")->values[0][5] = 6e36f;
  film.channels.find("fog")->weight[5] = 2.0f;
  const film::Film other = film;
  film::add_sums(&film, other);
  EXPECT_EQ(film.counters.nonfinite_radiance, 1u);
  EXPECT_EQ(film.counters.nonfinite_gradient, 1u);
  EXPECT_EQ(film.counters.nonfinite_feature, 2u);
  EXPECT_EQ(film.components[0].primal[1][5].y, 6e36f);
  EXPECT_EQ(film.components[0].gradient[0][film::kUp][5].x, -6e36f);
  EXPECT_EQ(film.pair_count[0][film::kUp][5], 6e36f);
  EXPECT_EQ(film.channels.find("fog")->values[0][5], 6e36f);
  EXPECT_EQ(film.channels.find("fog")->weight[5], 4.0f);
}

// Returns a film with planes of all kinds, of more pixels than one task merges.
film::Film full_film() {
  const Region region{0, 0, 97, 61};
  const auto pixels = size_t(region.area());
  film::Film film(97, 61, region, 4, 2, true);
  film::allocate_component_content({.non_specular = true, .details = true, .motion = true, .shown = true}, &film);
  film::add_pass_channels((uint64_t{1} << GRADUS_PASS_COUNT) - 1, &film);
  film.channels.add({"fog", 3, film::ValueType::kData, film::Normalisation::kOwnWeight}, pixels);
  film.channels.add({"crypto", 6, film::ValueType::kIdAndWeight}, pixels);
  film.replayed.correspondence = {std::vector<int32_t>(pixels), std::vector<Vec2>(pixels)};
  film.replayed.of_component.resize(2, film.replayed.correspondence);
  return film;
}

// Calls visit(value, field, plane) for all 32-bit values of a plane.
template <class Visit>
void for_each_value(const film::Plane& plane, const Visit& visit) {
  for (size_t pixel = 0; pixel < plane.bytes(); pixel += plane.pixel_bytes) {
    for (const film::PlaneField& field : plane.fields) visit(plane.data() + pixel + field.offset, field);
  }
}

template <class T>
void set(T value, unsigned char* to) {
  std::memcpy(to, &value, sizeof(value));
}

// Writes a value of a plane as the type that the field has.
void set(const film::PlaneField& field, uint32_t value, unsigned char* to) {
  if (field.is_integer) {
    set(value, to);
  } else {
    set(float(value), to);
  }
}

// Fills all planes with values of all magnitudes, among them denormal ones and those whose sums are too large.
film::Film random_film(uint32_t seed) {
  film::Film film = full_film();
  std::mt19937 random(seed);
  const float magnitudes[] = {1.0f, 1.0f, 1e4f, 1e-4f, std::numeric_limits<float>::min(), 7e36f};
  for (const film::Plane& plane : film::planes_of(&film)) {
    for_each_value(plane, [&](unsigned char* to, const film::PlaneField& field) {
      if (field.is_integer) {
        set(uint32_t(random() % 4096), to);
      } else if (plane.pairs != nullptr && field.name.starts_with("id")) {
        set(float(random() % 5), to);
      } else {
        set(magnitudes[random() % std::size(magnitudes)] * (float(random() % 4096) / 2048.0f - 1.0f), to);
      }
    });
  }
  film.settings.first_sample = seed;
  return film;
}

// Returns the bits of all values of a film.
std::vector<uint32_t> bits_of(const film::Film& film) {
  std::vector<uint32_t> bits;
  for (const film::Plane& plane : film::planes_of(film)) {
    for_each_value(plane, [&](const unsigned char* from, const film::PlaneField&) {
      uint32_t word = 0;
      std::memcpy(&word, from, sizeof(word));
      bits.push_back(word);
    });
  }
  return bits;
}

TEST(Film, MergedSumsDoNotDependOnThreads) {
  const film::Film first = random_film(2), second = random_film(1);
  test::expect_same_bits_for_any_number_of_threads([&] {
    film::Film film = first;
    film::add_sums(&film, second);
    std::vector<uint32_t> bits = bits_of(film);
    for (const uint64_t dropped :
         {film.counters.nonfinite_radiance, film.counters.nonfinite_gradient, film.counters.nonfinite_feature}) {
      EXPECT_GT(dropped, 100u);
      bits.push_back(uint32_t(dropped));
    }
    return bits;
  });
}

TEST(Film, EachValueOfAPixelIsMergedOnce) {
  film::Film film = full_film();
  for (const film::Plane& plane : film::planes_of(&film)) {
    for_each_value(plane, [&](unsigned char* to, const film::PlaneField& field) { set(field, 1, to); });
  }
  const film::Film other = film;
  film::add_sums(&film, other);
  for (const film::Plane& plane : film::planes_of(&film)) {
    const bool adds = plane.merge == film::MergeRule::kAdd;
    size_t wrong = 0;
    for_each_value(plane, [&](const unsigned char* from, const film::PlaneField& field) {
      const bool is_name = field.name.starts_with("id") || field.name == "object.V" || field.name == "face.V" ||
                           field.name == "sample.V";
      unsigned char expected[4];
      set(field, adds && !is_name ? 2 : 1, expected);
      wrong += plane.pairs == nullptr && std::memcmp(from, expected, 4) != 0 ? 1 : 0;
    });
    EXPECT_EQ(wrong, 0u) << plane.layer;
  }
  const std::vector<float>& pairs = film.channels.find("crypto")->values[0];
  for (size_t i = 0; i < pairs.size(); i += 6) {
    ASSERT_EQ(std::vector<float>(&pairs[i], &pairs[i] + 2), (std::vector<float>{1.0f, 4.0f})) << i;
  }
}

// Returns the name of a plane's value without the half-buffer, in which channels stand, too.
std::string without_half(const std::string& name) {
  return name.starts_with("A.") || name.starts_with("B.") ? name.substr(2) : name;
}

TEST(Film, ChannelsCannotHaveTheNamesOfItsPlanes) {
  film::Film film = full_film();
  film.channels = {};
  const auto expect_refusal = [&](const std::string& name) {
    EXPECT_THROW(film.channels.add({name}, size_t(film.region.area())), Error) << name;
  };
  for (const film::Plane& plane : film::planes_of(film)) {
    expect_refusal(plane.part);
    expect_refusal(plane.layer);
    for (const film::PlaneField& field : plane.fields) {
      const std::string name = without_half(plane.layer + "." + field.name);
      if (name.find('.') != std::string::npos) expect_refusal(name.substr(0, name.rfind('.')));
    }
  }
}

// Pictures of two sizes may have the same border.
TEST(Film, FilmsOfDifferentFullSizesCannotBeAdded) {
  const Region region{0, 0, 4, 3};
  const film::Film film = small_film();
  EXPECT_TRUE(film::can_add(film, film::Film(4, 3, region, 3, 1, true)));
  EXPECT_FALSE(film::can_add(film, film::Film(5, 3, region, 3, 1, true)));
  EXPECT_FALSE(film::can_add(film, film::Film(4, 4, region, 3, 1, true)));
}

// Regression: channels with more than four values overran an array.
TEST(B6_FiniteCheck, ASampleMayHaveAsManyValuesAsAnyChannel) {
  film::Film film = small_film();
  film.channels.add({"Crypto", film::kMaxPairValues, film::ValueType::kIdAndWeight}, 12);
  film::Channel* const channel = film.channels.find("Crypto");
  std::vector<float> values(film::kMaxPairValues);
  std::iota(values.begin(), values.end(), 1.0f);
  film::add_feature(values.data(), 2.0f, 5, 0, channel, &film.counters);
  for (size_t i = 0; i < channel->values[0].size(); ++i) {
    const size_t first = 5 * size_t{film::kMaxPairValues};
    EXPECT_EQ(channel->values[0][i], i >= first && i < first + values.size() ? 2.0f * values[i - first] : 0.0f) << i;
  }
  EXPECT_EQ(film.counters.nonfinite_feature, 0u);
}

// Regression: the memory estimate for loading a film ignored the planes of counts.
TEST(Film, BytesPerPixelAreThoseOfAllItsPlanes) {
  constexpr size_t kPixels = 12;
  for (const int components : {1, 3}) {
    for (const bool gradients : {false, true}) {
      for (const uint64_t passes : {uint64_t{0}, (uint64_t{1} << GRADUS_PASS_COUNT) - 1}) {
        film::Film film(4, 3, Region{0, 0, 4, 3}, 4, components, gradients);
        film::add_pass_channels(passes, &film);
        for (const film::ComponentContent& kept :
             {film::ComponentContent{}, {.non_specular = true}, {.details = true}, {.motion = true, .shown = true}}) {
          film::allocate_component_content(kept, &film);
          EXPECT_EQ(
              film.memory_bytes() - sizeof(film::Film),
              kPixels * film::film_bytes_per_pixel(components, gradients, film::channels_of_passes(passes), kept));
        }
      }
    }
  }
}

TEST(Film, ChannelsNeedNamesThatNoOtherPlaneHas) {
  film::Film film = small_film();
  film.channels.add({"fog", 1, film::ValueType::kData, film::Normalisation::kOwnWeight}, 12);
  for (const char* name :
       {"", "fog", "A", "normal", "reflectance.x", "inverse depth", "component2", "fog.weight", "a\nb"})
    EXPECT_THROW(film.channels.add({name}, 12), Error) << name;
  film.channels.add({"Größe"}, 12);
  EXPECT_EQ(film.channels.size(), 2u);
}

// Differences combine the pair's own samples and the reverse shift, each divided by its count.
TEST(Film, MergesPairsByTheirCounts) {
  film::Film film = small_film();
  const size_t p = film.index(1, 1);
  const size_t q = film.index(2, 1);
  film.components[0].gradient[0][film::kRight][p] = Radiance(6.0f);
  film.components[0].gradient[0][film::kLeft][q] = Radiance(-2.0f);
  film.pair_count[0][film::kRight][p] = 4.0f;
  film.pair_count[0][film::kLeft][q] = 1.0f;
  const film::GradientImages images = film::read_images(film, 0);
  EXPECT_FLOAT_EQ(images.dx[3 * p], 3.5f);
  EXPECT_TRUE(std::isnan(film::read_half_differences(film, 0).dx[3 * p])) << "absent in one half";
  EXPECT_TRUE(std::isnan(images.dx[3 * q]));
  film.pair_count[0][film::kLeft][q] = 0.0f;  // a difference that only one pixel has sampled is absent
  EXPECT_TRUE(std::isnan(film::read_images(film, 0).dx[3 * p]));
}

TEST(Film, LastColumnAndRowHaveNoDifference) {
  film::Film film = small_film();
  for (int offset = 0; offset < film::kOffsets; ++offset) {
    film.components[0].gradient[0][offset].assign(12, Radiance(offset < 2 ? 1.0f : -1.0f));
  }
  for (auto& plane : film.pair_count[0]) {
    plane.assign(12, 1.0f);
  }
  const film::GradientImages images = film::read_images(film, 0);
  EXPECT_EQ(images.dx[3 * film.index(3, 1)], 0.0f);
  EXPECT_EQ(images.dy[3 * film.index(1, 2)], 0.0f);
  EXPECT_EQ(images.dx[3 * film.index(2, 1)], 2.0f);
  EXPECT_EQ(images.dy[3 * film.index(1, 1)], 2.0f);
}

TEST(Film, VarianceIsThatOfTheMean) {
  film::Film film = small_film();
  film.count[0].assign(12, 2);
  film.count[1].assign(12, 2);
  film.components[0].primal[0].assign(12, Radiance(2.0f));
  film.components[0].primal[1].assign(12, Radiance(6.0f));
  EXPECT_FLOAT_EQ(variances(film)[0], 1.0f);  // ((1 − 3)/2)²
  EXPECT_FLOAT_EQ(film::read_half_differences(film, 0).primal[0], -1.0f);
}

}  // namespace
}  // namespace gradus::film_test
