#include "common.h"

#include <cstdio>
#include <filesystem>
#include <sstream>

#include "component_layers.h"
#include "schema/options.h"

namespace gradus::tool {
namespace {

namespace fs = std::filesystem;

std::string describe(const GradusOptionInfo& info) {
  std::ostringstream text;
  text << info.doc;
  if (info.type == GRADUS_OPTION_ENUM) {
    const std::string name =
        schema::choice_name(*schema::find_option(info.name), static_cast<uint32_t>(info.default_value));
    text << " (" << info.choices << "; default " << name << ")";
  } else {
    text << " (default " << info.default_value << ")";
  }
  return text.str();
}

bool is_same_file(const fs::path& a, const fs::path& b) {
  std::error_code none;
  if (fs::equivalent(a, b, none)) return true;
  const fs::path name = fs::weakly_canonical(fs::absolute(a), none);  // either file may not exist yet
  return !name.empty() && name == fs::weakly_canonical(fs::absolute(b), none);
}

void parse_region(const std::string& text, GradusSettings* settings) {
  const std::vector<std::string> parts = split(text);
  if (parts.size() != 4)
    throw client::Error(GRADUS_ERROR_INVALID_ARGUMENT, "region = " + text + ": expected x0,y0,x1,y1");
  for (size_t i = 0; i < 4; ++i) {
    if (parts[i].empty() || parts[i].find_first_not_of("0123456789") != std::string::npos || parts[i].size() > 9) {
      throw client::Error(GRADUS_ERROR_INVALID_ARGUMENT, "region = " + text + ": expected four numbers of pixels");
    }
    settings->region[i] = static_cast<uint32_t>(std::stoul(parts[i]));
  }
}

}  // namespace

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, ',');) {
    const size_t begin = part.find_first_not_of(' '), end = part.find_last_not_of(' ');
    parts.push_back(begin == std::string::npos ? "" : part.substr(begin, end + 1 - begin));
  }
  return parts;
}

std::string canonical(std::string text) {
  for (char& c : text) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    if (c == ' ' || c == '-') c = '_';
  }
  return text;
}

void OptionFlags::add_to(CLI::App* command) {
  for (uint32_t i = 0; i < gradus_option_count(); ++i) {
    auto info = client::make<GradusOptionInfo>();
    client::check(gradus_option(i, &info));
    flags_.push_back(std::make_unique<Flag>(Flag{info.name, ""}));
    std::string name = info.name;
    for (char& c : name) c = c == '_' ? '-' : c;
    command->add_option("--" + name, flags_.back()->value, describe(info))
        ->type_name("VALUE")
        ->group("Render options")
        ->check([option = flags_.back()->name](const std::string& value) { return bad_value(option, value); });
  }
  command->add_option("--region", region_, "Part to render: x0,y0,x1,y1 in pixels, y up, upper bounds exclusive")
      ->group("Render options")
      ->check([](const std::string& text) {
        GradusSettings settings{};
        return refusal([&] { parse_region(text, &settings); });
      });
  command->add_option("--passes", passes_, "Passes besides Combined, separated by commas, or all")
      ->group("Render options")
      ->check(bad_passes);
  command
      ->add_option("--component-passes", component_passes_,
                   "Passes of the components of --use-decomposition, separated by commas, or all")
      ->group("Render options")
      ->check(bad_component_passes);
}

void OptionFlags::apply(GradusSettings* settings) const {
  for (const auto& flag : flags_) {
    if (!flag->value.empty()) client::check(gradus_settings_parse(settings, flag->name.c_str(), flag->value.c_str()));
  }
  if (!region_.empty()) parse_region(region_, settings);
  if (!passes_.empty()) settings->passes = parse_passes(passes_);
  if (!component_passes_.empty()) settings->component_passes = parse_component_passes(component_passes_);
}

PassNames pass_names() {
  return {GRADUS_PASS_COUNT, [](uint32_t pass) { return canonical(client::pass_name(pass)); }, "there is no pass ",
          "; there are "};
}

uint64_t parse_passes(const std::string& text) { return 1 | parse_names(pass_names(), text); }

std::string exr_only(const std::string& path) {
  const std::string ending = canonical(std::filesystem::path(path).extension().string());
  return ending == ".exr" ? "" : path + ": only EXR images are read and written, FILE.exr";
}

std::string bad_value(const std::string& option, const std::string& value) {
  return refusal([&] {
    GradusSettings settings = client::default_settings();
    client::check(gradus_settings_parse(&settings, option.c_str(), value.c_str()));
    schema::check_alpha(settings.reconstruction_alpha);
  });
}

std::string bad_passes(const std::string& text) {
  return refusal([&] { parse_passes(text); });
}

void check_apart(const std::string& option, const std::string& written, const std::string& kept) {
  if (is_same_file(written, kept))
    throw CLI::ValidationError(option, written + " is " + kept + ", which it would replace");
}

uint32_t parse_choice(const std::string& option, const std::string& value) {
  GradusSettings settings = client::default_settings();
  client::check(gradus_settings_parse(&settings, option.c_str(), value.c_str()));
  return option == "denoiser" ? settings.denoiser : settings.reconstruction;
}

void print_warnings(const client::Device& device) {
  for (std::string text = device.warning(); !text.empty(); text = device.warning())
    std::fprintf(stderr, "warning: %s\n", text.c_str());
}

void print_warnings(const client::Device& device, const client::Scene& scene) {
  print_warnings(device);
  for (std::string text = scene.warning(); !text.empty(); text = scene.warning())
    std::fprintf(stderr, "warning: %s\n", text.c_str());
}

}  // namespace gradus::tool
