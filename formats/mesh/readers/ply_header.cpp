#include "formats/mesh/readers/ply_header.h"

#include <algorithm>

#include "formats/mesh/readers/text_cursor.h"

namespace forcelayer::mesh {
namespace {

struct NamedType {
  std::string_view name, other_name;
  PlyType type;
  std::uint64_t bytes;
};

constexpr NamedType kTypes[] = {
    {"char", "int8", PlyType::kInt8, 1},        {"uchar", "uint8", PlyType::kUint8, 1},
    {"short", "int16", PlyType::kInt16, 2},     {"ushort", "uint16", PlyType::kUint16, 2},
    {"int", "int32", PlyType::kInt32, 4},       {"uint", "uint32", PlyType::kUint32, 4},
    {"float", "float32", PlyType::kFloat32, 4}, {"double", "float64", PlyType::kFloat64, 8}};

class HeaderReader {
 public:
  explicit HeaderReader(const SourceFile& file) : file_(file), cursor_(file) {}

  PlyHeader read() {
    if (cursor_.word() != "ply") fail("not a PLY file: it does not start with 'ply'");
    end_line();
    for (;;) {
      if (cursor_.at_end()) {
        cursor_.fail(ErrorCode::kMeshIncomplete, "the file ends before 'end_header'",
                     "copy or export the file again");
      }
      const std::string_view keyword = cursor_.word();
      if (keyword == "end_header") break;
      read_line(keyword);
    }
    if (!has_format_) fail("the header has no 'format' line");
    end_data_line();
    header_.bytes = cursor_.offset();
    return std::move(header_);
  }

 private:
  void read_line(std::string_view keyword) {
    if (keyword == "format") {
      read_format();
    } else if (keyword == "element") {
      const std::string name(cursor_.word());
      const std::uint64_t place = cursor_.offset();
      header_.elements.push_back(
          {name, cursor_.count("the element's count"), {}, cursor_.line_of(place)});
    } else if (keyword == "property") {
      read_property();
    } else if (keyword == "comment" || keyword == "obj_info") {
      cursor_.skip_to_line_end();
    } else if (!keyword.empty()) {
      fail(in_quotes(keyword) + " is not a line of a PLY header");
    }
    end_line();
  }

  void read_format() {
    const std::string_view encoding = cursor_.word();
    if (encoding == "ascii") {
      header_.encoding = PlyEncoding::kAscii;
    } else if (encoding == "binary_little_endian") {
      header_.encoding = PlyEncoding::kLittleEndian;
    } else if (encoding == "binary_big_endian") {
      header_.encoding = PlyEncoding::kBigEndian;
    } else {
      fail("unknown encoding " + in_quotes(encoding));
    }
    if (cursor_.word() != "1.0") fail("the PLY format is not version 1.0");
    has_format_ = true;
  }

  void read_property() {
    if (header_.elements.empty()) fail("a property comes before the first element");
    PlyProperty property{};
    std::string_view type = cursor_.word();
    if (type == "list") {
      property.is_list = true;
      property.count_type = type_of(cursor_.word());
      if (!is_integer(property.count_type)) fail("the count of a list is not an integer");
      type = cursor_.word();
    }
    property.type = type_of(type);
    property.name = cursor_.word();
    header_.elements.back().properties.push_back(std::move(property));
  }

  PlyType type_of(std::string_view name) {
    for (const NamedType& type : kTypes) {
      if (name == type.name || name == type.other_name) return type.type;
    }
    fail("unknown type " + in_quotes(name));
  }

  void end_line() {
    cursor_.skip_blanks();
    if (!cursor_.at_line_end()) fail("this header line has too many words");
    cr_only_ = cursor_.peek() == '\r' && file_.bytes.substr(cursor_.offset(), 2) != "\r\n";
    cursor_.skip_line_end();
  }

  // Binary data may start with the byte of a line feed: trust what ended the lines before.
  void end_data_line() {
    if (cr_only_ && cursor_.peek() == '\r') {
      cursor_.advance(1);
    } else {
      cursor_.skip_blanks();
      if (!cursor_.at_line_end()) fail("this header line has too many words");
      cursor_.skip_line_end();
    }
  }

  [[noreturn]] void fail(std::string what) {
    cursor_.fail(ErrorCode::kMeshUnreadable, std::move(what), "export the mesh again");
  }

  const SourceFile& file_;
  TextCursor cursor_;
  PlyHeader header_;
  bool has_format_ = false;
  bool cr_only_ = false;
};

}  // namespace

std::uint64_t byte_size(PlyType type) { return kTypes[static_cast<std::size_t>(type)].bytes; }

bool is_integer(PlyType type) { return type != PlyType::kFloat32 && type != PlyType::kFloat64; }

int PlyElement::find(std::initializer_list<std::string_view> names) const {
  for (std::size_t i = 0; i < properties.size(); ++i) {
    if (std::find(names.begin(), names.end(), properties[i].name) != names.end()) {
      return static_cast<int>(i);
    }
  }
  return -1;
}

std::uint64_t PlyElement::min_bytes(PlyEncoding encoding) const {
  if (encoding == PlyEncoding::kAscii) return 2 * properties.size();  // a digit and a separator
  std::uint64_t bytes = 0;
  for (const PlyProperty& property : properties) {
    bytes += byte_size(property.is_list ? property.count_type : property.type);
  }
  return bytes;
}

PlyHeader read_ply_header(const SourceFile& file) { return HeaderReader(file).read(); }

}  // namespace forcelayer::mesh
