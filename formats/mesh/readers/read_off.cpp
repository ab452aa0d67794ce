// OFF (Geomview's Object File Format), ASCII, with comments and any white space.
#include <vector>

#include "formats/mesh/reader.h"
#include "formats/mesh/readers/polygon_splitter.h"
#include "formats/mesh/readers/text_cursor.h"

namespace forcelayer::mesh {
namespace {

class OffReader {
 public:
  explicit OffReader(const SourceFile& file) : file_(file), cursor_(file) {}

  Assembly read() {
    read_keyword();
    read_counts();
    read_vertices();
    check_finite(file_, mesh_);
    for (std::uint64_t face = 0; face < face_count_; ++face) read_face(face);
    check_nothing_left();
    Assembly assembly = assembly_of(file_, std::move(mesh_));
    splitter_.add_warnings(assembly.warnings);
    return assembly;
  }

 private:
  // [ST][C][N]OFF, itself optional; the vertex count may follow without a blank.
  void read_keyword() {
    cursor_.skip_space('#');
    if (cursor_.peek() >= '0' && cursor_.peek() <= '9' && !starts_with("4OFF")) return;
    for (const std::string_view prefix : {"ST", "C", "N"}) {
      if (!starts_with(prefix)) continue;
      cursor_.advance(prefix.size());
      has_vertex_extras_ = true;
    }
    if (starts_with("4") || starts_with("n")) {
      cursor_.fail(ErrorCode::kMeshUnsupported,
                   "only OFF files with three dimensions are supported",
                   "export the mesh as plain OFF");
    }
    if (!starts_with("OFF")) {
      cursor_.fail(ErrorCode::kMeshUnreadable, "not an OFF file: it does not start with 'OFF'");
    }
    cursor_.advance(3);
    if (TextCursor(cursor_).word() == "BINARY") {
      cursor_.fail(ErrorCode::kMeshUnsupported, "binary OFF is not supported",
                   "export the mesh as ASCII OFF");
    }
  }

  bool starts_with(std::string_view text) const {
    return file_.bytes.substr(cursor_.offset()).starts_with(text);
  }

  void read_counts() {
    const std::uint64_t vertices = next_count("the vertex count");
    face_count_ = next_count("the face count");
    // The third count, of edges, is missing in some files and means nothing here.
    if (!at_rest_of_line_end() || next_line_is_one_word()) next_count("the edge count");
    check_count(file_, vertices, "vertices");
    vertex_count_ = vertices;
    constexpr std::uint64_t kVertexBytes = 6, kFaceBytes = 4;  // "0 0 0\n", "1 0\n"
    if (vertex_count_ > cursor_.bytes_left() / kVertexBytes + 1 ||
        face_count_ > cursor_.bytes_left() / kFaceBytes + 1) {
      cursor_.fail(ErrorCode::kMeshIncomplete,
                   "the header announces " + std::to_string(vertex_count_) + " vertices and " +
                       counted(face_count_, "face") + ", but the file is too short for them",
                   "copy or export the file again");
    }
  }

  std::uint64_t next_count(const char* what) {
    cursor_.skip_space('#');
    if (cursor_.at_end()) {
      cursor_.fail(ErrorCode::kMeshIncomplete, std::string("the file ends before ") + what,
                   "copy or export the file again");
    }
    return cursor_.count(what);
  }

  bool at_rest_of_line_end() {
    cursor_.skip_blanks();
    return cursor_.at_line_end() || cursor_.peek() == '#';
  }

  bool next_line_is_one_word() const {
    TextCursor ahead = cursor_;
    ahead.skip_space('#');
    return !ahead.word().empty() && (ahead.skip_blanks(), ahead.at_line_end());
  }

  void read_vertices() {
    mesh_.vertices.reserve(vertex_count_);
    for (std::uint64_t i = 0; i < vertex_count_; ++i) {
      Vec3d vertex;
      for (double& coordinate : vertex) {
        next_token("vertex", i, vertex_count_);
        coordinate = cursor_.number("a coordinate");
      }
      mesh_.vertices.push_back(vertex);
      if (has_vertex_extras_) {
        cursor_.skip_to_line_end();
      } else if (!at_rest_of_line_end()) {
        cursor_.fail(
            ErrorCode::kMeshUnreadable,
            "vertex " + std::to_string(i) + " has more than three numbers in a plain OFF file",
            "for colors or normals the file must begin with COFF or NOFF");
      }
    }
  }

  void read_face(std::uint64_t face) {
    next_token("face", face, face_count_);
    const std::uint64_t place = cursor_.offset();
    const std::uint64_t corner_count = cursor_.count("the number of corners");
    if (corner_count < 3 || corner_count > cursor_.bytes_left()) {
      cursor_.fail_at(place, ErrorCode::kMeshUnreadable,
                      counted(corner_count, "corner") + " do not make a face",
                      "export the mesh again");
    }
    corners_.clear();
    for (std::uint64_t i = 0; i < corner_count; ++i) {
      next_token("face", face, face_count_);
      const std::uint64_t index_place = cursor_.offset();
      const std::uint64_t index = cursor_.count("a vertex number");
      if (index >= vertex_count_) {
        cursor_.fail_at(index_place, ErrorCode::kMeshUnreadable,
                        "face " + std::to_string(face) + " uses vertex " + std::to_string(index) +
                            ", but there are only " + std::to_string(vertex_count_) +
                            " vertices, counted from 0",
                        "export the mesh again");
      }
      corners_.push_back(static_cast<std::uint32_t>(index));
    }
    cursor_.skip_to_line_end();  // colors
    splitter_.split(corners_, mesh_);
  }

  void next_token(const char* what, std::uint64_t index, std::uint64_t count) {
    cursor_.skip_space('#');
    if (!cursor_.at_end()) return;
    cursor_.fail(ErrorCode::kMeshIncomplete,
                 "the file ends before the end of " + std::string(what) + " " +
                     std::to_string(index) + " of " + std::to_string(count),
                 "copy or export the file again");
  }

  void check_nothing_left() {
    cursor_.skip_space('#');
    if (cursor_.at_end()) return;
    cursor_.fail(ErrorCode::kMeshIncomplete,
                 "the file has more data than the " + counted(face_count_, "face") +
                     " that the header announces: the count may be wrong",
                 "export the mesh again");
  }

  const SourceFile& file_;
  TextCursor cursor_;
  bool has_vertex_extras_ = false;
  std::uint64_t vertex_count_ = 0;
  std::uint64_t face_count_ = 0;
  Mesh mesh_{{}, {}, /*single_precision=*/false};
  std::vector<std::uint32_t> corners_;
  PolygonSplitter splitter_;
};

}  // namespace

Assembly read_off(const SourceFile& file) { return OffReader(file).read(); }

}  // namespace forcelayer::mesh
