// PLY, ASCII and binary of both byte orders: vertices, polygons ("face") and triangle strips
// ("tristrips", -1 between strips). Other elements and properties are stepped over.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <vector>

#include "formats/mesh/reader.h"
#include "formats/mesh/readers/ply_header.h"
#include "formats/mesh/readers/polygon_splitter.h"
#include "formats/mesh/readers/text_cursor.h"

namespace forcelayer::mesh {
namespace {

// Values one after the other out of binary data.
class BinaryValues {
 public:
  BinaryValues(const SourceFile& file, const PlyHeader& header)
      : file_(file),
        at_(header.bytes),
        swap_((header.encoding == PlyEncoding::kBigEndian) !=
              (std::endian::native == std::endian::big)) {}

  void begin_item(const PlyElement& element, std::uint64_t item) {
    element_ = &element;
    item_ = item;
  }
  void end_item() {}
  std::string place() const { return at_byte(at_); }
  std::uint64_t bytes_left() const { return file_.bytes.size() - at_; }

  double number(PlyType type) {
    switch (type) {
      case PlyType::kInt8:
        return take<std::int8_t>();
      case PlyType::kUint8:
        return take<std::uint8_t>();
      case PlyType::kInt16:
        return take<std::int16_t>();
      case PlyType::kUint16:
        return take<std::uint16_t>();
      case PlyType::kInt32:
        return take<std::int32_t>();
      case PlyType::kUint32:
        return take<std::uint32_t>();
      case PlyType::kFloat32:
        return take<float>();
      case PlyType::kFloat64:
        return take<double>();
    }
    return 0;
  }
  std::int64_t integer(PlyType type) { return static_cast<std::int64_t>(number(type)); }
  void skip(PlyType type, std::uint64_t count) {
    if (count > bytes_left() / byte_size(type)) fail_end();
    at_ += count * byte_size(type);
  }

  // A line end or zeros may follow the last element; anything else was not announced.
  void check_nothing_left() const {
    const std::string_view rest = file_.bytes.substr(at_);
    if (rest.find_first_not_of(std::string_view("\r\n \0", 4)) == std::string_view::npos) return;
    fail_read(file_, ErrorCode::kMeshIncomplete, place(),
              "the file has " + counted(rest.size(), "byte") +
                  " after the last element that the header announces",
              "export the mesh again; a count may be wrong");
  }

 private:
  template <typename T>
  T take() {
    if (bytes_left() < sizeof(T)) fail_end();
    std::array<char, sizeof(T)> bytes;
    std::memcpy(bytes.data(), file_.bytes.data() + at_, sizeof(T));
    if (swap_) std::reverse(bytes.begin(), bytes.end());
    at_ += sizeof(T);
    return std::bit_cast<T>(bytes);
  }

  [[noreturn]] void fail_end() const {
    fail_read(file_, ErrorCode::kMeshIncomplete, at_byte(file_.bytes.size()),
              "the file ends before the end of " + element_->name + " " + std::to_string(item_) +
                  " of " + std::to_string(element_->count),
              "copy or export the file again");
  }

  const SourceFile& file_;
  std::uint64_t at_;
  bool swap_;
  const PlyElement* element_ = nullptr;
  std::uint64_t item_ = 0;
};

// The same out of text, a line for each item.
class TextValues {
 public:
  TextValues(const SourceFile& file, const PlyHeader& header) : cursor_(file) {
    cursor_.advance(header.bytes - cursor_.offset());
  }

  void begin_item(const PlyElement& element, std::uint64_t item) {
    cursor_.skip_space();
    if (!cursor_.at_end()) return;
    cursor_.fail(ErrorCode::kMeshIncomplete,
                 "the file ends before " + element.name + " " + std::to_string(item) + " of " +
                     std::to_string(element.count),
                 "copy or export the file again");
  }
  void end_item() {
    cursor_.skip_blanks();
    if (cursor_.at_line_end()) return;
    cursor_.fail(ErrorCode::kMeshUnreadable, "this line has more values than the header announces",
                 "export the mesh again");
  }
  std::string place() const { return "line " + std::to_string(cursor_.line_of(cursor_.offset())); }
  std::uint64_t bytes_left() const { return cursor_.bytes_left(); }

  double number(PlyType) { return cursor_.number("a value"); }
  std::int64_t integer(PlyType) {
    cursor_.skip_blanks();
    const double value = cursor_.number("a whole number");
    constexpr double kExact = 9007199254740992;  // 2^53
    if (!(std::abs(value) < kExact) || value != std::floor(value)) {
      cursor_.fail(ErrorCode::kMeshUnreadable, "a whole number is needed here");
    }
    return static_cast<std::int64_t>(value);
  }
  void skip(PlyType, std::uint64_t count) {
    for (std::uint64_t i = 0; i < count; ++i) {
      if (!cursor_.word().empty()) continue;
      cursor_.fail(ErrorCode::kMeshIncomplete,
                   "this line has fewer values than the header announces",
                   "copy or export the file again");
    }
  }
  void check_nothing_left() {
    cursor_.skip_space();
    if (cursor_.at_end()) return;
    cursor_.fail(ErrorCode::kMeshIncomplete, "the file has more data than the header announces",
                 "export the mesh again; a count may be wrong");
  }

 private:
  TextCursor cursor_;
};

template <typename Values>
class PlyReader {
 public:
  PlyReader(const SourceFile& file, const PlyHeader& header)
      : file_(file), header_(header), values_(file, header) {}

  Assembly read() {
    for (const PlyElement& element : header_.elements) read_element(element);
    values_.check_nothing_left();
    check_indices();
    check_finite(file_, mesh_);
    for (const Polygon& polygon : polygons_) {
      splitter_.split(std::span(corners_).subspan(polygon.first_corner, polygon.corners), mesh_);
    }
    Assembly assembly = assembly_of(file_, std::move(mesh_));
    splitter_.add_warnings(assembly.warnings);
    return assembly;
  }

 private:
  void read_element(const PlyElement& element) {
    if (element.properties.empty() && element.count > 0)
      fail_properties(element, "has no properties");
    if (element.count > 0 &&
        element.count - 1 > values_.bytes_left() / element.min_bytes(header_.encoding)) {
      fail_read(file_, ErrorCode::kMeshIncomplete, "line " + std::to_string(element.line),
                "the header announces " + counted(element.count, element.name.c_str()) +
                    " elements, but the file is too short for them",
                "copy or export the file again");
    }
    if (element.name == "vertex") return read_vertices(element);
    if (element.name == "face") return read_lists(element, &PlyReader::add_polygon);
    if (element.name == "tristrips") return read_lists(element, &PlyReader::add_strips);
    for (std::uint64_t i = 0; i < element.count; ++i) {
      values_.begin_item(element, i);
      for (const PlyProperty& property : element.properties) skip(property);
      values_.end_item();
    }
  }

  void read_vertices(const PlyElement& element) {
    const int x = element.find({"x"}), y = element.find({"y"}), z = element.find({"z"});
    if (x < 0 || y < 0 || z < 0) fail_properties(element, "lacks the property x, y or z");
    check_count(file_, mesh_.vertices.size() + element.count, "vertices");
    for (const int axis : {x, y, z}) {
      const PlyProperty& property = element.properties[static_cast<std::size_t>(axis)];
      if (property.is_list) fail_properties(element, "has a list as a coordinate");
      mesh_.single_precision = mesh_.single_precision && property.type == PlyType::kFloat32;
    }
    mesh_.vertices.reserve(mesh_.vertices.size() + element.count);
    for (std::uint64_t i = 0; i < element.count; ++i) {
      values_.begin_item(element, i);
      Vec3d vertex{};
      for (int p = 0; p < static_cast<int>(element.properties.size()); ++p) {
        const PlyProperty& property = element.properties[static_cast<std::size_t>(p)];
        if (p == x || p == y || p == z) {
          vertex[p == x ? 0 : p == y ? 1 : 2] = values_.number(property.type);
        } else {
          skip(property);
        }
      }
      values_.end_item();
      mesh_.vertices.push_back(vertex);
    }
  }

  // Reads an element whose list of vertex numbers `add` takes over from `list_`.
  void read_lists(const PlyElement& element, void (PlyReader::*add)(const PlyElement&)) {
    if (element.count == 0) return;
    const int indices = element.find({"vertex_indices", "vertex_index"});
    if (indices < 0) fail_properties(element, "has no property vertex_indices");
    const PlyProperty& list = element.properties[static_cast<std::size_t>(indices)];
    if (!list.is_list || !is_integer(list.type)) {
      fail_properties(element, "has vertex_indices that are not a list of integers");
    }
    for (std::uint64_t i = 0; i < element.count; ++i) {
      item_ = i;
      values_.begin_item(element, i);
      for (const PlyProperty& property : element.properties) {
        if (&property == &list) {
          read_list(list);
          (this->*add)(element);
        } else {
          skip(property);
        }
      }
      values_.end_item();
    }
  }

  void read_list(const PlyProperty& list) {
    const std::uint64_t count = list_length(list);
    list_.clear();
    for (std::uint64_t i = 0; i < count; ++i) list_.push_back(values_.integer(list.type));
  }

  std::uint64_t list_length(const PlyProperty& list) {
    const std::int64_t count = values_.integer(list.count_type);
    if (count < 0) {
      fail_read(file_, ErrorCode::kMeshUnreadable, values_.place(), "a list has a negative length",
                "export the mesh again");
    }
    return static_cast<std::uint64_t>(count);
  }

  void skip(const PlyProperty& property) {
    values_.skip(property.type, property.is_list ? list_length(property) : 1);
  }

  void add_polygon(const PlyElement& element) {
    if (list_.size() < 3) {
      fail_item(element, "has " + counted(list_.size(), "corner"));
    }
    polygons_.push_back({corners_.size(), list_.size()});
    for (const std::int64_t index : list_) corners_.push_back(checked(element, index));
  }

  // Every second triangle of a strip is turned over.
  void add_strips(const PlyElement& element) {
    std::size_t first = 0;
    for (std::size_t i = 0; i <= list_.size(); ++i) {
      if (i < list_.size() && list_[i] != -1) continue;
      if (i != first && i - first < 3) {
        fail_item(element, "has a strip of only " + std::to_string(i - first) + " vertices");
      }
      for (std::size_t t = first; t + 2 < i; ++t) {
        const std::size_t odd = (t - first) % 2;
        polygons_.push_back({corners_.size(), 3});
        for (const std::size_t corner : {t + odd, t + 1 - odd, t + 2}) {
          corners_.push_back(checked(element, list_[corner]));
        }
      }
      first = i + 1;
    }
  }

  // Vertices may stand after the faces, so that only the highest index is kept to be looked at.
  std::uint32_t checked(const PlyElement& element, std::int64_t index) {
    if (index < 0 || index > 0xffffffff) fail_item(element, "uses vertex " + std::to_string(index));
    if (index > highest_index_) {
      highest_index_ = index;
      highest_index_element_ = element.name + " " + std::to_string(item_);
    }
    return static_cast<std::uint32_t>(index);
  }

  void check_indices() const {
    if (highest_index_ < static_cast<std::int64_t>(mesh_.vertices.size())) return;
    fail_read(file_, ErrorCode::kMeshUnreadable, highest_index_element_,
              "uses vertex " + std::to_string(highest_index_) + ", but there are only " +
                  std::to_string(mesh_.vertices.size()) + " vertices, counted from 0",
              "export the mesh again");
  }

  [[noreturn]] void fail_item(const PlyElement& element, std::string what) const {
    fail_read(file_, ErrorCode::kMeshUnreadable, values_.place(),
              element.name + " " + std::to_string(item_) + " " + what, "export the mesh again");
  }

  [[noreturn]] void fail_properties(const PlyElement& element, const char* what) const {
    fail_read(file_, ErrorCode::kMeshUnreadable, "line " + std::to_string(element.line),
              "element '" + element.name + "' " + what, "export the mesh again");
  }

  struct Polygon {
    std::size_t first_corner;
    std::size_t corners;
  };

  const SourceFile& file_;
  const PlyHeader& header_;
  Values values_;
  Mesh mesh_;
  std::vector<std::int64_t> list_;  // of the item that is being read
  std::uint64_t item_ = 0;
  std::vector<Polygon> polygons_;
  std::vector<std::uint32_t> corners_;
  std::int64_t highest_index_ = -1;
  std::string highest_index_element_;
  PolygonSplitter splitter_;
};

}  // namespace

Assembly read_ply(const SourceFile& file) {
  const PlyHeader header = read_ply_header(file);
  if (header.encoding == PlyEncoding::kAscii) return PlyReader<TextValues>(file, header).read();
  return PlyReader<BinaryValues>(file, header).read();
}

}  // namespace forcelayer::mesh
