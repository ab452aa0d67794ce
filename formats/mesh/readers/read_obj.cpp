// Wavefront OBJ: vertices and polygons. Groups, objects, materials, normals and texture coordinates
// do not change the surface and are skipped.
#include <algorithm>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include "formats/mesh/reader.h"
#include "formats/mesh/readers/polygon_splitter.h"
#include "formats/mesh/readers/text_cursor.h"

namespace forcelayer::mesh {
namespace {

// Those of the format that hold no face, and comments.
bool is_statement(std::string_view keyword) {
  constexpr std::string_view kStatements[] = {
      "vn",     "vt",         "vp",       "g",    "o",     "s",        "mg",       "usemtl",
      "mtllib", "usemap",     "maplib",   "l",    "p",     "curv",     "curv2",    "surf",
      "call",   "cstype",     "deg",      "bmat", "step",  "parm",     "trim",     "hole",
      "scrv",   "sp",         "end",      "con",  "bevel", "c_interp", "d_interp", "lod",
      "ctech",  "stech",      "csh",      "bsp",  "bzp",   "cdc",      "cdp",      "res",
      "vc",     "shadow_obj", "trace_obj"};
  return keyword.starts_with('#') || std::find(std::begin(kStatements), std::end(kStatements),
                                               keyword) != std::end(kStatements);
}

class ObjReader {
 public:
  explicit ObjReader(const SourceFile& file)
      : file_(file), cursor_(file, /*backslash_joins_lines=*/true) {}

  Assembly read() {
    while (!cursor_.at_end()) {
      read_line();
      cursor_.skip_to_line_end();
      cursor_.skip_line_end();
    }
    check_indices();
    check_finite(file_, mesh_);
    split_polygons();
    Assembly assembly = assembly_of(file_, std::move(mesh_));
    splitter_.add_warnings(assembly.warnings);
    if (unknown_ > 0) {
      assembly.warnings.push_back(
          counted(unknown_, "statement") + (unknown_ == 1 ? " is" : " are") +
          " ignored, because OBJ does not define this keyword: " + in_quotes(first_unknown_) +
          " in line " + std::to_string(cursor_.line_of(unknown_place_)) +
          (unknown_ > 1 ? ", ..." : ""));
    }
    if (lines_and_points_ > 0) {
      assembly.warnings.push_back(counted(lines_and_points_, "line or point element") +
                                  (lines_and_points_ == 1 ? " is" : " are") +
                                  " left out, because lines and points have no surface");
    }
    return assembly;
  }

 private:
  void read_line() {
    std::string_view keyword = cursor_.word();
    while (keyword.starts_with(kByteOrderMark)) keyword.remove_prefix(kByteOrderMark.size());
    if (keyword == "v") return read_vertex();
    if (keyword == "f" || keyword == "fo") return read_face();
    if (keyword == "vn" || keyword == "vt") return;
    if (keyword == "l" || keyword == "p") ++lines_and_points_;
    if (!keyword.empty() && !is_statement(keyword) && ++unknown_ == 1) {
      first_unknown_ = keyword;
      unknown_place_ = cursor_.offset();
    }
    if (keyword == "curv" || keyword == "surf" || keyword == "call") {
      cursor_.fail(ErrorCode::kMeshUnsupported,
                   in_quotes(keyword) + " (free-form surface or included file) is not supported",
                   "export the mesh as polygons in one file");
    }
  }

  void read_vertex() {
    const double x = cursor_.number("a coordinate");
    const double y = cursor_.number("a coordinate");
    const double z = cursor_.number("a coordinate");
    mesh_.vertices.push_back({x, y, z});  // a weight or color may follow
  }

  // f v v v, f v/t v/t v/t, f v//n v//n v//n or f v/t/n v/t/n v/t/n
  void read_face() {
    const std::uint64_t place = cursor_.offset();
    corners_.clear();
    for (cursor_.skip_blanks(); !cursor_.at_line_end() && cursor_.peek() != '#';
         cursor_.skip_blanks()) {
      corners_.push_back(read_corner());
    }
    if (corners_.size() < 3) {
      cursor_.fail_at(place, ErrorCode::kMeshUnreadable,
                      counted(corners_.size(), "corner") + " do not make a face",
                      "export the mesh again");
    }
    if (corners_.size() == 3) {
      mesh_.triangles.push_back({corners_[0], corners_[1], corners_[2]});
    } else {
      // Split at the end, when all corners are known; until then its place is kept.
      polygons_.push_back({mesh_.triangles.size(), polygon_corners_.size(), corners_.size()});
      polygon_corners_.insert(polygon_corners_.end(), corners_.begin(), corners_.end());
    }
  }

  std::uint32_t read_corner() {
    const std::uint64_t place = cursor_.offset();
    std::int64_t index = 0;
    if (!cursor_.integer(index)) fail_corner(place);
    for (int part = 0; part < 2 && cursor_.peek() == '/'; ++part) {
      cursor_.advance(1);
      std::int64_t ignored = 0;
      cursor_.integer(ignored);
    }
    const char after = cursor_.peek();
    if (!cursor_.at_line_end() && after != ' ' && after != '\t' && after != '\\') {
      fail_corner(place);
    }
    const auto known = static_cast<std::int64_t>(mesh_.vertices.size());
    if (index < 0) index += known + 1;  // -1 is the newest vertex
    if (index < 1 || index > std::numeric_limits<std::uint32_t>::max()) {
      cursor_.fail_at(place, ErrorCode::kMeshUnreadable,
                      "the vertex number of a corner of a face is out of range",
                      "export the mesh again");
    }
    if (index > highest_index_) {
      highest_index_ = index;
      highest_index_place_ = place;
    }
    return static_cast<std::uint32_t>(index - 1);
  }

  [[noreturn]] void fail_corner(std::uint64_t place) {
    cursor_.fail_at(place, ErrorCode::kMeshUnreadable,
                    "a corner of a face has no valid vertex number", "export the mesh again");
  }

  void check_indices() {
    check_count(file_, mesh_.vertices.size(), "vertices");
    if (highest_index_ <= static_cast<std::int64_t>(mesh_.vertices.size())) return;
    cursor_.fail_at(highest_index_place_, ErrorCode::kMeshIncomplete,
                    "a face uses vertex " + std::to_string(highest_index_) +
                        ", but there are only " + std::to_string(mesh_.vertices.size()) +
                        " vertices",
                    "copy or export the file again");
  }

  // Puts the triangles of each polygon where the polygon stood among the triangles.
  void split_polygons() {
    if (polygons_.empty()) return;
    const std::vector<Triangle> plain = std::move(mesh_.triangles);
    mesh_.triangles.clear();
    mesh_.triangles.reserve(plain.size() + polygon_corners_.size());
    std::size_t done = 0;
    for (const Polygon& polygon : polygons_) {
      mesh_.triangles.insert(mesh_.triangles.end(),
                             plain.begin() + static_cast<std::ptrdiff_t>(done),
                             plain.begin() + static_cast<std::ptrdiff_t>(polygon.triangles_before));
      done = polygon.triangles_before;
      splitter_.split(std::span(polygon_corners_).subspan(polygon.first_corner, polygon.corners),
                      mesh_);
    }
    mesh_.triangles.insert(mesh_.triangles.end(), plain.begin() + static_cast<std::ptrdiff_t>(done),
                           plain.end());
  }

  struct Polygon {
    std::size_t triangles_before;  // plain triangles that stand before it in the file
    std::size_t first_corner;      // in polygon_corners_
    std::size_t corners;
  };

  const SourceFile& file_;
  TextCursor cursor_;
  Mesh mesh_{{}, {}, /*single_precision=*/false};
  std::vector<std::uint32_t> corners_;
  std::vector<Polygon> polygons_;
  std::vector<std::uint32_t> polygon_corners_;
  PolygonSplitter splitter_;
  std::int64_t highest_index_ = 0;  // from 1
  std::uint64_t highest_index_place_ = 0;
  std::uint64_t lines_and_points_ = 0;
  std::uint64_t unknown_ = 0;  // statements
  std::string first_unknown_;
  std::uint64_t unknown_place_ = 0;
};

}  // namespace

Assembly read_obj(const SourceFile& file) { return ObjReader(file).read(); }

}  // namespace forcelayer::mesh
