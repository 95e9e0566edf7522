// Where the tool looks for Open Image Denoise.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace gradus::tool {

// Adds the option --denoiser-path. denoiser_place() completes its value.
void add_denoiser_path(CLI::App* command, std::string* path);
// Throws CLI::ValidationError, which counts as wrong usage, if a path is given although no denoiser is used.
void check_denoiser_path(const std::string& path, uint32_t denoiser);
// Returns `path`, or if it is empty, the libraries of the Blender that BLENDER names or that is on PATH, as the add-on
// uses those of its Blender. Returns "" if that Blender has no such library.
std::string denoiser_place(const std::string& path);
// Returns why the denoiser AUTO does nothing where it would, or "" if a denoiser is found at `place` or on this system.
std::string missing_denoiser(const std::string& place);
// Says on stderr that pictures are not denoised that AUTO would denoise, and why.
void print_not_denoised(const std::string& why);

}  // namespace gradus::tool
