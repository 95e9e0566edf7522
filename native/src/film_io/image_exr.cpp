#include "film_io/image_exr.h"

#include <array>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>

#include "film_io/exr_stream.h"

namespace gradus::film_io {
namespace {

std::string channel_name(const ImageLayer& layer, size_t channel) {
  const std::string letter(1, layer.letters[channel]);
  return layer.name.empty() ? letter : layer.name + "." + letter;
}

std::vector<float> flipped(const std::vector<float>& pixels, int height) {
  std::vector<float> result;
  result.reserve(pixels.size());
  const size_t row = pixels.size() / size_t(height);
  for (int y = height - 1; y >= 0; --y)
    result.insert(result.end(), pixels.begin() + ptrdiff_t(y * row), pixels.begin() + ptrdiff_t((y + 1) * row));
  return result;
}

bool ends_with(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

// Sets of letters that name the first three channels of a layer. The single letters come last, because a layer may have
// several of them; V is that of files from earlier versions.
constexpr const char* kLetters[] = {"RGB", "XYZ", "UVA", "VVV", "XXX", "YYY", "ZZZ"};

// Returns the names of the first three channels of the layer whose name ends with `layer`.
std::array<std::string, 3> find_layer(const Imf::ChannelList& channels, const std::string& layer) {
  if (layer.empty() && channels.findChannel("R")) return {"R", "G", "B"};
  const std::string wanted = layer.empty() ? "Combined" : layer;
  std::string all;
  for (auto it = channels.begin(); it != channels.end(); ++it) all += std::string(" ") + it.name();
  for (const char* letters : kLetters) {
    for (auto it = channels.begin(); it != channels.end(); ++it) {
      const std::string name = it.name(), end = wanted + "." + letters[0];
      if (name != end && !ends_with(name, "." + end)) continue;
      const std::string prefix = name.substr(0, name.size() - 1);
      const std::array<std::string, 3> names = {name, prefix + letters[1], prefix + letters[2]};
      if (channels.findChannel(names[1]) && channels.findChannel(names[2])) return names;
    }
  }
  throw invalid_argument("it has no layer " + wanted + " of one, three or four channels; its channels are" + all);
}

LoadedImage read_rgb(const std::string& path, const std::string& layer) {
  Imf::InputFile file(path.c_str());
  const Imath::Box2i window = file.header().dataWindow();
  LoadedImage image;
  image.width = window.max.x - window.min.x + 1;
  image.height = window.max.y - window.min.y + 1;
  if (image.width < 1 || image.height < 1 || image.width > kMaxImageSide || image.height > kMaxImageSide)
    throw invalid_argument("its size is wrong");
  const std::array<std::string, 3> names = find_layer(file.header().channels(), layer);
  const bool is_single = names[1] == names[0];
  std::vector<float> pixels(size_t(image.width) * size_t(image.height) * 3);
  Imf::FrameBuffer buffer;
  for (size_t c = 0; c < (is_single ? 1 : names.size()); ++c) {
    const size_t pixel = 3 * sizeof(float);
    buffer.insert(names[c],
                  Imf::Slice::Make(Imf::FLOAT, pixels.data() + c, window, pixel, pixel * size_t(image.width)));
  }
  file.setFrameBuffer(buffer);
  file.readPixels(window.min.y, window.max.y);
  if (is_single) {
    for (size_t i = 0; i < pixels.size(); i += 3) pixels[i + 1] = pixels[i + 2] = pixels[i];
  }
  image.rgb = flipped(pixels, image.height);
  return image;
}

template <class Function>
auto reading(const std::string& path, Function&& function) {
  try {
    return function();
  } catch (const Error& e) {
    throw Error(e.code(), "cannot read " + path + ": " + e.what());
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    throw invalid_argument("cannot read " + path + ": " + exr_problem(e));
  }
}

}  // namespace

void save_image(const std::string& path, int width, int height, const std::vector<ImageLayer>& layers) {
  Imf::Header header(width, height);
  header.compression() = Imf::ZIP_COMPRESSION;
  Imf::FrameBuffer buffer;
  std::vector<std::vector<float>> rows;
  for (const ImageLayer& layer : layers) rows.push_back(flipped(layer.pixels, height));
  for (size_t i = 0; i < layers.size(); ++i) {
    for (size_t c = 0; c < layers[i].letters.size(); ++c) {
      const std::string name = channel_name(layers[i], c);
      const size_t pixel = layers[i].letters.size() * sizeof(float);
      header.channels().insert(name, Imf::Channel(Imf::FLOAT));
      buffer.insert(name,
                    Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(rows[i].data() + c), pixel, pixel * size_t(width)));
    }
  }
  write_exr(path, [&](WriterStream* stream) {
    Imf::OutputFile file(*stream, header);
    file.setFrameBuffer(buffer);
    file.writePixels(height);
  });
}

LoadedImage load_rgb(const std::string& path, const std::string& layer) {
  return reading(path, [&] { return read_rgb(path, layer); });
}

std::vector<std::string> image_channels(const std::string& path) {
  return reading(path, [&] {
    const Imf::InputFile file(path.c_str());
    std::vector<std::string> names;
    const Imf::ChannelList& channels = file.header().channels();
    for (auto it = channels.begin(); it != channels.end(); ++it) names.emplace_back(it.name());
    return names;
  });
}

bool is_film_file(const std::string& path) {
  return reading(path, [&] {
    return Imf::InputFile(path.c_str()).header().findTypedAttribute<Imf::StringAttribute>("gradus") != nullptr;
  });
}

}  // namespace gradus::film_io
