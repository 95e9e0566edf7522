// What the subcommands of the tool share.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "gradus/gradus.hpp"
#include "pass_names.h"

namespace gradus::tool {

inline constexpr int kExitFailure = 1;
inline constexpr int kExitUsage = 2;
inline constexpr int kExitInterrupted = 130;  // as shells report SIGINT

// Each adds its subcommand to `app`; *exit_code is what the program ends with.
void add_render(CLI::App* app, int* exit_code);
void add_reconstruct(CLI::App* app, int* exit_code);
void add_compare(CLI::App* app, int* exit_code);
void add_info(CLI::App* app, int* exit_code);
void add_motion(CLI::App* app, int* exit_code);

// Render options from the library's own table: what the user gave overlays settings.
class OptionFlags {
 public:
  // `skipped`: names that the subcommand has another meaning for.
  void add_to(CLI::App* command);
  void apply(GradusSettings* settings) const;

 private:
  struct Flag {
    std::string name, value;
  };
  std::vector<std::unique_ptr<Flag>> flags_;
  std::string region_, passes_, component_passes_;
};

// Parts between commas, without the spaces around them.
std::vector<std::string> split(const std::string& text);
// As names are typed: in lower case and with '_'.
std::string canonical(std::string text);
// What a parser throws; "": nothing.
template <class Parse>
std::string refusal(const Parse& parse) {
  try {
    parse();
    return "";
  } catch (const std::exception& e) {
    return e.what();
  }
}

inline constexpr uint64_t kAllPasses = (uint64_t{1} << GRADUS_PASS_COUNT) - 1;
PassNames pass_names();
// As parse_names(); Combined is always among them.
uint64_t parse_passes(const std::string& text);
// For CLI::Option::check: what is wrong with a file name that does not end in .exr, the only format that the tool reads
// and writes.
std::string exr_only(const std::string& path);
// The same of values for the library's options, and of names of passes.
std::string bad_value(const std::string& option, const std::string& value);
std::string bad_passes(const std::string& text);
// Value of `reconstruction` or `denoiser`; throws as the library does.
uint32_t parse_choice(const std::string& option, const std::string& value);

// Both throw CLI::ValidationError, which is wrong usage. The first where `written` is the file `kept`, by whatever name
// or link.
void check_apart(const std::string& option, const std::string& written, const std::string& kept);
void check_denoiser_path(const std::string& path, uint32_t denoiser);

// Adds --denoiser-path, for what client::Device takes.
void add_denoiser_path(CLI::App* command, std::string* path);

void print_warnings(const client::Device& device);
void print_warnings(const client::Device& device, const client::Scene& scene);

}  // namespace gradus::tool
