#include "denoiser_place.h"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "gradus/gradus.h"
#include "output/oidn_library.h"

namespace gradus::tool {
namespace {

namespace fs = std::filesystem;

bool is_program(const fs::path& path) {
  std::error_code none;
  return fs::is_regular_file(path, none) && access(path.c_str(), X_OK) == 0;
}

// Returns the program that BLENDER names, else the first `blender` on PATH, without links; "" if there is none.
fs::path blender() {
  std::error_code none;
  const char *named = std::getenv("BLENDER"), *searched = std::getenv("PATH");
  if (named != nullptr && is_program(named)) return fs::canonical(named, none);
  std::istringstream folders(searched != nullptr ? searched : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (const fs::path path = fs::path(folder) / "blender"; is_program(path)) return fs::canonical(path, none);
  }
  return {};
}

}  // namespace

void add_denoiser_path(CLI::App* command, std::string* path) {
  command->add_option("--denoiser-path", *path,
                      "libOpenImageDenoise.so.2 or the folder that holds it, where neither the system nor the Blender "
                      "that BLENDER names or that is on PATH has it");
}

void check_denoiser_path(const std::string& path, uint32_t denoiser) {
  if (path.empty() || denoiser != GRADUS_DENOISER_NONE) return;
  throw CLI::ValidationError("--denoiser-path", "is for --denoiser oidn or auto");
}

std::string denoiser_place(const std::string& path) {
  if (!path.empty()) return path;
  const fs::path program = blender();
  const fs::path folder = program.parent_path() / "lib";
  std::error_code none;
  return !program.empty() && fs::exists(folder / output::OidnPlaces{}.soname, none) ? folder.string() : "";
}

std::string missing_denoiser(const std::string& place) {
  std::string why_not;
  return output::find_oidn({place}, &why_not) ? "" : why_not;
}

void print_not_denoised(const std::string& why) { std::fprintf(stderr, "note: not denoised: %s\n", why.c_str()); }

}  // namespace gradus::tool
