// Output of OpenEXR to an atomic FileWriter, the largest size of its images, and texts for the errors of OpenEXR.
#pragma once

#include <exception>
#include <string>

#include <ImfIO.h>

#include "base/error.h"
#include "film_io/file_writer.h"

namespace gradus::film_io {

// Largest width and height of a stored film or image, in pixels.
inline constexpr int kMaxImageSide = 1 << 16;

// A stream that keeps errors which OpenEXR ignores (its destructors also write) for rethrow().
class WriterStream final : public Imf::OStream {
 public:
  WriterStream(FileWriter* writer, const std::string& path) : Imf::OStream(path.c_str()), writer_(writer) {}
  void write(const char data[], int size) override {
    run([&] { writer_->write(data, size_t(size)); });
  }
  uint64_t tellp() override { return writer_->position(); }
  void seekp(uint64_t position) override {
    run([&] { writer_->seek(position); });
  }
  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  template <class Function>
  void run(Function&& function) {
    try {
      function();
    } catch (...) {
      failure_ = std::current_exception();
      throw;
    }
  }
  FileWriter* writer_;
  std::exception_ptr failure_;
};

// Calls write(&stream) and commits the file. Throws Error with path and cause on failure, and leaves no file.
template <class Function>
void write_exr(const std::string& path, Function&& write, Durable durable = Durable::kYes) {
  FileWriter writer(path, durable);
  WriterStream stream(&writer, path);
  try {
    write(&stream);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& e) {
    stream.rethrow();
    throw Error(GRADUS_ERROR_INVALID_OPERATION, "cannot write " + path + ": " + e.what());
  }
  stream.rethrow();
  writer.commit();
}

// Returns the text of an exception that OpenEXR threw, without the file name, which callers add themselves.
inline std::string exr_problem(const std::exception& exception) {
  const std::string text = exception.what(), after_name = "\". ";
  // OpenEXR reports so that rows are missing, or that the table of offsets lacks them.
  for (const char* what : {"end of file", "is missing"}) {
    if (text.find(what) != std::string::npos) return "it is cut short";
  }
  if (text.find("not an image file") != std::string::npos) return "it is no OpenEXR file";
  const size_t name = text.rfind(after_name);
  return name == std::string::npos ? text : text.substr(name + after_name.size());
}

}  // namespace gradus::film_io
