// Helper functions that the subcommands of the tool share.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "gradus/gradus.hpp"
#include "pass_names.h"

namespace gradus::tool {

inline constexpr int kExitFailure = 1;
inline constexpr int kExitUsage = 2;
inline constexpr int kExitInterrupted = 130;  // exit code of shells for SIGINT

// Each function adds its subcommand to `app`. The subcommand sets *exit_code to the exit code of the program.
void add_render(CLI::App* app, int* exit_code);
void add_reconstruct(CLI::App* app, int* exit_code);
void add_compare(CLI::App* app, int* exit_code);
void add_info(CLI::App* app, int* exit_code);
void add_motion(CLI::App* app, int* exit_code);

// Command-line flags for all render options of the library. apply() overwrites the settings that the user gave.
class OptionFlags {
 public:
  // Adds a flag for each option of the library to the command.
  void add_to(CLI::App* command);
  void apply(GradusSettings* settings) const;

 private:
  struct Flag {
    std::string name, value;
  };
  std::vector<std::unique_ptr<Flag>> flags_;
  std::string region_, passes_, component_passes_;
};

// Splits a text at commas and removes the spaces around each item.
std::vector<std::string> split(const std::string& text);
// Returns a name in the form that users type: in lower case and with '_'.
std::string canonical(std::string text);
// Returns the message of the exception that a parser throws, or "" if it throws none.
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
// Parses names as parse_names() does and adds Combined to the mask.
uint64_t parse_passes(const std::string& text);
// Returns an error text, for CLI::Option::check, if a file name does not end in .exr, the only format that the tool
// reads and writes. Otherwise returns "".
std::string exr_only(const std::string& path);
// Return an error text, for CLI::Option::check, for an invalid option value or pass name. Otherwise return "".
std::string bad_value(const std::string& option, const std::string& value);
std::string bad_passes(const std::string& text);
// Returns the enum value of `reconstruction` or `denoiser`. Throws the library's error if the value is invalid.
uint32_t parse_choice(const std::string& option, const std::string& value);

// Throws CLI::ValidationError, which counts as wrong usage, if `written` and `kept` are the same file, also through
// links.
void check_apart(const std::string& option, const std::string& written, const std::string& kept);

void print_warnings(const client::Device& device);
void print_warnings(const client::Device& device, const client::Scene& scene);

}  // namespace gradus::tool
