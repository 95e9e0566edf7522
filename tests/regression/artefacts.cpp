#include "regression/artefacts.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "color/color.h"
#include "frame/image_exr.h"
#include "regression/pictures.h"
#include "support/image_files.h"

namespace gradus::regression {

namespace {

const float* block_of(const std::vector<float>& means, uint32_t x, uint32_t y) {
  return means.data() + 3 * (size_t(y / kBlock) * (kWidth / kBlock) + x / kBlock);
}

void save_strip(const std::string& path, const std::vector<float>& reference, const std::vector<float>& rgba) {
  const std::vector<float> blocks = block_means(rgba);
  const auto color = [&](float u, float v) {
    const uint32_t column = uint32_t(u * 3 * kWidth), x = column % kWidth, y = uint32_t(v * kHeight);
    const float *stored = block_of(reference, x, y), *found = block_of(blocks, x, y), *pixel = rgba.data() + 4 * (size_t(y) * kWidth + x);
    Vec4 result(1.0f);
    for (int c = 0; c < 3; ++c) {
      const float values[] = {stored[c], pixel[c], 16.0f * std::fabs(found[c] - stored[c])};
      result[c] = linear_to_srgb(std::max(0.0f, values[column / kWidth]));
    }
    return result;
  };
  const testing::FileBytes png = testing::make_png(3 * kWidth, kHeight, color);
  std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(png.data()), std::streamsize(png.size()));
}

}  // namespace

double relative_error(const std::vector<float>& reference, const std::vector<float>& blocks) {
  double sum = 0.0;
  for (size_t i = 0; i < reference.size(); i += 3) {
    const double gray = (double(reference[i]) + reference[i + 1] + reference[i + 2]) / 3.0;
    for (size_t c = 0; c < 3; ++c) sum += std::pow(double(blocks[i + c]) - reference[i + c], 2) / (1e-3 + gray * gray);
  }
  return sum / double(reference.size());
}

std::string keep(const std::string& name, const std::vector<float>& reference, const std::vector<float>& rgba) {
  std::string path = GRADUS_BINARY_DIR "/pictures/";
  std::filesystem::create_directories(path);
  for (const char letter : name) path += letter == ' ' ? '_' : letter;
  save_image(path + ".exr", int(kWidth), int(kHeight), {{"", 4, rgba}});
  save_strip(path + ".png", reference, rgba);
  return path + ".png";
}

}  // namespace gradus::regression
