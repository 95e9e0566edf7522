#include "regression/artefacts.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "film_io/image_exr.h"
#include "image/color.h"
#include "regression/pictures.h"
#include "support/image_files.h"

namespace gradus::regression {

namespace {

namespace fs = std::filesystem;

const fs::path kFolder = fs::path(GRADUS_BINARY_DIR) / "pictures";

// Returns the file in which save_reference() saves the picture with these bits.
fs::path reference_file(const std::string& bits) { return kFolder / "stored" / (bits + ".exr"); }

void save(const fs::path& path, const std::vector<float>& rgba) {
  fs::create_directories(path.parent_path());
  film_io::save_image(path, int(kWidth), int(kHeight), {{"", "RGBA", rgba}});
}

std::vector<float> without_alpha(const std::vector<float>& rgba) {
  std::vector<float> rgb;
  for (size_t i = 0; i < rgba.size(); ++i) {
    if (i % 4 != 3) rgb.push_back(rgba[i]);
  }
  return rgb;
}

// Returns an RGB picture that shows the mean of its block in each pixel.
std::vector<float> block_picture(const std::vector<float>& means) {
  std::vector<float> rgb(size_t(kWidth) * kHeight * 3);
  for (uint32_t i = 0; i < rgb.size(); ++i) {
    const uint32_t x = i / 3 % kWidth, y = i / 3 / kWidth;
    rgb[i] = means[3 * (y / kBlock * (kWidth / kBlock) + x / kBlock) + i % 3];
  }
  return rgb;
}

// Returns the relMSE of an RGB image: squared errors are divided by 1e-3 plus the square of the reference's grey value.
double relative_error(const std::vector<float>& image, const std::vector<float>& reference) {
  double sum = 0.0;
  for (size_t i = 0; i < reference.size(); i += 3) {
    const double gray = (double(reference[i]) + reference[i + 1] + reference[i + 2]) / 3.0;
    for (size_t c = 0; c < 3; ++c) sum += std::pow(double(image[i + c]) - reference[i + c], 2) / (1e-3 + gray * gray);
  }
  return sum / double(reference.size());
}

// Returns 16 times the absolute difference of two images.
std::vector<float> difference(const std::vector<float>& a, const std::vector<float>& b) {
  std::vector<float> result(a.size());
  for (size_t i = 0; i < a.size(); ++i) result[i] = 16.0f * std::fabs(a[i] - b[i]);
  return result;
}

// Writes RGB images side by side to a PNG file with the sRGB curve.
void save_beside_each_other(const fs::path& path, const std::vector<std::vector<float>>& images) {
  const uint32_t width = kWidth * uint32_t(images.size());
  const auto color = [&](float u, float v) {
    const uint32_t column = uint32_t(u * float(width));
    const float* rgb = images[column / kWidth].data() + 3 * (size_t(v * float(kHeight)) * kWidth + column % kWidth);
    const auto encoded = [](float linear) { return image::linear_to_srgb(std::max(0.0f, linear)); };
    return Vec4(encoded(rgb[0]), encoded(rgb[1]), encoded(rgb[2]), 1.0f);
  };
  const test::FileBytes png = test::make_png(width, kHeight, color);
  std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(png.data()), std::streamsize(png.size()));
}

}  // namespace

void save_reference(const std::string& bits, const std::vector<float>& rgba) {
  if (!fs::exists(reference_file(bits))) save(reference_file(bits), rgba);
}

std::string keep(const std::string& name, const std::string& bits, const std::vector<float>& means,
                 const std::vector<float>& rgba) {
  const bool by_pixels = fs::exists(reference_file(bits));
  const std::vector<float> picture = without_alpha(rgba),
                           compared = by_pixels ? picture : block_picture(block_means(rgba));
  const std::vector<float> reference =
      by_pixels ? film_io::load_rgb(reference_file(bits), "").rgb : block_picture(means);
  fs::path path = kFolder / name;
  save(path.replace_extension(".exr"), rgba);
  save_beside_each_other(path.replace_extension(".png"), {reference, picture, difference(compared, reference)});
  std::ostringstream text;
  text << name << ": relMSE of " << (by_pixels ? "pixels " : "blocks ") << relative_error(compared, reference)
       << "; reference, picture and difference x 16 in '" << path.string() << "'";
  return text.str();
}

}  // namespace gradus::regression
