// Layouts of the public structs and values of the public enums in order of declaration, which gradus_struct_layout and
// gradus_abi_hash answer from. The tables are generated: schema/layout_table.cpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace gradus::schema {

struct FieldLayout {
  const char* name;
  size_t offset;
  size_t size;
};

struct StructLayout {
  const char* name;  // without the prefix Gradus
  size_t size;
  std::span<const FieldLayout> fields;
};

struct EnumLayout {
  const char* name;
  std::span<const int64_t> values;
};

std::span<const StructLayout> struct_layouts();
std::span<const EnumLayout> enum_layouts();
// nullptr if there is none of that name.
const StructLayout* find_struct(std::string_view name);
// FNV-1a over the text that gradus.h describes.
uint64_t abi_hash();

}  // namespace gradus::schema
