// The command-line tool, as the user guide describes it: its files, messages and exit codes.
#include <sys/wait.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <tuple>

#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <nlohmann/json.hpp>

#include "api/test_scene.h"
#include "base/error.h"
#include "film_io/image_exr.h"
#include "schema/pass_table.h"

namespace gradus::tool_test {
namespace {

using namespace test;
namespace fs = std::filesystem;

struct Outcome {
  int code = -1;
  std::string out, err;
};

class Tool : public ::testing::Test {
 protected:
  void SetUp() override {
    folder = fs::temp_directory_path() / ("gradus_tool_" + std::to_string(getpid()));
    fs::create_directories(folder);
    save_scene("good.gradus", false);
  }
  void TearDown() override { fs::remove_all(folder); }

  // Saves a lit quad; if it is broken, the mesh of the instance is missing.
  void save_scene(const std::string& name, bool broken) const {
    const GradusDevice device = make_device();
    GradusScene scene = 0;
    ASSERT_OK(gradus_scene_create(device, &scene));
    ASSERT_OK(gradus_scene_record(scene, 1));
    fill_scene(scene);
    if (broken) {
      ASSERT_OK(gradus_scene_remove(scene, GRADUS_KIND_MESH, 1));
    }
    const GradusSettings settings = small_render(24, 16, 4);
    ASSERT_OK(gradus_scene_save(scene, &settings, (folder / name).c_str()));
    EXPECT_OK(gradus_scene_release(scene));
    EXPECT_OK(gradus_device_release(device));
  }
  Outcome run(const std::string& arguments, const std::string& environment = "") const {
    const std::string command = "cd '" + folder.string() + "' && " + environment + GRADUS_BINARY_DIR "/native/gradus " +
                                arguments + " >out 2>err";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text("out"), text("err")};
  }
  std::string text(const std::string& name) const {
    std::ifstream file(folder / name, std::ios::binary);
    std::ostringstream content;
    content << file.rdbuf();
    return content.str();
  }
  // Returns the error between two images; negative if they cannot be compared.
  double relative_error(const std::string& a, const std::string& b) const {
    const Outcome compared = run("compare " + a + " " + b);
    double error = -1.0;
    EXPECT_EQ(compared.code, 0) << compared.err;
    EXPECT_EQ(std::sscanf(compared.out.c_str(), "relmse %lf", &error), 1) << compared.out;
    return error;
  }
  fs::path folder;
};

std::vector<float> channel_of(const fs::path& path, const char* name) {
  Imf::InputFile file(path.c_str());
  const Imath::Box2i window = file.header().dataWindow();
  const int width = window.max.x - window.min.x + 1, height = window.max.y - window.min.y + 1;
  std::vector<float> values(size_t(width) * size_t(height));
  Imf::FrameBuffer buffer;
  buffer.insert(name, Imf::Slice::Make(Imf::FLOAT, values.data(), window));
  file.setFrameBuffer(buffer);
  file.readPixels(window.min.y, window.max.y);
  return values;
}

const char* const kStored = "store/good/ViewLayer/f+0000000.exr";

TEST_F(Tool, RendersReconstructsAndCompares) {
  const Outcome rendered =
      run("render good.gradus -o store --samples 16 --integrator gradient --image combined.exr --stats stats.jsonl");
  ASSERT_EQ(rendered.code, 0) << rendered.err;
  EXPECT_NE(rendered.out.find(kStored), std::string::npos);
  EXPECT_NE(text("stats.jsonl").find("\"integrator\":\"gradient\""), std::string::npos);
  for (const char* how : {"regularized", "l2", "l1", "none"}) {
    const Outcome made =
        run(std::string("reconstruct ") + kStored + " -o " + how + ".exr --passes noisy_image --reconstruction " + how);
    EXPECT_EQ(made.code, 0) << made.err;
    EXPECT_LT(relative_error(std::string(how) + ".exr", "combined.exr"), 0.1);
  }
  EXPECT_EQ(relative_error("regularized.exr", "combined.exr"), 0.0) << "what the render delivered";
  EXPECT_GT(relative_error("none.exr", "l2.exr"), 0.0);
  EXPECT_EQ(run("compare none.exr l2.exr --fail-above 1e-12").code, 1);
}

// The error belongs to the reconstruction that is written, whatever the film was rendered for.
TEST_F(Tool, WritesTheErrorOfItsReconstruction) {
  ASSERT_EQ(run("render good.gradus -o f.exr --samples 16 --integrator gradient --reconstruction l2 --passes error "
                "--image l2.exr")
                .code,
            0);
  ASSERT_EQ(run("reconstruct f.exr -o again.exr --passes error --reconstruction l2").code, 0);
  ASSERT_EQ(run("reconstruct f.exr -o none.exr --passes error --reconstruction none").code, 0);
  const auto error = [&](const char* image) { return channel_of(folder / image, "Error.X"); };
  EXPECT_EQ(error("l2.exr"), error("again.exr"));
  EXPECT_NE(error("l2.exr"), error("none.exr"));
}

TEST_F(Tool, ResumeHasTheBitsOfOneRender) {
  ASSERT_EQ(run("render good.gradus -o store --samples 4 --net-samples 16").code, 0);
  ASSERT_EQ(run("render good.gradus -o store --samples 16 --resume").code, 0);
  ASSERT_EQ(run("render good.gradus -o whole.exr --samples 16").code, 0);
  for (const char* how : {"none", "auto"}) {
    const std::string options = std::string(" --reconstruction ") + how;
    ASSERT_EQ(run(std::string("reconstruct ") + kStored + " -o a.exr" + options).code, 0);
    ASSERT_EQ(run("reconstruct whole.exr -o b.exr" + options).code, 0);
    EXPECT_EQ(text("a.exr"), text("b.exr")) << how;
  }
}

// With a stand-in for Open Image Denoise.
constexpr const char* kFakeDenoiser = " --denoiser oidn --denoiser-path " GRADUS_BINARY_DIR "/tests/libfake_oidn.so";

TEST_F(Tool, Denoises) {
  const Outcome rendered =
      run(std::string("render good.gradus -o frame.exr --samples 16 --image combined.exr") + kFakeDenoiser);
  ASSERT_EQ(rendered.code, 0) << rendered.err;
  ASSERT_EQ(run("reconstruct frame.exr -o plain.exr").code, 0);
  ASSERT_EQ(run(std::string("reconstruct frame.exr -o again.exr") + kFakeDenoiser).code, 0);
  EXPECT_EQ(relative_error("again.exr", "combined.exr"), 0.0);
  EXPECT_GT(relative_error("plain.exr", "combined.exr"), 0.1);
  const Outcome failed = run(std::string("reconstruct frame.exr -o failed.exr") + kFakeDenoiser, "FAKE_OIDN=fails ");
  EXPECT_EQ(failed.code, 0);
  EXPECT_NE(failed.err.find("warning: the picture was not denoised: Open Image Denoise: the fake has no memory"),
            std::string::npos);
  EXPECT_EQ(relative_error("failed.exr", "plain.exr"), 0.0);
}

TEST_F(Tool, WarnsThatTheDenoiserHasNoGuides) {
  ASSERT_EQ(run("render good.gradus -o frame.exr --reconstruction l1").code, 0);
  const Outcome made = run(std::string("reconstruct frame.exr -o image.exr") + kFakeDenoiser);
  EXPECT_EQ(made.code, 0);
  EXPECT_NE(made.err.find("warning: the film holds no features"), std::string::npos) << made.err;
}

TEST_F(Tool, ReportsTheContentOfFiles) {
  const Outcome scene = run("info good.gradus");
  EXPECT_EQ(scene.code, 0);
  EXPECT_NE(scene.out.find("triangles                  2"), std::string::npos) << scene.out;
  ASSERT_EQ(run("render good.gradus -o store").code, 0);
  EXPECT_NE(run(std::string("info --json ") + kStored).out.find("\"kind\":\"film\""), std::string::npos);
}

TEST_F(Tool, MeasuresMotion) {
  const Outcome measured = run("motion good.gradus");
  EXPECT_EQ(measured.code, 0) << measured.err;
  EXPECT_NE(measured.out.find("\"steps_in_space\""), std::string::npos) << measured.out;
  EXPECT_EQ(measured.out.find("\"check\""), std::string::npos);
  const Outcome checked = run("motion good.gradus --check 8 --threads 2");
  EXPECT_NE(checked.out.find("\"exist\""), std::string::npos) << checked.err;
  EXPECT_NE(run("motion good.gradus --components 'Sky=EL;Light=EL'").err.find("overlap"), std::string::npos);
}

// Regression: warnings of loading were lost: the picture lacked objects, without a message.
TEST_F(Tool, ReportsObjectsThatASceneHasLost) {
  save_scene("broken.gradus", true);
  const Outcome rendered = run("render broken.gradus -o store");
  EXPECT_EQ(rendered.code, 0);
  EXPECT_NE(rendered.err.find("warning: "), std::string::npos);
  EXPECT_NE(rendered.err.find("mesh that does not exist"), std::string::npos) << rendered.err;
}

TEST_F(Tool, EndsWithACodeAndACause) {
  EXPECT_EQ(run("").code, 2);
  EXPECT_EQ(run("render missing.gradus -o store").code, 2);
  EXPECT_EQ(run("render good.gradus -o store --no-such-option 1").code, 2);
  const std::pair<const char*, const char*> failures[] = {
      {"render good.gradus -o store --integrator path --reconstruction l2", "needs gradients"},
      {"render good.gradus -o store --stats no/such/folder/stats.jsonl", "no/such/folder/stats.jsonl"},
      {"render good.gradus -o good.gradus/store", "good.gradus/store"},
      {"reconstruct good.gradus -o x.exr", "good.gradus"},
      {"render good.gradus -o f.exr --reconstruction none && " GRADUS_BINARY_DIR
       "/native/gradus reconstruct f.exr -o x.exr --reconstruction regularized",
       "no denoising features"},
      {"info err", "neither FILE.gradus nor FILE.exr"}};
  for (const auto& [arguments, cause] : failures) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 1) << arguments;
    EXPECT_NE(outcome.err.find(cause), std::string::npos) << arguments << ": " << outcome.err;
  }
}

// Regression: the picture replaced the samples of the stored film.
TEST_F(Tool, WritesNoPictureOverItsFilm) {
  ASSERT_EQ(run("render good.gradus -o f.exr").code, 0);
  ASSERT_EQ(run("render good.gradus -o other.exr --first-sample 100").code, 0);
  fs::create_symlink("f.exr", folder / "symbolic.exr");
  fs::create_hard_link(folder / "f.exr", folder / "hard.exr");
  fs::create_directory(folder / "sub");
  const std::string frame = text("f.exr"), other = text("other.exr");
  for (const char* arguments :
       {"reconstruct f.exr -o f.exr", "reconstruct f.exr -o sub/../f.exr", "reconstruct f.exr -o symbolic.exr",
        "reconstruct symbolic.exr -o f.exr", "reconstruct f.exr -o hard.exr",
        "reconstruct f.exr --merge other.exr -o other.exr", "render good.gradus -o f.exr --image f.exr",
        "render good.gradus -o new.exr --image sub/../new.exr"}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 2) << arguments;
    EXPECT_NE(outcome.err.find("which it would replace"), std::string::npos) << arguments << ": " << outcome.err;
  }
  EXPECT_EQ(text("f.exr"), frame);
  EXPECT_EQ(text("other.exr"), other);
  EXPECT_FALSE(fs::exists(folder / "new.exr"));
  EXPECT_EQ(run("reconstruct f.exr --merge other.exr -o picture.exr").code, 0);
}

// Regression: bad values ended with the code of a failed render, some after the scene had been read.
TEST_F(Tool, BadValuesAreWrongUsage) {
  ASSERT_EQ(run("render good.gradus -o f.exr --reconstruction none").code, 0);
  for (const char* arguments :
       {"render good.gradus -o store --samples 0", "render good.gradus -o store --samples many",
        "render good.gradus -o store --integrator x", "render good.gradus -o store --region 1,2,3",
        "render good.gradus -o store --passes depth,nonsense", "reconstruct f.exr -o x.exr --reconstruction best",
        "reconstruct f.exr -o x.exr --denoiser yes", "reconstruct f.exr -o x.exr --passes nonsense",
        "reconstruct f.exr -o x.exr --reconstruction l2 --alpha -1",
        "reconstruct f.exr -o x.exr --reconstruction l2 --alpha 1e-9"}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 2) << arguments;
    const std::string given = arguments, last = given.substr(given.rfind("--"));
    EXPECT_NE(outcome.err.find(last.substr(0, last.find(' '))), std::string::npos) << arguments << ": " << outcome.err;
  }
  EXPECT_FALSE(fs::exists(folder / "store"));
  EXPECT_FALSE(fs::exists(folder / "x.exr"));
}

// Regression: such options were ignored without a message.
TEST_F(Tool, NoOptionIsIgnored) {
  ASSERT_EQ(run("render good.gradus -o f.exr --integrator gradient").code, 0);
  for (const char* how : {"auto", "none", "regularized"}) {
    const Outcome outcome = run(std::string("reconstruct f.exr -o x.exr --alpha 0.3 --reconstruction ") + how);
    EXPECT_EQ(outcome.code, 2) << how;
    EXPECT_NE(outcome.err.find("is for --reconstruction l2 or l1"), std::string::npos) << outcome.err;
  }
  EXPECT_EQ(run("reconstruct f.exr -o x.exr --alpha 0.3 --reconstruction l2").code, 0);
  for (const char* command :
       {"render good.gradus -o store --denoiser none", "reconstruct f.exr -o y.exr --denoiser none"}) {
    const Outcome outcome = run(std::string(command) + " --denoiser-path " GRADUS_BINARY_DIR "/tests/libfake_oidn.so");
    EXPECT_EQ(outcome.code, 2) << command;
    EXPECT_NE(outcome.err.find("is for --denoiser oidn or auto"), std::string::npos) << outcome.err;
  }
}

// Returns the letters of each pass's channels in a file; the main image is the pass "".
std::map<std::string, std::set<std::string>> letters_of(const std::string& path) {
  std::map<std::string, std::set<std::string>> letters;
  for (const std::string& name : film_io::image_channels(path)) {
    const size_t dot = name.rfind('.');
    const bool is_main = dot == std::string::npos;
    letters[is_main ? "" : name.substr(0, dot)].insert(is_main ? name : name.substr(dot + 1));
  }
  return letters;
}

// Compositors address channels by their letters, so that images of the tool need those of Blender's files, which
// tests/addon/render_test.py compares with the schema. Regression: values were called V, and vectors RGB.
TEST_F(Tool, ChannelsHaveTheLettersOfTheSchema) {
  ASSERT_EQ(
      run("render good.gradus -o f.exr --image i.exr --passes all --use-decomposition 1 --component-passes all").code,
      0);
  ASSERT_EQ(run("reconstruct f.exr -o again.exr --passes all --component-passes all").code, 0);
  for (const char* image : {"i.exr", "again.exr"}) {
    std::map<std::string, std::set<std::string>> found = letters_of((folder / image).string());
    const auto expect_letters = [&](const std::string& layer, const std::string& letters) {
      std::set<std::string> expected;
      for (const char letter : letters) expected.insert(std::string(1, letter));
      EXPECT_EQ(found[layer], expected) << image << " " << layer;
    };
    expect_letters("", "RGBA");
    for (const schema::PassInfo& info : schema::all_passes()) {
      if (found.contains(info.name)) expect_letters(info.name, info.letters);
    }
    for (const schema::ComponentPassInfo& info : schema::all_component_passes()) {
      const std::string layer = std::string("Path Diffuse ") + info.name;
      if (found.contains(layer)) expect_letters(layer, info.letters);
    }
    for (const char* layer : {"Depth", "Normal", "UV", "Vector", "Error", "Path Diffuse Normal", "Path Diffuse UV"})
      EXPECT_TRUE(found.contains(layer)) << image << " " << layer;
  }
}

// Images of earlier versions have RGB for vectors and V for single values.
TEST_F(Tool, ReadsLayersOfAnyLetters) {
  const std::string path = (folder / "layers.exr").string();
  const std::vector<float> three = {1.0f, 2.0f, 3.0f}, one = {5.0f}, grey = {5.0f, 5.0f, 5.0f};
  film_io::save_image(path, 1, 1,
                      {{"Normal", "XYZ", three},
                       {"Old Normal", "RGB", three},
                       {"UV", "UVA", three},
                       {"Vector", "XYZW", {1.0f, 2.0f, 3.0f, 4.0f}},
                       {"Depth", "Z", one},
                       {"Old Depth", "V", one},
                       {"Layer.Error", "X", one},
                       {"Pair", "XY", {1.0f, 2.0f}}});
  for (const char* layer : {"Normal", "Old Normal", "UV", "Vector"})
    EXPECT_EQ(film_io::load_rgb(path, layer).rgb, three) << layer;
  for (const char* layer : {"Depth", "Old Depth", "Error"})
    EXPECT_EQ(film_io::load_rgb(path, layer).rgb, grey) << layer;
  EXPECT_THROW(film_io::load_rgb(path, "Mist"), Error);
}

// Regression: "all" failed at the first pass that the film does not have.
TEST_F(Tool, AllPassesAreThoseOfTheFilm) {
  ASSERT_EQ(run("render good.gradus -o f.exr --integrator path --reconstruction regularized --passes 'depth, uv'").code,
            0);
  ASSERT_EQ(run("reconstruct f.exr -o all.exr --passes all").code, 0);
  std::vector<std::string> names = film_io::image_channels((folder / "all.exr").string());
  const auto has = [&](const char* name) { return std::find(names.begin(), names.end(), name) != names.end(); };
  for (const char* name : {"R", "Noisy Image.R", "Depth.Z", "UV.U", "Denoising Normal.X", "Error.X"})
    EXPECT_TRUE(has(name)) << name;
  for (const char* name : {"Mist.Z", "Gradient X.R"}) EXPECT_FALSE(has(name)) << name;
  const Outcome outcome = run("reconstruct f.exr -o x.exr --passes depth,mist,gradient_x");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("the film was sampled without mist, gradient_x; it holds combined, noisy_image, depth"),
            std::string::npos)
      << outcome.err;
}

int occurrences(const std::string& text, const std::string& part) {
  int n = 0;
  for (size_t i = text.find(part); i != std::string::npos; i = text.find(part, i + 1)) ++n;
  return n;
}

// Returns the sum of the given layers of a file.
std::vector<float> sum_of_layers(const std::string& path, const std::vector<std::string>& layers) {
  std::vector<float> sum;
  for (const std::string& layer : layers) {
    const std::vector<float> rgb = film_io::load_rgb(path, layer).rgb;
    sum.resize(rgb.size());
    for (size_t i = 0; i < rgb.size(); ++i) sum[i] += rgb[i];
  }
  return sum;
}

const std::vector<std::string> kPaths = {"Path Emission", "Path Diffuse", "Path Reflection", "Path Transmission",
                                         "Path Residual"};

void expect_sum(const std::string& path) {
  const std::vector<float> sum = sum_of_layers(path, kPaths), whole = film_io::load_rgb(path, "").rgb;
  double light = 0.0;
  for (size_t i = 0; i < whole.size(); ++i) {
    ASSERT_NEAR(sum[i], whole[i], 1e-4f + 1e-4f * std::abs(whole[i])) << path;
    light += double(whole[i]);
  }
  EXPECT_GT(light, 0.0);
}

TEST_F(Tool, WritesPassesOfComponents) {
  const std::string image = (folder / "i.exr").string(), again = (folder / "again.exr").string();
  ASSERT_EQ(run("render good.gradus -o f.exr --image i.exr --use-decomposition 1 --component-passes color,normal").code,
            0);
  expect_sum(image);
  EXPECT_NO_THROW(film_io::load_rgb(image, "Path Diffuse Normal"));
  for (const char* how : {"none", "regularized"}) {
    const Outcome made =
        run(std::string("reconstruct f.exr -o again.exr --component-passes all --reconstruction ") + how);
    ASSERT_EQ(made.code, 0) << made.err;
    expect_sum(again);
    for (const char* pass : {" Reflectance", " Irradiance", " Normal"})
      EXPECT_NO_THROW(film_io::load_rgb(again, "Path Diffuse" + std::string(pass)));
  }
  const Outcome missing = run("reconstruct f.exr -o x.exr --component-passes color,motion");
  EXPECT_EQ(missing.code, 1);
  EXPECT_NE(missing.err.find("without motion; there are color, reflectance, irradiance, normal"), std::string::npos)
      << missing.err;
  EXPECT_EQ(run("reconstruct f.exr -o x.exr --component-passes light").code, 2);
  EXPECT_NE(run("reconstruct f.exr -o x.exr --component-passes uv").err.find("without uv"), std::string::npos);
  ASSERT_EQ(run("render good.gradus -o d.exr --use-decomposition 1 --component-passes object_index").code, 0);
  ASSERT_EQ(run("reconstruct d.exr -o details.exr --component-passes all").code, 0);
  const std::vector<std::string> layers = film_io::image_channels((folder / "details.exr").string());
  for (const char* layer :
       {"Path Diffuse UV.V", "Path Diffuse Object Index.X", "Path Diffuse Face Index.X", "Path Diffuse Emit.B"})
    EXPECT_NE(std::find(layers.begin(), layers.end(), layer), layers.end()) << layer;
  EXPECT_EQ(std::find(layers.begin(), layers.end(), "Path Diffuse Normal.X"), layers.end())
      << "its sampling was not requested";
  ASSERT_EQ(run("render good.gradus -o whole.exr").code, 0);
  const Outcome whole = run("reconstruct whole.exr -o x.exr --component-passes color");
  EXPECT_EQ(whole.code, 1);
  EXPECT_NE(whole.err.find("--use-decomposition 1"), std::string::npos) << whole.err;
  EXPECT_FALSE(fs::exists(folder / "x.exr"));
}

// Regression: "cannot load film f.exr: Cannot read image file "f.exr". Unexpected end of file."
TEST_F(Tool, TruncatedFilesAreNamedOnce) {
  ASSERT_EQ(run("render good.gradus -o f.exr").code, 0);
  const auto whole = fs::file_size(folder / "f.exr");
  for (const auto& [size, cause] : {std::pair{uintmax_t{0}, ""},
                                    {uintmax_t{3}, ""},
                                    {uintmax_t{200}, "it is cut short"},
                                    {whole / 2, "it is cut short"},
                                    {whole - 1, ""}}) {
    fs::copy_file(folder / "f.exr", folder / "short.exr", fs::copy_options::overwrite_existing);
    fs::resize_file(folder / "short.exr", size);
    const Outcome outcome = run("reconstruct short.exr -o x.exr");
    EXPECT_EQ(outcome.code, 1) << size;
    EXPECT_NE(outcome.err.find("cannot load film short.exr: "), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find(cause), std::string::npos) << size << ": " << outcome.err;
    EXPECT_EQ(occurrences(outcome.err, "short.exr"), 1) << outcome.err;
  }
  const Outcome scene = run("reconstruct good.gradus -o x.exr");
  EXPECT_NE(scene.err.find("cannot load film good.gradus: it is no OpenEXR file"), std::string::npos) << scene.err;
}

// Regression: an EXR was written under the name of a PNG, with exit code 0.
TEST_F(Tool, RefusesImagesThatAreNotExr) {
  ASSERT_EQ(run("render good.gradus -o frame.exr --reconstruction l1").code, 0);
  std::ofstream(folder / "x.png") << "PNG";
  for (const char* arguments : {"reconstruct frame.exr -o l1.png", "render good.gradus -o store --image l1.png",
                                "compare x.png frame.exr", "compare frame.exr x.png"}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 2) << arguments;
    EXPECT_NE(outcome.err.find("only EXR"), std::string::npos) << arguments << ": " << outcome.err;
  }
  EXPECT_FALSE(fs::exists(folder / "l1.png"));
  EXPECT_FALSE(fs::exists(folder / "store"));
  EXPECT_EQ(run("reconstruct frame.exr -o L1.EXR").code, 0);
}

// Regression: a wrong command only led to "A subcommand is required".
TEST_F(Tool, NamesAnUnknownCommand) {
  const Outcome outcome = run("frobnicate");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.err.find("there is no command or option frobnicate"), std::string::npos) << outcome.err;
}

// A camera that moves sideways over frames 1 to 6, stored in store/anim/layer.
class ToolSequence : public Tool {
 protected:
  void SetUp() override {
    Tool::SetUp();
    render(GRADUS_RECONSTRUCTION_L2);
  }
  // Removes both files of a frame.
  void remove(int frame) const {
    for (const char* part : {".fresh.exr", ".replayed.exr"})
      fs::remove(folder / kFolder / ("f+000000" + std::to_string(frame) + part));
  }
  void render(uint32_t reconstruction, uint32_t samples = 4, bool is_static_scene = false) {
    fs::remove_all(folder / kFolder);
    render({reconstruction, samples, is_static_scene ? 0.0f : 0.02f, is_static_scene});
  }
  struct Job {
    uint32_t reconstruction = GRADUS_RECONSTRUCTION_L2, samples = 4;
    float speed = 0.02f;  // of the camera
    bool brightens = false;
    uint32_t component_passes = 0;
    int32_t first = 1, last = 6;
    uint32_t step = 1;
  };
  void render(const Job& job) {
    delivered.resize(6);
    const GradusDevice device = make_device();
    const GradusScene scene = make_scene(device);
    auto settings = sized<GradusSequenceSettings>();
    const std::string store = (folder / kFolder).string();
    settings.first = job.first;
    settings.last = job.last;
    settings.step = job.step;
    settings.folder = store.c_str();
    GradusSequence sequence = 0;
    ASSERT_OK(gradus_sequence_create(device, &settings, &sequence));
    for (int32_t frame = job.first; frame <= job.last; frame += int32_t(job.step)) {
      ASSERT_OK(set_camera_at(scene, job.speed * float(frame)));
      ASSERT_OK(gradus_scene_commit(scene, nullptr, nullptr));
      GradusSettings render_settings = small_render(24, 16, job.samples);
      render_settings.reconstruction = job.reconstruction;
      if (job.brightens) render_settings.film_exposure = float(frame);
      render_settings.frame = frame;
      render_settings.use_decomposition = job.component_passes != 0 ? 1 : 0;
      render_settings.component_passes = job.component_passes;
      GradusRender render = 0;
      ASSERT_OK(gradus_sequence_sample(sequence, scene, &render_settings, &render));
      ASSERT_OK(gradus_render_wait(render, -1.0));
      ASSERT_OK(gradus_render_release(render));
    }
    for (int32_t frame = job.first; frame <= job.last; frame += int32_t(job.step)) {
      GradusRender render = 0;
      ASSERT_OK(gradus_sequence_deliver(sequence, frame, nullptr, &render));
      ASSERT_OK(gradus_render_wait(render, -1.0));
      std::vector<float>& pixels = delivered[size_t(frame) - 1];
      pixels.resize(24 * 16 * 4);
      ASSERT_OK(gradus_render_read_pass(render, GRADUS_PASS_COMBINED, pixels.data(), pixels.size()));
      ASSERT_OK(gradus_render_release(render));
    }
    ASSERT_OK(gradus_sequence_release(sequence));
    ASSERT_OK(gradus_scene_release(scene));
    ASSERT_OK(gradus_device_release(device));
  }
  std::string stored() const {
    std::string all;
    for (const auto& entry : fs::directory_iterator(folder / kFolder))
      all += text(fs::path(kFolder) / entry.path().filename());
    return all;
  }
  static constexpr const char* kFolder = "store/anim/layer";
  std::vector<std::vector<float>> delivered;
};

TEST_F(ToolSequence, WritesTheDeliveredPictures) {
  const std::string before = stored();
  const Outcome made = run("reconstruct store/anim/layer -o pictures --passes gradient_x");
  ASSERT_EQ(made.code, 0) << made.err;
  EXPECT_NE(made.out.find("pictures/0001.exr"), std::string::npos) << made.out;
  for (int frame = 1; frame <= 6; ++frame) {
    const std::string path = (folder / ("pictures/000" + std::to_string(frame) + ".exr")).string();
    const film_io::LoadedImage picture = film_io::load_rgb(path, "");
    for (size_t i = 0; i < 24 * 16; ++i) {
      for (size_t c = 0; c < 3; ++c)
        ASSERT_EQ(picture.rgb[3 * i + c], delivered[size_t(frame) - 1][4 * i + c]) << frame;
    }
    EXPECT_NO_THROW(film_io::load_rgb(path, "Gradient X"));
  }
  EXPECT_EQ(stored(), before) << "nothing is sampled";
}

TEST_F(ToolSequence, WritesPassesOfComponents) {
  for (const uint32_t how : {GRADUS_RECONSTRUCTION_L2, GRADUS_RECONSTRUCTION_REGULARIZED}) {
    fs::remove_all(folder / kFolder);
    render({.reconstruction = how, .component_passes = (1u << GRADUS_COMPONENT_PASS_COUNT) - 1});
    const Outcome made = run("reconstruct store/anim/layer -o pictures --component-passes all");
    ASSERT_EQ(made.code, 0) << made.err;
    for (int frame = 1; frame <= 6; ++frame) {
      const std::string path = (folder / ("pictures/000" + std::to_string(frame) + ".exr")).string();
      expect_sum(path);
      const std::vector<float> combined = film_io::load_rgb(path, "").rgb;
      for (size_t i = 0; i < 24 * 16; ++i)
        ASSERT_NEAR(combined[3 * i], delivered[size_t(frame) - 1][4 * i], 1e-5f) << frame;
      const std::vector<std::string> names = film_io::image_channels(path);
      for (const char* name : {"Path Diffuse Motion.W", "Path Diffuse Tracked.X", "Path Diffuse Irradiance Tracked.X",
                               "Path Diffuse UV.A", "Path Diffuse Face Index.X"}) {
        EXPECT_NE(std::find(names.begin(), names.end(), name), names.end()) << name;
      }
    }
  }
}

// The neighbours of the requested frames contribute, however a job is divided.
TEST_F(ToolSequence, PartsHaveTheBitsOfTheWhole) {
  ASSERT_EQ(run("reconstruct store/anim/layer -o part --frames 3-4").code, 0);
  EXPECT_FALSE(fs::exists(folder / "part/0002.exr"));
  const film_io::LoadedImage picture = film_io::load_rgb((folder / "part/0003.exr").string(), "");
  for (size_t i = 0; i < 24 * 16; ++i) ASSERT_EQ(picture.rgb[3 * i], delivered[2][4 * i]);
}

TEST_F(ToolSequence, ChangesHowFramesAreReconstructed) {
  for (const char* how : {"--reconstruction l1", "--alpha 0.05", "--window-size 2", "--film-exposure 2"}) {
    const Outcome made = run(std::string("reconstruct store/anim/layer -o other --frames 2 ") + how);
    ASSERT_EQ(made.code, 0) << how << ": " << made.err;
    const film_io::LoadedImage picture = film_io::load_rgb((folder / "other/0002.exr").string(), "");
    double sum = 0.0, delivered_sum = 0.0;
    bool same = true;
    for (size_t i = 0; i < 24 * 16; ++i) {
      same = same && picture.rgb[3 * i] == delivered[1][4 * i];
      sum += double(picture.rgb[3 * i]);
      delivered_sum += double(delivered[1][4 * i]);
    }
    EXPECT_FALSE(same) << how;
    EXPECT_NEAR(sum / delivered_sum, std::string(how) == "--film-exposure 2" ? 2.0 : 1.0, 0.05) << how;
  }
}

// Regression: the overlap was always half of the window, so that animations with another one could not be reproduced.
TEST_F(ToolSequence, WindowsHaveTheRequestedOverlap) {
  const auto picture_with = [&](const std::string& windows) {
    const Outcome made = run("reconstruct store/anim/layer -o other --frames 2 " + windows);
    EXPECT_EQ(made.code, 0) << made.err;
    return film_io::load_rgb((folder / "other/0002.exr").string(), "").rgb;
  };
  EXPECT_EQ(picture_with("--window-size 4 --window-overlap 2"), picture_with("--window-size 4"));
  EXPECT_NE(picture_with("--window-size 4 --window-overlap 0"), picture_with("--window-size 4"));
  const Outcome wrong = run("reconstruct store/anim/layer -o other --window-size 4 --window-overlap 3");
  EXPECT_EQ(wrong.code, 2);
  EXPECT_NE(wrong.err.find("at most half"), std::string::npos) << wrong.err;
}

// Regression: the step of frames 1, 4 and 6 was assumed to be 2, so that frame 4 was left out.
TEST_F(ToolSequence, FramesAtUnevenDistancesAreAllIncluded) {
  for (const int frame : {2, 3, 5}) remove(frame);
  const Outcome outcome = run("reconstruct store/anim/layer -o pictures");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("lacks frames 2 to 3, 5"), std::string::npos) << outcome.err;
  EXPECT_EQ(run("reconstruct store/anim/layer -o pictures --frames 4").code, 0);
}

// Regression: the step of frames 1, 3 and 5 was assumed to be 2, whichever frames they replay, so that the missing
// frames 2 and 4 were not reported.
TEST_F(ToolSequence, MissingReplayedFramesAreReported) {
  for (const int frame : {2, 4, 6}) remove(frame);
  const Outcome outcome = run("reconstruct store/anim/layer -o pictures");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("lacks frames 2, 4:"), std::string::npos) << outcome.err;
}

// Regression: for two workers with a step of 2, the step was assumed to be 1, so that no frame had correspondences to
// the next, and there was no message.
TEST_F(ToolSequence, JobsWithAStepThatShareAFolderHaveTheDeliveredPictures) {
  fs::remove_all(folder / kFolder);
  for (const int32_t first : {1, 2}) {
    Job job;
    job.first = first;
    job.step = 2;
    render(job);
  }
  const Outcome made = run("reconstruct store/anim/layer -o pictures");
  ASSERT_EQ(made.code, 0) << made.err;
  EXPECT_EQ(made.err, "");
  for (int frame = 1; frame <= 6; ++frame) {
    const film_io::LoadedImage picture =
        film_io::load_rgb((folder / ("pictures/000" + std::to_string(frame) + ".exr")).string(), "");
    for (size_t i = 0; i < 24 * 16; ++i) ASSERT_EQ(picture.rgb[3 * i], delivered[size_t(frame) - 1][4 * i]) << frame;
  }
  const Outcome info = run("info --json store/anim/layer");
  EXPECT_NE(info.out.find("\"step\":2,"), std::string::npos) << info.out;
}

TEST_F(ToolSequence, FramesThatReplayOthersThanTheirPredecessorsAreNamed) {
  remove(3);
  Job changed;
  changed.speed = 0.03f;
  changed.first = changed.last = 3;
  render(changed);
  const Outcome made = run("reconstruct store/anim/layer -o pictures");
  EXPECT_EQ(made.code, 0) << made.err;
  EXPECT_NE(made.err.find("warning: frames 4 follow another scene or seed"), std::string::npos) << made.err;
}

// Regression: an automatic denoiser had no effect on frames that were sampled without a denoiser.
TEST_F(ToolSequence, AnAutomaticDenoiserRunsWhereItPays) {
  render(GRADUS_RECONSTRUCTION_REGULARIZED, 32);
  const std::string denoiser = " --denoiser auto --denoiser-path " GRADUS_BINARY_DIR "/tests/libfake_oidn.so";
  const auto picture_with = [&](const std::string& options) {
    const Outcome made = run("reconstruct store/anim/layer -o other --frames 2" + options);
    EXPECT_EQ(made.code, 0) << made.err;
    return film_io::load_rgb((folder / "other/0002.exr").string(), "").rgb;
  };
  EXPECT_NE(picture_with(denoiser), picture_with(""));
}

// Regression: the tool found no denoiser beside Blender, and said nothing.
TEST_F(ToolSequence, TheDenoiserOfBlenderIsFoundAndAMissingOneIsNamed) {
  render(GRADUS_RECONSTRUCTION_REGULARIZED, 32);
  const fs::path blender = folder / "blender-4.5";
  fs::create_directories(blender / "lib");
  fs::create_directories(folder / "bin");
  std::ofstream(blender / "blender") << "#!/bin/sh\n";
  fs::permissions(blender / "blender", fs::perms::owner_all);
  fs::create_symlink(blender / "blender", folder / "bin/blender");
  const auto reconstruct = [&](const std::string& environment, const std::string& options = "") {
    const Outcome made = run("reconstruct store/anim/layer -o other --frames 2" + options, environment);
    EXPECT_EQ(made.code, 0) << made.err;
    return made.err;
  };
  const auto picture = [&] { return film_io::load_rgb((folder / "other/0002.exr").string(), "").rgb; };
  const std::string on_path = "BLENDER= PATH='" + (folder / "bin").string() + "' ",
                    named = "BLENDER='" + (blender / "blender").string() + "' PATH=/nowhere ",
                    note = "note: not denoised: no Open Image Denoise";
  EXPECT_NE(reconstruct(on_path).find(note), std::string::npos);
  EXPECT_EQ(reconstruct(on_path, " --denoiser none").find(note), std::string::npos);
  const auto noisy = picture();
  fs::copy_file(GRADUS_BINARY_DIR "/tests/libfake_oidn.so", blender / "lib/libOpenImageDenoise.so.2");
  for (const std::string& environment : {on_path, named}) {
    EXPECT_EQ(reconstruct(environment).find(note), std::string::npos);
    EXPECT_NE(picture(), noisy) << environment;
  }
}

// Regression: unchanged frames share their files, and had the exposure of the first.
TEST_F(ToolSequence, UnchangedFramesKeepTheirExposure) {
  render(GRADUS_RECONSTRUCTION_L2, 4, true);
  ASSERT_EQ(run("reconstruct store/anim/layer -o pictures").code, 0);
  const auto value_of = [&](int frame) {
    return film_io::load_rgb((folder / ("pictures/000" + std::to_string(frame) + ".exr")).string(), "").rgb[600];
  };
  ASSERT_GT(value_of(1), 0.0f);
  EXPECT_NEAR(value_of(4), 4.0f * value_of(1), 1e-3f * value_of(1));
}

// Regression: a still had the file name of the fresh half of an animation's frame, and replaced it.
TEST_F(ToolSequence, AStillBesideAnAnimationDoesNotChangeIt) {
  for (const char* part : {".fresh.exr", ".replayed.exr"}) {
    fs::copy_file(folder / kFolder / (std::string("f+0000001") + part),
                  folder / kFolder / (std::string("f+0000000") + part));
  }
  const std::string before = stored();
  fs::create_directories(folder / "stills/good");
  fs::create_directory_symlink(folder / kFolder, folder / "stills/good/ViewLayer");
  const Outcome still = run("render good.gradus -o stills");  // of frame 0
  ASSERT_EQ(still.code, 0) << still.err;
  EXPECT_TRUE(fs::remove(folder / kFolder / "f+0000000.exr"));
  EXPECT_EQ(stored(), before);
}

// AUTO means plain paths with features.
TEST_F(ToolSequence, WritesWhatAutoDelivered) {
  render(GRADUS_RECONSTRUCTION_AUTO);
  const Outcome made = run("reconstruct store/anim/layer -o pictures --passes all");
  ASSERT_EQ(made.code, 0) << made.err;
  const film_io::LoadedImage picture = film_io::load_rgb((folder / "pictures/0004.exr").string(), "");
  for (size_t i = 0; i < 24 * 16; ++i) ASSERT_EQ(picture.rgb[3 * i], delivered[3][4 * i]);
  const Outcome l2 = run("reconstruct store/anim/layer -o other --reconstruction l2");
  EXPECT_EQ(l2.code, 1);
  EXPECT_NE(l2.err.find("hold no gradients"), std::string::npos) << l2.err;
}

// Earlier versions had other names for the two files of a frame.
TEST_F(ToolSequence, ReadsFilesOfEarlierVersions) {
  ASSERT_EQ(run("reconstruct store/anim/layer -o now").code, 0);
  for (int frame = 1; frame <= 6; ++frame) {
    const std::string name = (folder / kFolder / ("f+000000" + std::to_string(frame))).string();
    fs::rename(name + ".fresh.exr", name + ".base.exr");
    fs::rename(name + ".replayed.exr", name + ".offset.exr");
  }
  ASSERT_EQ(run("info store/anim/layer").code, 0);
  const Outcome made = run("reconstruct store/anim/layer -o earlier");
  ASSERT_EQ(made.code, 0) << made.err;
  for (int frame = 1; frame <= 6; ++frame) {
    const std::string name = "/000" + std::to_string(frame) + ".exr";
    EXPECT_EQ(text("earlier" + name), text("now" + name));
  }
}

TEST_F(ToolSequence, NamesMissingFrames) {
  fs::remove(folder / kFolder / "f+0000003.fresh.exr");
  fs::remove(folder / kFolder / "f+0000005.replayed.exr");
  const Outcome outcome = run("reconstruct store/anim/layer -o pictures");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("store/anim/layer lacks frames 3, 5"), std::string::npos) << outcome.err;
  EXPECT_FALSE(fs::exists(folder / "pictures"));
  EXPECT_EQ(run("reconstruct store/anim/layer -o pictures --frames 1-2").code, 0);
  const Outcome beyond = run("reconstruct store/anim/layer -o pictures --frames 6-9");
  EXPECT_NE(beyond.err.find("lacks frames 7 to 9"), std::string::npos) << beyond.err;
  const Outcome info = run("info store/anim/layer");
  EXPECT_EQ(info.code, 1) << info.err;
  EXPECT_NE(info.out.find("\"sequence\""), std::string::npos) << info.out;
  EXPECT_NE(info.out.find("\"3, 5\""), std::string::npos) << info.out;
  for (const char* file : {"f+0000003.fresh.exr", "f+0000005.replayed.exr"})
    EXPECT_NE(info.out.find(std::string(file) + " "), std::string::npos) << info.out;
  EXPECT_EQ(occurrences(info.out, "\"it is missing\""), 2) << info.out;
  for (const int frame : {3, 5}) remove(frame);
  EXPECT_EQ(run("info store/anim/layer").code, 0) << "a gap is no damage: there may be more jobs to come";
}

// Regression: `info` counted the files only; damaged ones were reported after all had been reconstructed.
TEST_F(ToolSequence, InfoNamesDamagedFiles) {
  using Json = nlohmann::json;
  const auto info = [&](int code) {
    const Outcome outcome = run("info --json store/anim/layer");
    EXPECT_EQ(outcome.code, code) << outcome.err;
    return Json::parse(outcome.out);
  };
  EXPECT_EQ(info(0).at("damaged"), Json::object());
  const fs::path store = folder / kFolder;
  fs::resize_file(store / "f+0000002.fresh.exr", fs::file_size(store / "f+0000002.fresh.exr") / 2);
  fs::resize_file(store / "f+0000004.replayed.exr", 0);
  std::ofstream(store / "f+0000006.json") << "{";
  {
    std::fstream file(store / "f+0000005.fresh.exr", std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(-200, std::ios::end);
    file << std::string(100, 'x');  // the size is right
  }
  const Json found = info(1), &damaged = found.at("damaged");
  EXPECT_EQ(damaged.size(), 4u) << damaged;
  EXPECT_EQ(damaged.at("f+0000002.fresh.exr"), "it is cut short");
  EXPECT_NE(damaged.at("f+0000005.fresh.exr"), "");
  EXPECT_NE(damaged.at("f+0000006.json"), "");
  EXPECT_EQ(damaged.at("f+0000004.replayed.exr").get<std::string>().find("f+0000004"), std::string::npos)
      << "named once";
  EXPECT_EQ(found.at("frames"), 3);
  EXPECT_EQ(found.at("missing"), "2, 4 to 5");
  for (int frame = 1; frame <= 6; ++frame)
    fs::resize_file(store / ("f+000000" + std::to_string(frame) + ".fresh.exr"), 100);
  EXPECT_EQ(info(1).at("frames"), 0);
}

// A frame of another view layer has the name of one of this layer.
TEST_F(ToolSequence, RefusesFramesThatDoNotFit) {
  ASSERT_EQ(run("render good.gradus -o f.exr --width 20 --integrator gradient").code, 0);
  for (const char* part : {"fresh", "replayed"}) {
    fs::copy_file(folder / "f.exr", folder / kFolder / (std::string("f+0000004.") + part + ".exr"),
                  fs::copy_options::overwrite_existing);
  }
  const Outcome outcome = run("reconstruct store/anim/layer -o pictures");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("has another size"), std::string::npos) << outcome.err;
}

TEST_F(ToolSequence, WrongUsageIsNamed) {
  ASSERT_EQ(run("render good.gradus -o still").code, 0);
  std::ofstream(folder / "file") << "no folder";
  const std::string before = stored();
  const std::tuple<const char*, int, const char*> wrong[] = {
      {"store/anim/layer -o store/anim/../anim/layer", 2, "which it would replace"},
      {"store/anim/layer -o file", 2, "is not a folder"},
      {"store/anim/layer -o p --frames 3-1", 2, "ends before it begins"},
      {"store/anim/layer -o p --frames all", 2, "expected FIRST-LAST"},
      {"store/anim/layer -o p --merge file", 2, "is for single frames"},
      {"store/anim/layer -o p --alpha 0.1 --reconstruction regularized", 2, "is for --reconstruction"},
      {"store/anim/layer -o p --reconstruction none", 2, "--passes noisy_image"},
      {"still/good/ViewLayer -o p", 1, "none of a sequence"},
      {"store -o p", 1, "holds no stored films: try "},
      {"store -o p", 1, "store/anim/layer\n"},
      {"still/good/ViewLayer/f+0000000.exr -o p.exr --frames 1-2", 2, "is for folders"},
      {"still/good/ViewLayer/f+0000000.exr -o p.exr --window-size 4", 2, "is for folders"},
  };
  for (const auto& [arguments, code, cause] : wrong) {
    const Outcome outcome = run(std::string("reconstruct ") + arguments);
    EXPECT_EQ(outcome.code, code) << arguments;
    EXPECT_NE(outcome.err.find(cause), std::string::npos) << arguments << ": " << outcome.err;
  }
  EXPECT_EQ(stored(), before);
  EXPECT_FALSE(fs::exists(folder / "p"));
}

}  // namespace
}  // namespace gradus::tool_test
