// F6: stored films are exact, complete or absent; damaged files are refused. Loaded films resume and reconstruct with
// the same bits.
#include "film_io/store.h"

#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <random>
#include <set>
#include <thread>
#include <utility>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfStringAttribute.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "film/counter_fields.h"
#include "film/finite_check.h"
#include "film/planes.h"
#include "film/splats.h"
#include "film_io/file_writer.h"
#include "film_io/temporary_file.h"
#include "render/fake_integrator.h"
#include "render/resume.h"
#include "support/developed.h"
#include "support/file_calls.h"
#include "support/refusal.h"

namespace gradus::store_test {
namespace {

using namespace test;
namespace fs = std::filesystem;

class F6_Store : public ::testing::Test {
 protected:
  void SetUp() override {
    // A folder for each test: a process cleans up a folder only once.
    const std::string test = ::testing::UnitTest::GetInstance()->current_test_info()->name();
    folder = fs::temp_directory_path() / ("gradus_store_" + std::to_string(getpid()) + "_" + test);
    fs::create_directories(folder);
  }
  void TearDown() override { fs::remove_all(folder); }
  std::string path(const std::string& name = "frame.exr") const { return (folder / name).string(); }
  size_t files() const { return size_t(std::distance(fs::directory_iterator(folder), fs::directory_iterator())); }
  fs::path folder;
};

GradusSettings all_passes(uint32_t width, uint32_t height, uint32_t samples) {
  GradusSettings s = small_settings(width, height, samples);
  s.passes = (uint64_t{1} << GRADUS_PASS_COUNT) - 1;
  return s;
}

TEST_F(F6_Store, RoundTripIsExact) {
  GradusSettings settings = all_passes(61, 37, 8);
  settings.film_transparent = 1;
  settings.frame = -7;
  const auto film = rendered(settings);
  film_io::save_film(*film, path());
  EXPECT_EQ(files(), 1u);
  const auto back = film_io::load_film(path());
  EXPECT_TRUE(same_samples(*film, *back));
  EXPECT_NE(back->channels.of_pass(GRADUS_PASS_FALLBACK), nullptr);
  EXPECT_EQ(film->samples, back->samples);
  EXPECT_EQ(back->samples.list(), (std::vector<film::SampleRange>{{0, 8}}));
  EXPECT_EQ(back->scene_key, film->scene_key);
  EXPECT_EQ(back->frame_number, -7);
  EXPECT_EQ(back->counters.rays_primary, film->counters.rays_primary);
  EXPECT_EQ(std::memcmp(&back->settings, &film->settings, sizeof(GradusSettings)), 0);
}

const film::ChannelInfo kOtherChannels[] = {
    {"Curvature of surfaces", 2, film::ValueType::kData, film::Normalisation::kSampleCount, true, false},
    {"Crypto", 4, film::ValueType::kIdAndWeight, film::Normalisation::kSampleCount, false, false},
    {"Caustics", 3, film::ValueType::kRadiance, film::Normalisation::kAllPaths, true, true},
    {"Roughness", 1, film::ValueType::kData, film::Normalisation::kOwnWeight, false, false},
};

nlohmann::json description_of(const Imf::Header& header) {
  return nlohmann::json::parse(header.typedAttribute<Imf::StringAttribute>("gradus").value());
}

// Returns a rendered film with channels that the table of passes does not contain, and values in them.
std::shared_ptr<film::Film> with_other_channels(const GradusSettings& settings) {
  auto film = std::make_shared<film::Film>(*rendered(settings));
  for (const film::ChannelInfo& info : kOtherChannels) film->channels.add(info, size_t(film->region.area()));
  const uint32_t first = settings.first_sample;
  const auto trace = [&](uint32_t unit) {
    film::SplatUnit traced{int(unit), 100 + unit + first, {}};
    for (int32_t x = 0; x < film->region.x1; ++x)
      traced.splats.push_back({x, x % 7, Vec4(float(x) + 0.1f * float(first))});
    return traced;
  };
  film::add_splats(2, trace, film.get(), film->channels.find("Caustics"), &film->counters);
  film::Channel& curvature = *film->channels.find("Curvature of surfaces");
  film::Channel& crypto = *film->channels.find("Crypto");
  film::Channel& roughness = *film->channels.find("Roughness");
  for (size_t i = 0; i < size_t(film->region.area()); ++i) {
    const std::vector<float> values = {0.1f * float(i % 13), 1.0f / float(i + first + 1)};
    film::add_feature(values.data(), 1.0f, i, int(i % 2), &curvature, &film->counters);
    film::add_feature(values.data(), 0.5f, i, 0, &roughness, &film->counters);
    film::add_pair(float(i % 3 + first), 0.25f, 2, crypto.values[0].data() + 4 * i, &film->counters);
  }
  return film;
}

// Compares all planes and paths of two films.
void expect_same_bits(const film::Film& a, const film::Film& b) {
  EXPECT_TRUE(same_samples(a, b));
  const std::vector<film::Plane> of_a = film::planes_of(a), of_b = film::planes_of(b);
  ASSERT_EQ(of_a.size(), of_b.size());
  for (size_t i = 0; i < of_a.size(); ++i) {
    ASSERT_EQ(of_a[i].layer, of_b[i].layer);
    ASSERT_EQ(of_a[i].bytes(), of_b[i].bytes());
    EXPECT_EQ(std::memcmp(of_a[i].data(), of_b[i].data(), of_a[i].bytes()), 0) << of_a[i].layer;
  }
}

TEST_F(F6_Store, LightPassesWithoutTheirColoursAreRefused) {
  const auto film = with_other_channels(all_passes(16, 16, 2));
  const film::ChannelList whole = std::exchange(film->channels, {});
  for (const film::Channel& channel : whole) {
    if (channel.pass != GRADUS_PASS_DIFFUSE_COLOR) film->channels.add(channel.info, size_t(film->region.area()));
  }
  film_io::save_film(*film, path());
  EXPECT_THROW(film_io::load_film(path()), Error);
}

TEST_F(F6_Store, ChannelsThatAreNoPassesAreStoredAndMerged) {
  GradusSettings early = all_passes(61, 37, 8), late = early;
  late.first_sample = 8;
  const auto film = with_other_channels(early), other = with_other_channels(late);
  film_io::save_film(*film, path("early.exr"));
  film_io::save_film(*other, path("late.exr"));
  const auto back = film_io::load_film(path("early.exr")), other_back = film_io::load_film(path("late.exr"));
  ASSERT_EQ(back->channels.size(), film->channels.size());
  EXPECT_EQ(back->channels.find("Caustics")->paths, (std::array<uint64_t, 2>{100, 101}));
  EXPECT_EQ(back->memory_bytes(), film->memory_bytes());
  expect_same_bits(*film, *back);

  film::Film merged = *film;
  render::merge_films(&merged, *other);
  render::merge_films(back.get(), *other_back);
  expect_same_bits(merged, *back);
  const auto sum_of = [](const film::Film& of, const char* name, size_t i) {
    return of.channels.find(name)->values[0][i];
  };
  for (size_t i = 0; i < 50; ++i) {
    EXPECT_EQ(sum_of(merged, "Roughness", i), sum_of(*film, "Roughness", i) + sum_of(*other, "Roughness", i));
    EXPECT_EQ(sum_of(merged, "Crypto", 4 * i + 1) + sum_of(merged, "Crypto", 4 * i + 3), 0.5f);
  }
  EXPECT_EQ(back->channels.find("Caustics")->paths, (std::array<uint64_t, 2>{208, 210}));

  late.first_sample = 16;
  const auto fewer = rendered(late);
  EXPECT_EQ(refusal_of([&] { render::merge_films(&merged, *fewer); }), "the films differ in size or planes");
}

// The values of such channels would be divided by samples that do not have them.
TEST_F(F6_Store, FilmsWithChannelsThatARenderDoesNotSampleAreNotResumed) {
  GradusSettings settings = all_passes(16, 16, 2);
  const auto film = with_other_channels(settings);
  settings.samples = 4;
  EXPECT_EQ(refusal_of([&] { rendered(settings, film); }),
            "the film holds the channel Curvature of surfaces, which the render does not sample");
}

TEST_F(F6_Store, RegionsAndPathFilmsToo) {
  GradusSettings settings = small_settings(200, 100, 2);
  const uint32_t region[4] = {80, 60, 90, 67};
  std::copy(region, region + 4, settings.region);
  auto film = rendered(settings);
  film_io::save_film(*film, path());
  EXPECT_TRUE(same_samples(*film, *film_io::load_film(path())));
  EXPECT_EQ(film_io::load_film(path())->region.y0, 16);  // 60 less the guard ring, at the first row of a pixel block
  settings.integrator = GRADUS_INTEGRATOR_PATH;
  film = rendered(settings);
  film_io::save_film(*film, path());
  EXPECT_TRUE(same_samples(*film, *film_io::load_film(path())));
  EXPECT_FALSE(film_io::load_film(path())->gradients);
}

TEST_F(F6_Store, L3_ResumeFromAFileHasTheSameBits) {
  film_io::save_film(*rendered(all_passes(40, 30, 16)), path());
  EXPECT_TRUE(
      same_samples(*rendered(all_passes(40, 30, 64), film_io::load_film(path())), *rendered(all_passes(40, 30, 64))));
}

TEST_F(F6_Store, ReconstructionFromAFileHasTheSameBits) {
  const auto film = rendered(small_settings(64, 48, 4));
  film_io::save_film(*film, path());
  const std::shared_ptr<const film::Film> loaded = film_io::load_film(path());
  for (const uint32_t kind : {GRADUS_RECONSTRUCTION_NONE, GRADUS_RECONSTRUCTION_L2, GRADUS_RECONSTRUCTION_L1})
    EXPECT_EQ(test::reconstructed(film, kind, film->region, 0.2f),
              test::reconstructed(loaded, kind, film->region, 0.2f));
}

TEST_F(F6_Store, ReplaysKeepTheirReplayMap) {
  film::Film film = *rendered(small_settings(20, 10, 2));
  film.replayed.stream_frame = -3;
  film.replayed.seed = 11;
  film.replayed.net_samples = 12;
  for (int32_t i = 0; i < 200; ++i)
    film.replayed.correspondence.pixel.push_back(i % 7 == 0 ? film::kNoCorrespondence : 199 - i);
  film_io::save_film(film, path());
  EXPECT_EQ(film_io::load_film(path())->replayed.stream_frame, -3);
  EXPECT_EQ(film_io::load_film(path())->replayed.seed, 11u);
  EXPECT_EQ(film_io::load_film(path())->replayed.net_samples, 12u);
  EXPECT_EQ(film_io::load_film(path())->replayed.correspondence, film.replayed.correspondence);
  film.replayed.correspondence.pixel[5] = 200;
  film_io::save_film(film, path());
  EXPECT_THROW(film_io::load_film(path()), Error);
}

TEST_F(F6_Store, ReplaysKeepFilmDisplacements) {
  film::Film film = *rendered(small_settings(20, 10, 2));
  film.replayed.correspondence.pixel.assign(200, 3);
  film.replayed.correspondence.off_centre.assign(200, Vec2(0.25f, -0.5f));
  film.replayed.correspondence.off_centre[7] = Vec2(-0.125f, 0.0f);
  film_io::save_film(film, path());
  EXPECT_EQ(film_io::load_film(path())->replayed.correspondence, film.replayed.correspondence);
}

// Regression: such a displacement selects a wrong pixel of the still picture, or none.
TEST_F(F6_Store, DisplacementsThatEndOutsideTheirPixelAreRefused) {
  for (const float wrong : {0.6f, -100.0f, NAN, INFINITY}) {
    film::Film film = *rendered(small_settings(20, 10, 2));
    film.replayed.correspondence.pixel.assign(200, 3);
    film.replayed.correspondence.off_centre.assign(200, Vec2(0.0f));
    film.replayed.correspondence.off_centre[7].y = wrong;
    film_io::save_film(film, path());
    EXPECT_THROW(film_io::load_film(path()), Error) << wrong;
  }
}

class F6_StoredComponents : public F6_Store {
 protected:
  // Returns a film with three components; the value of each is its number.
  film::Film film() const {
    film::Film film = *rendered(small_settings(20, 10, 2));
    const film::ComponentPlanes planes = film.components.front();
    film.components.assign(3, planes);
    for (int c = 0; c < 3; ++c) {
      film.components[size_t(c)].name = kNames[c];
      film.components[size_t(c)].primal[0].assign(200, Radiance(Rgb(float(c + 1)), 0.0f));
    }
    film.replayed.correspondence.pixel.assign(200, film::kNoCorrespondence);
    film.replayed.of_component = {{}, {}, {std::vector<int32_t>(200, 7)}};
    return film;
  }
  std::shared_ptr<film::Film> load(const char* name) const {
    return film_io::load_component(path(), name, film_io::StoredContent::kAll, [] { return false; });
  }
  static constexpr const char* kNames[3] = {"Seen", "Diffuse", "Reflection"};
};

TEST_F(F6_StoredComponents, ComeBackTogether) {
  const film::Film stored = film();
  film_io::save_film(stored, path());
  const auto back = film_io::load_film(path());
  EXPECT_TRUE(same_samples(stored, *back));
  EXPECT_EQ(back->replayed.of_component, stored.replayed.of_component);
}

TEST_F(F6_StoredComponents, AreReadOneByOneWithTheirOwnDisplacements) {
  const film::Film stored = film();
  film_io::save_film(stored, path());
  for (int c = 0; c < 3; ++c) {
    const auto one = load(kNames[c]);
    ASSERT_EQ(one->components.size(), 1u);
    EXPECT_EQ(one->components[0].name, kNames[c]);
    EXPECT_EQ(one->components[0].primal, stored.components[size_t(c)].primal);
    EXPECT_EQ(one->components[0].gradient, stored.components[size_t(c)].gradient);
    EXPECT_EQ(one->count, stored.count);
    EXPECT_EQ(one->replayed.correspondence.pixel,
              c == 2 ? stored.replayed.of_component[2].pixel : stored.replayed.correspondence.pixel);
    EXPECT_TRUE(one->replayed.of_component.empty());
  }
}

TEST_F(F6_StoredComponents, AMissingOneIsBlack) {
  film_io::save_film(film(), path());
  const auto one = load("Glass");
  ASSERT_EQ(one->components.size(), 1u);
  EXPECT_EQ(one->components[0].name, "Glass");
  EXPECT_EQ(one->components[0].primal[0], std::vector<Radiance>(200, Radiance(0.0f)));
}

TEST_F(F6_StoredComponents, CorrespondencesToPixelsThatDoNotExistAreRefused) {
  film::Film stored = film();
  stored.replayed.of_component[2].pixel[3] = 200;
  film_io::save_film(stored, path());
  EXPECT_THROW(film_io::load_film(path()), Error);
  EXPECT_THROW(load("Reflection"), Error);
  EXPECT_NO_THROW(load("Seen"));
}

using Rename = std::function<std::string(const std::string&)>;

// Rewrites a file with OpenEXR alone: reads and writes every channel of every part, with the headers as `change` leaves
// them. `name_before` returns the name that a channel has in the first file.
template <class Change>
void rewrite(
    const std::string& from, const std::string& to, const Change& change,
    const Rename& name_before = [](const std::string& name) { return name; }) {
  Imf::MultiPartInputFile file(from.c_str());
  std::vector<Imf::Header> headers;
  for (int i = 0; i < file.parts(); ++i) headers.push_back(file.header(i));
  change(&headers);
  Imf::MultiPartOutputFile written(to.c_str(), headers.data(), int(headers.size()));
  for (int i = 0; i < int(headers.size()); ++i) {
    const Imath::Box2i window = headers[size_t(i)].dataWindow();
    const int width = window.max.x - window.min.x + 1, height = window.max.y - window.min.y + 1;
    std::vector<std::vector<uint32_t>> planes;
    Imf::FrameBuffer before, after;
    const Imf::ChannelList& channels = headers[size_t(i)].channels();
    for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
      planes.emplace_back(size_t(width) * size_t(height));
      const Imf::Slice slice = Imf::Slice::Make(channel.channel().type, planes.back().data(), window);
      before.insert(name_before(channel.name()), slice);
      after.insert(channel.name(), slice);
    }
    Imf::InputPart input(file, i);
    input.setFrameBuffer(before);
    input.readPixels(window.min.y, window.max.y);
    Imf::OutputPart output(written, i);
    output.setFrameBuffer(after);
    output.writePixels(height);
  }
}

TEST_F(F6_Store, OpenExrReadsItAndWhatOpenExrPackedIsRead) {
  for (const auto& [width, height] : {std::pair{61u, 37u}, {64u, 48u}, {1u, 1u}}) {
    const auto film = rendered(all_passes(width, height, 4));
    film_io::save_film(*film, path());
    rewrite(path(), path("again.exr"), [](std::vector<Imf::Header>*) {});
    EXPECT_TRUE(same_samples(*film, *film_io::load_film(path("again.exr"))));
  }
}

std::vector<std::string> names_of(const Imf::MultiPartInputFile& file) {
  std::vector<std::string> names;
  for (int i = 0; i < file.parts(); ++i) names.push_back(file.header(i).name());
  return names;
}

TEST_F(F6_Store, PartsAreWrittenOnlyForTheirPurpose) {
  film_io::save_film(*rendered(all_passes(20, 10, 2)), path());
  EXPECT_EQ(names_of(Imf::MultiPartInputFile(path().c_str())),
            (std::vector<std::string>{"samples", "counts", "gradients", "pairs", "Emission", "Environment",
                                      "Diffuse_Direct", "Diffuse_Indirect", "Glossy_Direct", "Glossy_Indirect",
                                      "Transmission_Direct", "Transmission_Indirect", "Denoising_Normal",
                                      "Denoising_Albedo", "Denoising_Depth", "passes"}));
  GradusSettings settings = small_settings(20, 10, 2);
  settings.integrator = GRADUS_INTEGRATOR_PATH;
  settings.reconstruction = GRADUS_RECONSTRUCTION_NONE;  // needs no features
  film_io::save_film(*rendered(settings), path());
  EXPECT_EQ(names_of(Imf::MultiPartInputFile(path().c_str())), (std::vector<std::string>{"samples", "counts"}));
  EXPECT_NO_THROW(film_io::load_film(path()));
}

// Readers that join the channels of all parts lose none.
TEST_F(F6_Store, ChannelNamesAreUnique) {
  film_io::save_film(*rendered(all_passes(20, 10, 2)), path());
  const Imf::MultiPartInputFile file(path().c_str());
  std::set<std::string> names;
  for (int i = 0; i < file.parts(); ++i) {
    const Imf::ChannelList& channels = file.header(i).channels();
    for (auto c = channels.begin(); c != channels.end(); ++c) EXPECT_TRUE(names.insert(c.name()).second) << c.name();
  }
}

// The first row of the file is the top row of the picture.
TEST_F(F6_Store, RowsRunDownwards) {
  const auto film = rendered(small_settings(20, 10, 2));
  film_io::save_film(*film, path());
  Imf::MultiPartInputFile file(path().c_str());
  std::vector<uint32_t> row(20);
  Imf::FrameBuffer buffer;
  buffer.insert("A.G", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(row.data()), sizeof(uint32_t), 0));
  Imf::InputPart part(file, 0);
  part.setFrameBuffer(buffer);
  part.readPixels(0);
  for (size_t x = 0; x < row.size(); ++x) {
    float value = 0.0f;
    std::memcpy(&value, &row[x], sizeof(value));
    EXPECT_EQ(value, film->components[0].primal[0][9 * 20 + x].y);
  }
}

struct Refusal {
  const char* what;
  uint32_t code;
  std::function<void(std::vector<Imf::Header>*)> change;
};

void set_format(int format, Imf::Header* header) {
  nlohmann::json j = description_of(*header);
  j["format"] = format;
  header->insert("gradus", Imf::StringAttribute(j.dump()));
}

// Films that earlier versions wrote without channels of their own, and with such channels.
TEST_F(F6_Store, FilmsOfTheFormats9And10AreRead) {
  for (const bool has_channels : {false, true}) {
    const std::shared_ptr<const film::Film> film =
        has_channels ? with_other_channels(all_passes(16, 16, 2)) : rendered(all_passes(16, 16, 2));
    film_io::save_film(*film, path());
    rewrite(path(), path("earlier.exr"), [&](std::vector<Imf::Header>* headers) {
      nlohmann::json j = description_of(headers->front());
      EXPECT_EQ(j["format"], 12);
      j["format"] = has_channels ? 10 : 9;
      j["counters"] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20};
      headers->front().insert("gradus", Imf::StringAttribute(j.dump()));
    });
    const std::shared_ptr<film::Film> earlier = film_io::load_film(path("earlier.exr"));
    EXPECT_TRUE(same_samples(*earlier, *film));
    EXPECT_EQ(earlier->counters.rays_primary, 1u);
    EXPECT_EQ(earlier->counters.shifts_attempted, 6u);
    EXPECT_EQ(earlier->counters.fail_missed, 10u);
    EXPECT_EQ(earlier->counters.nonfinite_feature, 20u);
  }
}

std::string replaced(const std::string& text, const std::string& part, const std::string& other) {
  const size_t begin = text.find(part);
  return begin == std::string::npos ? text : std::string(text).replace(begin, part.size(), other);
}

// Gives planes and parts the names that they had up to format 11. Channels of the film, "own.…", keep theirs.
void name_as_before(std::vector<Imf::Header>* headers) {
  set_format(11, &headers->front());
  for (Imf::Header& header : *headers) {
    if (header.name().find("own.") == std::string::npos)
      header.setName(replaced(header.name(), "non_specular", "rough"));
    Imf::ChannelList renamed;
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
      const std::string name = c.name();
      const bool is_own = name.find("own.") != std::string::npos;
      renamed.insert(is_own ? name : replaced(name, "correspondence", "source"), c.channel());
    }
    header.channels() = renamed;
  }
}

TEST_F(F6_StoredComponents, PlanesOfFormat11AreReadByTheirNames) {
  film::Film stored = film();
  film::allocate_component_content({.non_specular = true}, &stored);
  stored.components[1].non_specular[0][3].samples = 5.0f;
  film_io::save_film(stored, path("now.exr"));
  const std::vector<std::string> names = names_of(Imf::MultiPartInputFile(path("now.exr").c_str()));
  EXPECT_TRUE(std::ranges::count(names, "non_specular") == 1 && std::ranges::count(names, "rough") == 0);
  rewrite(path("now.exr"), path(), name_as_before,
          [](const std::string& name) { return replaced(name, "source", "correspondence"); });
  const auto earlier = film_io::load_film(path());
  expect_same_bits(*earlier, stored);
  EXPECT_EQ(earlier->replayed.of_component, stored.replayed.of_component);
  EXPECT_EQ(load("Diffuse")->components[0].non_specular[0][3].samples, 5.0f);
  EXPECT_EQ(load("Reflection")->replayed.correspondence.pixel, stored.replayed.of_component[2].pixel);
}

// Regression: elements of channel names were looked up under the older names of planes.
TEST_F(F6_StoredComponents, ChannelsOfFormat11KeepTheirNames) {
  film::Film stored = film();
  const auto pixels = size_t(stored.region.area());
  stored.channels.add({"own.correspondence", 1}, pixels);
  stored.channels.add({"own.non_specular", 1, film::ValueType::kData, film::Normalisation::kSampleCount, true}, pixels);
  stored.channels.find("own.correspondence")->values[0][3] = 4.0f;
  stored.channels.find("own.non_specular")->values[1][5] = 6.0f;
  film_io::save_film(stored, path("now.exr"));
  rewrite(path("now.exr"), path(), name_as_before,
          [](const std::string& name) { return replaced(name, "source", "correspondence"); });
  const auto earlier = film_io::load_film(path());
  expect_same_bits(*earlier, stored);
  EXPECT_EQ(earlier->channels.find("own.correspondence")->values[0][3], 4.0f);
  EXPECT_EQ(earlier->channels.find("own.non_specular")->values[1][5], 6.0f);
}

// Counters are stored by name, so that one that a later version adds or removes does not change the others.
TEST_F(F6_Store, CountersAreStoredByName) {
  film::Film film = *rendered(small_settings(16, 16, 2));
  uint64_t number = 0;
  for (const film::CounterField& field : film::kCounterFields) film.counters.*field.value = ++number;
  film_io::save_film(film, path());
  rewrite(path(), path("changed.exr"), [](std::vector<Imf::Header>* headers) {
    nlohmann::json j = description_of(headers->front());
    EXPECT_EQ(j["counters"]["rays"]["shadow"], 3);
    j["counters"]["rays"].erase("primary");
    j["counters"]["rays"]["another"] = 100;
    headers->front().insert("gradus", Imf::StringAttribute(j.dump()));
  });
  const std::shared_ptr<film::Film> changed = film_io::load_film(path("changed.exr"));
  for (const film::CounterField& field : film::kCounterFields) {
    const bool is_erased = field.value == &film::Counters::rays_primary;
    EXPECT_EQ(changed->counters.*field.value, is_erased ? 0 : film.counters.*field.value) << field.path;
  }
}

// Replays of earlier versions used the seed of their own frame, and their files do not store it.
TEST_F(F6_Store, ReplaysOfEarlierVersionsHaveTheSeedOfTheirFrame) {
  film::Film film = *rendered(small_settings(20, 10, 2));
  film.settings.seed = 5;
  film.replayed = {3, {std::vector<int32_t>(200)}, 0, 4};
  film_io::save_film(film, path());
  EXPECT_EQ(film_io::load_header(path()).replayed_seed, 4u);
  rewrite(path(), path("earlier.exr"), [](std::vector<Imf::Header>* headers) {
    nlohmann::json j = description_of(headers->front());
    j.erase("replayed_seed");
    headers->front().insert("gradus", Imf::StringAttribute(j.dump()));
  });
  EXPECT_EQ(film_io::load_header(path("earlier.exr")).replayed_seed, 5u);
}

// The samples of such a film are valid: it is loaded with a warning and reconstructed by the automatic choice.
TEST_F(F6_Store, AFilmWhoseReconstructionWasRemovedIsReadWithAWarning) {
  film_io::save_film(*rendered(small_settings(20, 10, 2)), path());
  EXPECT_TRUE(film_io::load_header(path()).warnings.empty());
  rewrite(path(), path("earlier.exr"), [](std::vector<Imf::Header>* headers) {
    nlohmann::json j = description_of(headers->front());
    j["settings"]["reconstruction"] = "weighted";
    headers->front().insert("gradus", Imf::StringAttribute(j.dump()));
  });
  EXPECT_EQ(film_io::load_film(path("earlier.exr"))->settings.reconstruction, uint32_t{GRADUS_RECONSTRUCTION_AUTO});
  const std::vector<std::string> warnings = film_io::load_header(path("earlier.exr")).warnings;
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("reconstruction weighted was removed"), std::string::npos) << warnings[0];
}

// Earlier versions stored only the first non-specular vertices of components.
TEST_F(F6_Store, FilmsOfEarlierVersionsHaveNoDetailsOfComponents) {
  film_io::save_film(*rendered(small_settings(20, 10, 2)), path());
  rewrite(path(), path("earlier.exr"), [](std::vector<Imf::Header>* headers) {
    nlohmann::json j = description_of(headers->front());
    ASSERT_EQ(j.erase("details"), 1u);
    headers->front().insert("gradus", Imf::StringAttribute(j.dump()));
  });
  EXPECT_FALSE(film_io::load_header(path("earlier.exr")).of_components.details);
  EXPECT_TRUE(film_io::load_film(path("earlier.exr"))->components[0].details.empty());
}

TEST_F(F6_StoredComponents, HaveTheirDetails) {
  film::Film stored = film();
  film::allocate_component_content({.details = true}, &stored);
  float value = 0.0f;
  for (film::ComponentPlanes& planes : stored.components) {
    for (film::NonSpecularDetails& details : planes.details) {
      ++value;
      details = {Vec3(value, 2, 3), Rgb(4, value, 6), 7 * value, 8 * value, value, uint32_t(value)};
    }
  }
  stored.components[1].details[4] = {};
  film_io::save_film(stored, path());
  const auto same = [](const std::vector<film::NonSpecularDetails>& a, const std::vector<film::NonSpecularDetails>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(film::NonSpecularDetails)) == 0;
  };
  const auto back = film_io::load_film(path());
  for (size_t c = 0; c < 3; ++c) {
    EXPECT_TRUE(same(back->components[c].details, stored.components[c].details));
    EXPECT_TRUE(same(load(kNames[c])->components[0].details, stored.components[c].details));
  }
  const auto glass = load("Glass");
  for (const film::NonSpecularDetails& details : glass->components[0].details)
    ASSERT_EQ(details.sample, film::kNoSample);
}

TEST_F(F6_Store, ForeignFilesAreRefusedByName) {
  film_io::save_film(*rendered(all_passes(32, 32, 1)), path());
  const Refusal refusals[] = {
      {"it was written by another version of Gradus", GRADUS_ERROR_INVALID_ARGUMENT,
       [](auto* h) { set_format(3, &h->front()); }},
      {"it was written by another version of Gradus", GRADUS_ERROR_INVALID_ARGUMENT,
       [](auto* h) { set_format(13, &h->front()); }},
      {"it is not a film of Gradus", GRADUS_ERROR_INVALID_ARGUMENT, [](auto* h) { h->front().erase("gradus"); }},
      {"it was packed by another program", GRADUS_ERROR_INVALID_ARGUMENT,
       [](auto* h) { (*h)[1].compression() = Imf::PIZ_COMPRESSION; }},
      {"it has parts of something else", GRADUS_ERROR_INVALID_ARGUMENT, [](auto* h) { h->pop_back(); }},
      {"part gradients is missing", GRADUS_ERROR_INVALID_ARGUMENT, [](auto* h) { (*h)[2].setName("other"); }},
      {"channel A.R is missing", GRADUS_ERROR_INVALID_ARGUMENT,
       [](auto* h) { h->front().channels()["A.R"].type = Imf::HALF; }},
  };
  for (const Refusal& refusal : refusals) {
    rewrite(path(), path("foreign.exr"), refusal.change);
    try {
      film_io::load_film(path("foreign.exr"));
      ADD_FAILURE() << refusal.what;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), refusal.code);
      EXPECT_NE(std::string(e.what()).find(refusal.what), std::string::npos) << e.what();
      EXPECT_NE(std::string(e.what()).find("foreign.exr"), std::string::npos) << e.what();
    }
  }
}

// Versions before multi-part files wrote one part without a name.
TEST_F(F6_Store, FilmsOfOnePartAreOfAnotherVersion) {
  film_io::save_film(*rendered(small_settings(32, 32, 1)), path());
  Imf::Header header(32, 32);
  header.insert("gradus", Imf::MultiPartInputFile(path().c_str()).header(0)["gradus"]);
  set_format(3, &header);
  header.channels().insert("component0.A.primal.R", Imf::Channel(Imf::FLOAT));
  { Imf::OutputFile(path("old.exr").c_str(), header); }
  const std::string refusal = refusal_of([&] { film_io::load_film(path("old.exr")); });
  EXPECT_NE(refusal.find("it was written by another version of Gradus"), std::string::npos) << refusal;
}

TEST_F(F6_Store, AFilmLargerThanTheMemoryIsRefused) {
  film_io::save_film(*rendered(small_settings(32, 32, 1)), path());
  const Imf::MultiPartInputFile file(path().c_str());
  std::vector<Imf::Header> headers;
  for (int i = 0; i < file.parts(); ++i) {
    headers.push_back(file.header(i));
    headers.back().displayWindow() = headers.back().dataWindow() = Imath::Box2i({0, 0}, {65535, 65535});
    headers.back().setChunkCount(4096);
  }
  { Imf::MultiPartOutputFile(path("large.exr").c_str(), headers.data(), int(headers.size())); }
  try {
    film_io::load_film(path("large.exr"));
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), GRADUS_ERROR_OUT_OF_MEMORY) << e.what();
  }
}

TEST_F(F6_Store, ErrorsNameThePath) {
  const auto film = rendered(small_settings(8, 8, 1));
  const std::string refusal = refusal_of([&] { film_io::save_film(*film, path("missing/folder/frame.exr")); });
  EXPECT_NE(refusal.find("missing/folder/frame.exr"), std::string::npos) << refusal;
  EXPECT_THROW(film_io::load_film(path("absent.exr")), Error);
  EXPECT_THROW(film_io::load_film(folder.string()), Error);
}

TEST_F(F6_Store, DamagedFilesAreRefusedOrRead) {
  film_io::save_film(*rendered(small_settings(48, 40, 2)), path());
  std::ifstream file(path(), std::ios::binary);
  const std::vector<char> good{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  std::mt19937 random(3);
  int refused = 0;
  for (int round = 0; round < 200; ++round) {
    std::vector<char> bad = good;
    if (round % 2 == 0) {
      bad.resize(random() % bad.size());
    } else {
      for (int i = 0; i < 8; ++i)
        bad[random() % std::min<size_t>(bad.size(), round % 4 == 1 ? 4096 : bad.size())] = char(random());
    }
    std::ofstream(path("bad.exr"), std::ios::binary).write(bad.data(), std::streamsize(bad.size()));
    try {
      film_io::load_film(path("bad.exr"));
    } catch (const Error&) {
      ++refused;
    }
  }
  EXPECT_GE(refused, 100);
}

// Regression: such numbers were delivered unchanged, and an object number that is not finite was cast to an integer.
TEST_F(F6_Store, InvalidObjectNumbersOfComponentsAreRefused) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto sound = std::make_shared<film::Film>(*rendered(small_settings(48, 40, 2)));
  film::allocate_component_content({true, true, true, true}, sound.get());
  const auto refusal_with = [&](const std::function<void(film::ComponentPlanes*)>& damage) {
    film::Film film = *sound;
    damage(&film.components[0]);
    film_io::save_film(film, path());
    return refusal_of([&] { film_io::load_film(path()); });
  };
  const auto load_it = [&] { film_io::load_film(path()); };
  film_io::save_film(*sound, path());
  EXPECT_NO_THROW(load_it());
  const std::pair<const char*, std::function<void(film::ComponentPlanes*)>> damages[] = {
      {"motion", [&](film::ComponentPlanes* planes) { planes->motion[7].z = nan; }},
      {"lost motion", [&](film::ComponentPlanes* planes) { planes->tracked[1900] = nan; }},
      {"non-specular vertices", [&](film::ComponentPlanes* planes) { planes->non_specular[1][3].normal.y = nan; }},
      {"details", [&](film::ComponentPlanes* planes) { planes->details[9].uv.x = nan; }},
      {"shown points", [&](film::ComponentPlanes* planes) { planes->shown[11].object = nan; }},
      {"shown points", [&](film::ComponentPlanes* planes) { planes->shown[11].object = 1e20f; }},
      {"shown points", [&](film::ComponentPlanes* planes) { planes->shown[11].depth = kInfinity; }},
  };
  for (const auto& [what, damage] : damages) {
    const std::string refusal = refusal_with(damage);
    EXPECT_NE(refusal.find(what), std::string::npos) << what << ": " << refusal;
    EXPECT_NE(refusal.find(path()), std::string::npos) << refusal;
  }
}

// Regression: planes of passes and other channels were read without a check.
TEST_F(F6_Store, ValuesOfChannelsThatAreNotFiniteAreRefused) {
  const auto sound = with_other_channels(all_passes(48, 40, 2));
  const auto refusal_with = [&](const char* name, const std::function<void(film::Channel*)>& damage) {
    film::Film film = *sound;
    damage(film.channels.find(name));
    film_io::save_film(film, path());
    return refusal_of([&] { film_io::load_film(path()); });
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(refusal_with("Depth", [](film::Channel*) {}), "");
  for (const char* name : {"Depth", "Denoising Albedo", "Crypto", "Caustics", "Roughness"}) {
    for (const float value : {nan, kInfinity, -kInfinity}) {
      const std::string refusal =
          refusal_with(name, [&](film::Channel* channel) { channel->values[0].back() = value; });
      EXPECT_NE(refusal.find("it holds values of " + std::string(name)), std::string::npos) << refusal;
    }
  }
  const std::string refusal = refusal_with("Roughness", [&](film::Channel* channel) { channel->weight[5] = nan; });
  EXPECT_NE(refusal.find("it holds weights of Roughness"), std::string::npos) << refusal;
}

// OpenEXR allows a block of sixteen rows where the picture has only three.
TEST_F(F6_Store, ABlockThatClaimsMoreRowsThanThereAreIsRefused) {
  film_io::save_film(*rendered(small_settings(48, 3, 2)), path());
  std::ifstream file(path(), std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  const auto size_at = [&](size_t i) {
    int32_t size = 0;
    std::memcpy(&size, bytes.data() + i, sizeof(size));
    return size_t(size);
  };
  size_t place = bytes.size() - 5;  // position of the size of the only block, which ends the file
  while (place > 0 && place + 4 + size_at(place) != bytes.size()) --place;
  ASSERT_GT(place, 0u);
  const auto claimed = static_cast<int32_t>(4 * size_at(place));
  std::memcpy(bytes.data() + place, &claimed, sizeof(claimed));
  bytes.resize(bytes.size() + size_t(claimed));
  std::ofstream(path("bad.exr"), std::ios::binary).write(bytes.data(), std::streamsize(bytes.size()));
  EXPECT_THROW(film_io::load_film(path("bad.exr")), Error);
}

TEST_F(F6_Store, KilledAtAnyMomentLeavesAWholeFileOrNone) {
  const auto film = rendered(all_passes(96, 64, 2));
  film_io::save_film(*film, path("reference.exr"));
  std::mt19937 random(5);
  int whole = 0;
  for (int round = 0; round < 20; ++round) {
    const std::string target = path("killed.exr");
    fs::remove(target);
    const pid_t child = fork();
    if (child == 0) {
      for (;;) film_io::save_film(*film, target);
    }
    // In every other round, the kill comes after the first complete file, so that both cases occur on machines of any
    // speed.
    while (round % 2 == 0 && !fs::exists(target)) usleep(1000);
    usleep(useconds_t(random() % 60000));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    if (!fs::exists(target)) continue;
    ++whole;
    EXPECT_TRUE(same_samples(*film, *film_io::load_film(target)));
  }
  EXPECT_GE(whole, 10);
}

// One of two writers wins; readers see a complete film of one of them at any time.
TEST_F(F6_Store, WritersOfOneFilmDoNotInterfere) {
  const std::shared_ptr<const film::Film> frames[] = {rendered(all_passes(64, 48, 1)), rendered(all_passes(64, 48, 2))};
  const auto write = [&](int n) {
    for (int i = 0; i < 20; ++i) film_io::save_film(*frames[n], path());
  };
  write(0);
  pid_t processes[2];
  for (int n = 0; n < 2; ++n) {
    processes[n] = fork();
    if (processes[n] == 0) {
      write(n);
      _exit(0);
    }
  }
  std::atomic<int> writing{2};
  std::thread threads[2];
  for (int n = 0; n < 2; ++n) {
    threads[n] = std::thread([&, n] {
      write(n);
      --writing;
    });
  }
  while (writing > 0) {
    const auto seen = film_io::load_film(path());
    EXPECT_TRUE(same_samples(*seen, *frames[0]) || same_samples(*seen, *frames[1]));
  }
  for (std::thread& thread : threads) thread.join();
  for (const pid_t process : processes) {
    int status = -1;
    waitpid(process, &status, 0);
    EXPECT_EQ(status, 0);
  }
  EXPECT_EQ(files(), 1u);
}

bool limit_files_to(rlim_t bytes) {
  signal(SIGXFSZ, SIG_IGN);
  const rlimit limit{bytes, bytes};
  return setrlimit(RLIMIT_FSIZE, &limit) == 0;
}

TEST_F(F6_Store, AFileThatMayNotGrowIsAnErrorAndIsRemoved) {
  const auto film = rendered(all_passes(96, 64, 2));
  film_io::save_film(*film, path("old.exr"));
  const auto what = failure_of([] { return limit_files_to(100000); }, [&] { film_io::save_film(*film, path()); });
  ASSERT_TRUE(what);
  EXPECT_NE(what->find("cannot write " + path() + ": File too large"), std::string::npos) << *what;
  EXPECT_EQ(files(), 1u);
  EXPECT_NE(failure_of([] { return limit_files_to(100000); }, [&] { film_io::save_film(*film, path("old.exr")); }), "");
  EXPECT_TRUE(same_samples(*film, *film_io::load_film(path("old.exr")))) << "the frame that was there remains";
}

// Returns a check that is true from its call number `times` on. Several threads may call it.
CancelCheck after(int times) {
  return [left = std::make_shared<std::atomic<int>>(times)] { return --*left < 0; };
}

// Returns how often `work` is cancelled before it finishes, if the cancel comes one check later each time.
template <class Work>
int cancels_of(const Work& work) {
  for (int times = 0;; ++times) {
    try {
      work(after(times));
      return times;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), GRADUS_ERROR_CANCELLED) << e.what();
      if (e.code() != GRADUS_ERROR_CANCELLED) return times;
    }
  }
}

// Regression: a cancel was ignored until the file was written.
TEST_F(F6_Store, K2_ACancelledWriteKeepsTheOldFile) {
  const auto film = rendered(all_passes(96, 64, 2)), other = rendered(all_passes(96, 64, 1));
  const auto left_by = [&](size_t kept) {
    return cancels_of([&](const CancelCheck& cancel) {
      EXPECT_EQ(files(), kept);
      EXPECT_TRUE(kept == 0 || same_samples(*film_io::load_film(path()), *other));
      film_io::save_film(*film, path(), {.cancel = cancel});
    });
  };
  EXPECT_GT(left_by(0), 3) << "of four blocks at least";
  film_io::save_film(*other, path());
  EXPECT_GT(left_by(1), 3);
  EXPECT_TRUE(same_samples(*film_io::load_film(path()), *film));
}

TEST_F(F6_Store, K2_ACancelIsNoticedWhileAFileIsRead) {
  const auto film = rendered(all_passes(96, 64, 2));
  film_io::save_film(*film, path());
  std::shared_ptr<const film::Film> read;
  EXPECT_GT(cancels_of([&](const CancelCheck& cancel) {
              read = film_io::load_film(path(), film_io::StoredContent::kAll, cancel);
            }),
            3);
  EXPECT_TRUE(same_samples(*read, *film));
}

// Regression: a file was synced only at its end. For half a film at 4K this took many seconds in which no cancel was
// noticed.
TEST_F(F6_Store, K2_ALongFileIsSyncedWhileItIsWritten) {
  const std::vector<char> bytes(33 << 20);
  for (const auto& [durable, syncs] : {std::pair(film_io::Durable::kYes, 1), {film_io::Durable::kNo, 0}}) {
    const int before = synced_files;
    film_io::FileWriter writer(path(), durable);
    writer.write(bytes.data(), bytes.size());
    EXPECT_EQ(synced_files, before + syncs);
  }
}

// Mounts a disk of 100 kB in a name space of its own, where that is permitted.
TEST_F(F6_Store, AFullDiskIsAnErrorAndLeavesNoFile) {
  const auto film = rendered(all_passes(96, 64, 2));
  const auto what = failure_of([&] { return mount_disk(folder, "100k"); },
                               [&] {
                                 try {
                                   film_io::save_film(*film, path());
                                 } catch (...) {
                                   if (files() > 0) throw std::runtime_error("something is left");
                                   throw;
                                 }
                               });
  if (!what) GTEST_SKIP() << "no disk can be mounted here";
  EXPECT_NE(what->find("cannot write " + path() + ": No space left on device"), std::string::npos) << *what;
}

TEST_F(F6_Store, AFolderThatIsReadOnlyIsNamed) {
  const auto film = rendered(small_settings(8, 8, 1));
  fs::permissions(folder,
                  fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_read | fs::perms::others_exec);
  // root may write to read-only folders
  const auto become_nobody = [] { return geteuid() != 0 || setuid(65534) == 0; };
  const auto what = failure_of(become_nobody, [&] { film_io::save_film(*film, path()); });
  fs::permissions(folder, fs::perms::owner_all);
  ASSERT_TRUE(what);
  EXPECT_NE(what->find("cannot create " + path() + ": Permission denied"), std::string::npos) << *what;
}

TEST_F(F6_Store, AnAbandonedWriterLeavesNoFile) {
  {
    film_io::FileWriter writer(path("half"));
    writer.write("abc", 3);
  }
  EXPECT_EQ(files(), 0u);
}

TEST_F(F6_Store, ASecondNameReplacesAnExistingFile) {
  std::ofstream(path("a")) << "new";
  std::ofstream(path("b")) << "old";
  for (int time = 0; time < 2; ++time) {
    EXPECT_TRUE(film_io::hard_link_file(path("a"), path("b")));
    EXPECT_TRUE(fs::equivalent(path("a"), path("b")));
    EXPECT_EQ(files(), 2u);
  }
  EXPECT_FALSE(film_io::hard_link_file(path("missing"), path("b")));
  EXPECT_EQ(files(), 2u);
}

// Temporary files carry the number of their process; a killed process cannot remove them.
TEST_F(F6_Store, FilesOfDeadWritersAreRemoved) {
  const pid_t child = fork();
  if (child == 0) {
    film_io::FileWriter first(path("a.exr")), second(path("a.exr"));
    _exit(0);
  }
  waitpid(child, nullptr, 0);
  std::ofstream(path("b.exr." + std::to_string(child) + ".another-host.part")) << "of a machine that shares the folder";
  std::ofstream(path("notes." + std::to_string(child))) << "of someone else";
  ASSERT_EQ(files(), 4u);
  film_io::FileWriter writer(path("c.exr"));
  EXPECT_EQ(files(), 3u);  // including the new one
  film_io::FileWriter other(path("c.exr"));
  EXPECT_EQ(files(), 4u) << "those that live keep theirs";
}

// Regression: each frame of a long animation searched the files of all earlier frames.
TEST_F(F6_Store, AProcessCleansUpAFolderOnce) {
  film_io::FileWriter writer(path("a.exr"));
  const pid_t child = fork();
  if (child == 0) {
    film_io::FileWriter first(path("b.exr"));
    _exit(0);
  }
  waitpid(child, nullptr, 0);
  film_io::FileWriter other(path("c.exr"));
  EXPECT_EQ(files(), 3u) << "what the child has left is the next process's to remove";
}

}  // namespace
}  // namespace gradus::store_test
