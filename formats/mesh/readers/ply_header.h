// The header of a PLY file.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "formats/mesh/reader.h"

namespace forcelayer::mesh {

enum class PlyEncoding { kAscii, kLittleEndian, kBigEndian };

enum class PlyType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };
std::uint64_t byte_size(PlyType type);
bool is_integer(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type;  // of the value, or of a list's items
  bool is_list;
  PlyType count_type;  // of a list's count
};

struct PlyElement {
  std::string name;
  std::uint64_t count;
  std::vector<PlyProperty> properties;
  std::uint64_t line;  // where the header declares it

  // Index of the first of `names` among the properties, or -1.
  int find(std::initializer_list<std::string_view> names) const;
  // Bytes that one item takes at the least in a file of this encoding.
  std::uint64_t min_bytes(PlyEncoding encoding) const;
};

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::kAscii;
  std::vector<PlyElement> elements;
  std::uint64_t bytes = 0;  // where the data starts
};

// Throws ReadFailure where the header is not a PLY header.
PlyHeader read_ply_header(const SourceFile& file);

}  // namespace forcelayer::mesh
