// gradus reconstruct FOLDER -o FOLDER
#include <array>
#include <cstdio>
#include <filesystem>
#include <map>
#include <regex>
#include <set>

#include <nlohmann/json.hpp>

#include "animation/sequence_folder.h"
#include "component_layers.h"
#include "denoiser_place.h"
#include "film_io/image_exr.h"
#include "film_io/store.h"
#include "reconstruct.h"
#include "reconstruct/space_time/window_grid.h"
#include "schema/pass_table.h"
#include "stored_sequence.h"

namespace gradus::tool {
namespace {

namespace fs = std::filesystem;

struct Range {
  int32_t first, last;
};

// Parses the option --frames. The text "" stands for all stored frames.
Range range_of(const std::string& text, const StoredSequence& stored) {
  if (text.empty()) return {stored.frames().front(), stored.frames().back()};
  std::smatch match;
  if (!std::regex_match(text, match, std::regex("(-?[0-9]{1,7})(?:-(-?[0-9]{1,7}))?"))) {
    throw CLI::ValidationError("--frames", text + ": expected FIRST-LAST, or one frame");
  }
  const Range range{std::stoi(match[1]), std::stoi(match[match[2].matched ? 2 : 1])};
  if (range.last < range.first) throw CLI::ValidationError("--frames", text + " ends before it begins");
  return range;
}

// Returns the file name of a picture, as Blender names it.
std::string picture_path(const std::string& folder, int32_t frame) {
  std::array<char, 24> name{};
  std::snprintf(name.data(), name.size(), frame < 0 ? "%05d.exr" : "%04d.exr", frame);
  return (fs::path(folder) / name.data()).string();
}

reconstruct::WindowShape windows_of(const ReconstructArguments& args) {
  reconstruct::WindowShape windows;
  if (args.window_size) windows = {int(*args.window_size), int(*args.window_size / 2)};
  if (args.window_overlap) windows.overlap = int(*args.window_overlap);
  return windows;
}

void check_usage(const ReconstructArguments& args) {
  if (args.reconstruction == "none")
    throw CLI::ValidationError("--reconstruction", "none is for single frames; --passes noisy_image writes it");
  check_apart("--output", args.output, args.input);
  const reconstruct::WindowShape windows = windows_of(args);
  if (windows.overlap > windows.frames / 2)
    throw CLI::ValidationError("--window-overlap", "windows share at most half of their frames");
  if (fs::exists(args.output) && !fs::is_directory(args.output)) {
    throw CLI::ValidationError("--output",
                               args.output + " is not a folder, which the pictures of " + args.input + " need");
  }
}

// Returns the settings for the pictures: the stored settings of a frame, changed by the arguments.
GradusSettings settings_of(const ReconstructArguments& args, const GradusSettings& stored) {
  GradusSettings settings = stored;
  const bool changed = args.reconstruction != "auto";
  if (changed) settings.reconstruction = parse_choice("reconstruction", args.reconstruction);
  if (changed || args.alpha != 0.0f) settings.reconstruction_alpha = args.alpha;
  if (args.exposure >= 0.0) settings.film_exposure = float(args.exposure);
  settings.denoiser = parse_choice("denoiser", args.denoiser);
  return settings;
}

client::Sequence open(const client::Device& device, const ReconstructArguments& args, const StoredSequence& stored,
                      const Range& range, bool with_flow) {
  auto settings = client::make<GradusSequenceSettings>();
  settings.first = range.first;
  settings.last = range.last;
  settings.step = uint32_t(stored.step());
  const reconstruct::WindowShape windows = windows_of(args);
  settings.window_size = uint32_t(windows.frames);
  settings.window_overlap = uint32_t(windows.overlap);
  settings.folder = stored.folder().c_str();
  settings.with_flow = with_flow ? 1 : 0;
  return client::Sequence(device, settings);
}

uint64_t passes_of(const ReconstructArguments& args, const std::string& path) {
  if (args.passes.empty()) return 1;
  const std::shared_ptr<const film::Film> first = film_io::load_film(path);
  const film::Film& film = *first;
  const uint64_t requested = parse_passes(args.passes), held = available_passes(film, requested);
  const bool has_error = schema::has_bit(film.settings.passes,
                                         GRADUS_PASS_ERROR);  // the error is estimated only if the render requested it
  return requested == kAllPasses && !has_error ? held & ~(uint64_t{1} << GRADUS_PASS_ERROR) : held;
}

// Returns the settings in the files of all frames. Throws Error if the frames differ in size, because they then belong
// to different animations.
std::map<int32_t, GradusSettings> settings_of_files(const StoredSequence& stored,
                                                    const std::vector<std::vector<int32_t>>& chains) {
  const int32_t first = chains.front().front();
  std::map<int32_t, GradusSettings> all;
  for (const std::vector<int32_t>& chain : chains) {
    for (const int32_t frame : chain) {
      const GradusSettings& settings = all[frame] = film_io::load_header(stored.path(frame)).settings;
      if (settings.width == all[first].width && settings.height == all[first].height) continue;
      throw client::Error(GRADUS_ERROR_INVALID_ARGUMENT,
                          stored.path(frame) + " has another size than " + stored.path(first));
    }
  }
  return all;
}

struct PassesToWrite {
  uint64_t passes;
  uint32_t of_components;
};

void write_picture(const client::Render& render, const PassesToWrite& wanted, const GradusSettings& settings,
                   const std::string& path) {
  const auto [width, height] = render.film().size();
  std::vector<film_io::ImageLayer> layers;
  for (uint32_t pass = 0; pass < GRADUS_PASS_COUNT; ++pass) {
    if ((wanted.passes >> pass & 1) == 0) continue;
    const schema::PassInfo& info = schema::pass_info(pass);
    layers.push_back(
        {pass == GRADUS_PASS_COMBINED ? "" : info.name, info.letters, render.read_pass(pass, size_t(width) * height)});
  }
  const auto read = [&](const char* component, uint32_t pass, std::vector<float>* pixels) {
    client::check(gradus_render_read_component(render.id(), component, pass, pixels->data(), pixels->size()));
  };
  add_component_layers(settings, wanted.of_components, size_t(width) * height, read, &layers);
  film_io::save_image(path, int(width), int(height), layers);
}

// The arguments of a run that are the same for all frames of a folder.
struct Job {
  const ReconstructArguments& args;
  const StoredSequence& stored;
  const client::Device& device;
  const std::map<int32_t, GradusSettings>& of_files;
  PassesToWrite wanted;
  std::string missing_denoiser;  // denoiser_place.h
};

// What is said after the last picture, each text once.
struct Remarks {
  std::set<std::string> warnings;
  std::string not_denoised;  // why the denoiser AUTO did not denoise a picture that it would; empty: it did
};

// Writes the pictures of one chain of frames.
void write_chain(const Job& job, const std::vector<int32_t>& frames, Remarks* remarks) {
  const client::Sequence sequence = open(job.device, job.args, job.stored, {frames.front(), frames.back()},
                                         need_two_frames(job.wanted.of_components));
  const animation::SequenceFolder folder(job.args.input);
  for (const int32_t frame : frames) {
    // Settings of the picture, such as the exposure, may differ between frames, also if the frames share their files.
    GradusSettings settings = settings_of(job.args, folder.settings(frame).value_or(job.of_files.at(frame)));
    settings.component_passes = job.wanted.of_components;
    const client::Render render = sequence.deliver(frame, settings);
    render.wait();
    const nlohmann::json stats = nlohmann::json::parse(render.stats());
    for (const auto& text : stats.at("warnings")) remarks->warnings.insert(text.get<std::string>());
    const std::string skipped = stats.at("plan").at("skipped").value("denoiser", "");
    if (!skipped.empty() && skipped == job.missing_denoiser) remarks->not_denoised = skipped;
    const std::string path = picture_path(job.args.output, frame);
    write_picture(render, job.wanted, settings, path);
    std::printf("%s\n", path.c_str());
    std::fflush(stdout);
  }
}

}  // namespace

int reconstruct_sequence(const ReconstructArguments& args) {
  check_usage(args);
  const StoredSequence stored(args.input);
  const Range requested = range_of(args.frames, stored);
  const std::vector<std::vector<int32_t>> chains = stored.chains(requested.first, requested.last);
  const std::string missing = stored.missing(requested.first, requested.last),
                    unrelated = stored.unrelated(requested.first, requested.last);
  if (chains.empty())
    throw client::Error(GRADUS_ERROR_INVALID_ARGUMENT, args.input + " holds none of the frames " + args.frames);
  if (!missing.empty()) {
    throw client::Error(GRADUS_ERROR_INVALID_ARGUMENT,
                        args.input + " lacks frames " + missing + ": sample them, or leave them out by --frames");
  }
  const std::map<int32_t, GradusSettings> of_files = settings_of_files(stored, chains);
  const std::string first = stored.path(chains.front().front());
  const uint32_t of_components =
      available_component_passes(film_io::load_header(first), parse_component_passes(args.component_passes));
  const PassesToWrite wanted{passes_of(args, first), of_components};
  const std::string place = denoiser_place(args.denoiser_path);
  const client::Device device(0, nullptr, place.c_str());
  fs::create_directories(args.output);
  Remarks remarks;
  if (!unrelated.empty())
    remarks.warnings.insert("frames " + unrelated +
                            " follow another scene or seed than that of the stored frames before them: they are not "
                            "joined with those");
  for (const std::vector<int32_t>& chain : chains)
    write_chain({args, stored, device, of_files, wanted, missing_denoiser(place)}, chain, &remarks);
  for (const std::string& text : remarks.warnings) std::fprintf(stderr, "warning: %s\n", text.c_str());
  if (!remarks.not_denoised.empty()) print_not_denoised(remarks.not_denoised);
  print_warnings(device);
  return 0;
}

}  // namespace gradus::tool
