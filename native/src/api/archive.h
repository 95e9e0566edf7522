// Serialisation of scene calls. One visit() per struct serves writing and reading: values first, then texts and arrays,
// whose lengths follow from the values. Numbers are little-endian. Arrays start at multiples of 16 bytes, so that a
// reader can point into the file.
#pragma once

#include <cstring>
#include <deque>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "api/structs.h"
#include "base/error.h"

namespace gradus::api {

inline constexpr size_t kArchiveAlignment = 16;

class ArchiveWriter {
 public:
  template <class T>
  void value(const T& v) {
    static_assert(std::is_arithmetic_v<T>);
    if constexpr (std::is_same_v<T, size_t>) {
      raw(uint64_t(v));
    } else {
      raw(v);
    }
  }
  template <class T, size_t N>
  void values(const T (&v)[N]) {
    for (const T& x : v) value(x);
  }
  void text(const char* const& t) {
    const std::string copy = t ? t : "";
    value(uint32_t(copy.size()));
    bytes(copy.data(), copy.size());
    bytes("", 1);  // The reader returns a pointer to the text, which needs its terminator.
  }
  // Adds an array. The reader returns NULL for an array that is NULL.
  template <class T>
  void array(const T* const& data, uint64_t count) {
    value(uint32_t(data != nullptr));
    if (!data) return;
    align();
    bytes(data, count * sizeof(T));
  }
  template <class T>
  void structs(const T* const& data, uint64_t count) {
    for (uint64_t i = 0; i < count; ++i) visit(*this, const_cast<T&>(data[i]));
  }
  void texts(const char* const* const& data, uint64_t count) {
    for (uint64_t i = 0; i < count; ++i) text(data[i]);
  }

  std::vector<char> take() { return std::move(bytes_); }

 private:
  template <class T>
  void raw(const T& v) {
    bytes(&v, sizeof(v));
  }
  void align() { bytes_.resize((bytes_.size() + kArchiveAlignment - 1) / kArchiveAlignment * kArchiveAlignment, '\0'); }
  void bytes(const void* data, size_t size) {
    const auto* p = static_cast<const char*>(data);
    bytes_.insert(bytes_.end(), p, p + size);
  }
  std::vector<char> bytes_;
};

// Reads untrusted bytes: each length is checked against the remaining size before use. Returned pointers are valid as
// long as the reader and the bytes exist.
class ArchiveReader {
 public:
  // `begin` must be aligned to kArchiveAlignment.
  ArchiveReader(const char* begin, size_t size) : begin_(begin), size_(size) {}

  template <class T>
  void value(T& v) {
    if constexpr (std::is_same_v<T, size_t>) {
      uint64_t wide = 0;
      raw(wide);
      if (wide > kMaxCount) throw invalid_argument("a count is too large");
      v = size_t(wide);
    } else {
      raw(v);
    }
  }
  template <class T, size_t N>
  void values(T (&v)[N]) {
    for (T& x : v) value(x);
  }
  void text(const char*& t) {
    uint32_t length = 0;
    value(length);
    const char* p = take(uint64_t(length) + 1);
    if (p[length] != '\0') throw invalid_argument("a text does not end");
    t = p;
  }
  template <class T>
  void array(const T*& data, uint64_t count) {
    data = nullptr;
    uint32_t present = 0;
    value(present);
    if (present == 0) return;
    take((kArchiveAlignment - position_ % kArchiveAlignment) % kArchiveAlignment);
    if (count > (size_ - position_) / sizeof(T)) throw invalid_argument("an array is longer than the file");
    data = reinterpret_cast<const T*>(take(count * sizeof(T)));
  }
  template <class T>
  void structs(const T*& data, uint64_t count) {
    if (count > size_ - position_) throw invalid_argument("a list is longer than the file");
    auto list = std::make_shared<std::vector<T>>(count);
    for (T& item : *list) visit(*this, item);
    data = list->data();
    kept_.push_back(std::move(list));
  }
  void texts(const char* const*& data, uint64_t count) {
    if (count > size_ - position_) throw invalid_argument("a list is longer than the file");
    auto list = std::make_shared<std::vector<const char*>>(count);
    for (const char*& t : *list) text(t);
    data = list->data();
    kept_.push_back(std::move(list));
  }

 private:
  template <class T>
  void raw(T& v) {
    std::memcpy(&v, take(sizeof(v)), sizeof(v));
  }
  const char* take(uint64_t size) {
    if (size > size_ - position_) throw invalid_argument("the file ends too early");
    const char* p = begin_ + position_;
    position_ += size;
    return p;
  }
  const char* begin_;
  uint64_t size_, position_ = 0;
  std::deque<std::shared_ptr<void>> kept_;
};

}  // namespace gradus::api
