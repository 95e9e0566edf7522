#include "schema/layout.h"

#include <string>

namespace gradus::schema {
namespace {

std::string abi_text() {
  std::string text;
  const auto list = [&text](const char* name) { text.append(name).append(":"); };
  for (const StructLayout& s : struct_layouts()) {
    list(s.name);
    text.append(std::to_string(s.size)).append(":");
    for (const FieldLayout& f : s.fields) text.append(std::to_string(f.offset)).append(",");
    text.back() = ';';
  }
  for (const EnumLayout& e : enum_layouts()) {
    list(e.name);
    for (const int64_t value : e.values) text.append(std::to_string(value)).append(",");
    text.back() = ';';
  }
  return text;
}

}  // namespace

const StructLayout* find_struct(std::string_view name) {
  for (const StructLayout& s : struct_layouts()) {
    if (name == s.name) return &s;
  }
  return nullptr;
}

uint64_t abi_hash() {
  uint64_t hash = 0xcbf29ce484222325u;
  for (const char c : abi_text()) {
    hash ^= static_cast<unsigned char>(c);
    hash *= 0x100000001b3u;
  }
  return hash;
}

}  // namespace gradus::schema
