// Reads OpenEXR files with scan lines or tiles, any compression, and half, float or integer channels. From a multipart
// file it reads the first part that has pixels; from a tiled part, the full resolution; from several layers, the
// channels without a layer name or else the first layer. Deep images are refused.
#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>

#include "image/readers/decoded.h"
#include "image/readers/exr_header.h"

namespace gradus::image {
namespace {

// Lets OpenEXR read a file from memory.
class MemoryStream : public Imf::IStream {
 public:
  explicit MemoryStream(Bytes file) : Imf::IStream("image"), file_(file) {}
  bool read(char out[], int count) override {
    if (count < 0 || static_cast<uint64_t>(count) > file_.size() - std::min<uint64_t>(position_, file_.size())) {
      throw std::runtime_error("it is truncated");
    }
    std::memcpy(out, file_.data() + position_, static_cast<size_t>(count));
    position_ += static_cast<uint64_t>(count);
    return position_ < file_.size();
  }
  uint64_t tellg() override { return position_; }
  void seekg(uint64_t position) override { position_ = position; }
  void clear() override {}

 private:
  Bytes file_;
  uint64_t position_ = 0;
};

// Returns the names of the channels to read, in order: RGB, RGBA, Y, Y and A, or the first channel of the file. The
// result is empty if the file has no channels.
std::vector<std::string> choose_channels(const Imf::ChannelList& list) {
  std::vector<std::string> names;
  for (auto it = list.begin(); it != list.end(); ++it) {
    names.emplace_back(it.name());
  }
  const auto has = [&](const std::string& name) { return std::find(names.begin(), names.end(), name) != names.end(); };
  std::vector<std::string> layers = {""};
  for (const std::string& name : names) {
    const size_t dot = name.rfind('.');
    if (dot != std::string::npos) {
      layers.push_back(name.substr(0, dot + 1));
    }
  }
  for (const std::string& layer : layers) {
    if (has(layer + "R") && has(layer + "G") && has(layer + "B")) {
      std::vector<std::string> chosen = {layer + "R", layer + "G", layer + "B"};
      if (has(layer + "A")) {
        chosen.push_back(layer + "A");
      }
      return chosen;
    }
    if (has(layer + "Y")) {
      return has(layer + "A") ? std::vector<std::string>{layer + "Y", layer + "A"}
                              : std::vector<std::string>{layer + "Y"};
    }
  }
  return names.empty() ? names : std::vector<std::string>{names.front()};
}

// Returns whether all named channels are of type half.
bool all_half(const Imf::ChannelList& list, const std::vector<std::string>& names) {
  return std::all_of(names.begin(), names.end(),
                     [&](const std::string& name) { return list[name.c_str()].type == Imf::HALF; });
}

// Returns whether any of the named channels has a lower resolution than the image, as chroma channels may.
bool subsampled(const Imf::ChannelList& list, const std::vector<std::string>& names) {
  return std::any_of(names.begin(), names.end(), [&](const std::string& name) {
    return list[name.c_str()].xSampling != 1 || list[name.c_str()].ySampling != 1;
  });
}

// Reads the chosen channels of one part of the file, as halves if all of them are halves, else as floats.
bool read_part(Imf::MultiPartInputFile* file, int part, size_t file_bytes, DecodedImage* image, std::string* problem) {
  const Imf::Header& header = file->header(part);
  const std::vector<std::string> names = choose_channels(header.channels());
  if (names.empty() || subsampled(header.channels(), names)) {
    *problem = names.empty() ? "it has no channels" : "its channels are subsampled, which is not supported";
    return false;
  }
  const Imath::Box2i window = header.dataWindow();
  const PixelFormat format = all_half(header.channels(), names) ? PixelFormat::Half : PixelFormat::Float;
  const int64_t width = static_cast<int64_t>(window.max.x) - window.min.x + 1;
  const int64_t height = static_cast<int64_t>(window.max.y) - window.min.y + 1;
  if (!allocate(image, static_cast<uint64_t>(width), static_cast<uint64_t>(height), static_cast<uint32_t>(names.size()),
                format, file_bytes, 50000, problem)) {
    return false;
  }
  image->associated_alpha = true;
  const int64_t x_stride = static_cast<int64_t>(names.size() * bytes_per_channel(format));
  const int64_t y_stride = -static_cast<int64_t>(image->row_bytes());  // negative: files have the top row first
  Imf::FrameBuffer buffer;
  for (size_t c = 0; c < names.size(); c++) {
    char* first = reinterpret_cast<char*>(image->row_from_top(0)) + c * bytes_per_channel(format);
    buffer.insert(names[c], Imf::Slice(format == PixelFormat::Half ? Imf::HALF : Imf::FLOAT,
                                       first - window.min.x * x_stride - window.min.y * y_stride,
                                       static_cast<size_t>(x_stride), static_cast<size_t>(y_stride)));
  }
  Imf::InputPart input(*file, part);
  input.setFrameBuffer(buffer);
  input.readPixels(window.min.y, window.max.y);
  return true;
}

}  // namespace

bool read_exr(Bytes file, DecodedImage* image, std::string* problem) {
  if (!check_exr_header(file, problem)) {
    return false;
  }
  try {
    MemoryStream stream(file);
    Imf::MultiPartInputFile input(stream, 0);
    for (int part = 0; part < input.parts(); part++) {
      const Imf::Header& header = input.header(part);
      if (!header.hasType() || Imf::isImage(header.type())) {
        return read_part(&input, part, file.size(), image, problem);
      }
    }
    *problem = "it is a deep image, which is not supported";
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    *problem = e.what();
  }
  return false;
}

}  // namespace gradus::image
