// STL, binary and ASCII. A file of the size that its binary header announces is binary. The word
// "solid" does not decide, because binary files may start with it too.
#include <bit>
#include <cstring>

#include "formats/mesh/foreign_files.h"
#include "formats/mesh/reader.h"
#include "formats/mesh/readers/text_cursor.h"

namespace forcelayer::mesh {
namespace {

constexpr std::uint64_t kHeaderBytes = 84;    // 80 of text, a 32-bit count
constexpr std::uint64_t kTriangleBytes = 50;  // normal, three vertices, 16 bits of attributes
constexpr std::uint64_t kNormalBytes = 12;

static_assert(std::endian::native == std::endian::little, "binary STL is read in place");

bool equal_ignoring_case(std::string_view word, std::string_view lower_case) {
  if (word.size() != lower_case.size()) return false;
  for (std::size_t i = 0; i < word.size(); ++i) {
    if ((word[i] | 0x20) != lower_case[i]) return false;
  }
  return true;
}

std::uint32_t announced_triangles(std::string_view bytes) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, sizeof count);
  return count;
}

bool starts_as_text(const SourceFile& file) {
  TextCursor cursor(file);
  cursor.skip_space();
  if (!equal_ignoring_case(cursor.word().substr(0, 5), "solid")) return false;
  // A binary triangle holds zero bytes (its attributes at the latest), a text file none.
  return file.bytes.substr(0, 2 * kHeaderBytes).find('\0') == std::string_view::npos;
}

void check_binary_size(const SourceFile& file) {
  const std::uint64_t bytes = file.bytes.size();
  if (bytes < kHeaderBytes) {
    refuse_foreign_content(file);
    fail_read(file, ErrorCode::kMeshUnreadable, at_byte(bytes),
              "the file is neither a binary STL (84 bytes or more) nor an ASCII STL (beginning "
              "with 'solid')",
              "export the mesh again");
  }
  const std::uint64_t announced = announced_triangles(file.bytes);
  const std::uint64_t expected = kHeaderBytes + announced * kTriangleBytes;
  if (bytes == expected) return;
  refuse_foreign_content(file);
  const std::string counts = "the header announces " + counted(announced, "triangle") + " (" +
                             std::to_string(expected) + " bytes), but the file has " +
                             std::to_string(bytes) + " bytes";
  if (bytes < expected) {
    fail_read(file, ErrorCode::kMeshIncomplete, at_byte(bytes), "binary STL is cut off: " + counts,
              "copy or export the file again");
  }
  fail_read(file, ErrorCode::kMeshIncomplete, at_byte(expected),
            "binary STL has bytes after its last triangle: " + counts +
                "; the number in the header may be wrong",
            "export the mesh again");
}

Mesh read_binary(const SourceFile& file) {
  check_binary_size(file);
  const std::uint64_t count = announced_triangles(file.bytes);
  check_count(file, 3 * count, "vertices");
  Mesh mesh;
  mesh.vertices.resize(3 * count);
  mesh.triangles.resize(count);
  const char* at = file.bytes.data() + kHeaderBytes;
  for (std::uint64_t t = 0; t < count; ++t, at += kTriangleBytes) {
    float corners[9];
    std::memcpy(corners, at + kNormalBytes, sizeof corners);
    for (std::size_t i = 0; i < 9; ++i) mesh.vertices[3 * t + i / 3][i % 3] = corners[i];
    const auto first = static_cast<std::uint32_t>(3 * t);
    mesh.triangles[t] = {first, first + 1, first + 2};
  }
  return mesh;
}

class AsciiReader {
 public:
  explicit AsciiReader(const SourceFile& file) : file_(file), cursor_(file) {}

  Mesh read() {
    for (cursor_.skip_space(); !cursor_.at_end(); cursor_.skip_space()) read_solid();
    return std::move(mesh_);
  }

 private:
  void read_solid() {
    expect("solid");
    cursor_.skip_to_line_end();
    for (;;) {
      const std::string_view word = next_word("'facet' or 'endsolid'");
      if (equal_ignoring_case(word, "endsolid")) break;
      if (!equal_ignoring_case(word, "facet")) fail_word(word, "'facet' or 'endsolid'");
      cursor_.skip_to_line_end();  // the normal says nothing that the vertices do not
      read_facet();
    }
    cursor_.skip_to_line_end();
  }

  void read_facet() {
    expect("outer");
    expect("loop");
    const auto first = static_cast<std::uint32_t>(mesh_.vertices.size());
    for (int corner = 0; corner < 3; ++corner) {
      expect("vertex");
      const double x = cursor_.number("a coordinate");
      const double y = cursor_.number("a coordinate");
      const double z = cursor_.number("a coordinate");
      mesh_.vertices.push_back({x, y, z});
    }
    expect("endloop");
    expect("endfacet");
    mesh_.triangles.push_back({first, first + 1, first + 2});
    check_count(file_, mesh_.vertices.size(), "vertices");
  }

  std::string_view next_word(const std::string& expected) {
    cursor_.skip_space();
    if (cursor_.at_end()) {
      cursor_.fail(ErrorCode::kMeshIncomplete,
                   "ASCII STL is cut off after " + counted(mesh_.triangles.size(), "facet") + ": " +
                       expected + " is missing",
                   "copy or export the file again");
    }
    return cursor_.word();
  }

  void expect(std::string_view keyword) {
    const std::string expected = in_quotes(keyword);
    const std::string_view word = next_word(expected);
    if (!equal_ignoring_case(word, keyword)) fail_word(word, expected);
  }

  [[noreturn]] void fail_word(std::string_view word, const std::string& expected) {
    cursor_.fail(ErrorCode::kMeshUnreadable, in_quotes(word) + " is not " + expected,
                 "export the mesh again");
  }

  const SourceFile& file_;
  TextCursor cursor_;
  Mesh mesh_;
};

}  // namespace

Assembly read_stl(const SourceFile& file) {
  const bool binary_size =
      file.bytes.size() >= kHeaderBytes &&
      file.bytes.size() == kHeaderBytes + kTriangleBytes * announced_triangles(file.bytes);
  const bool text = !binary_size && starts_as_text(file);
  Mesh mesh = text ? AsciiReader(file).read() : read_binary(file);
  mesh.single_precision = !text;
  check_finite(file, mesh);
  return assembly_of(file, std::move(mesh));
}

}  // namespace forcelayer::mesh
