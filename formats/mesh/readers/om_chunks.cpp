#include "formats/mesh/readers/om_chunks.h"

#include <bit>
#include <cstring>
#include <set>

namespace forcelayer::mesh {
namespace {

static_assert(std::endian::native == std::endian::little, "OM files are read in place");

enum Entity : unsigned {
  kVertex = 0,
  kMesh = 1,
  kFace = 2,
  kEdge = 4,
  kHalfedge = 6,
  kSentinel = 7
};
enum Type : unsigned {
  kPosition = 0,
  kNormal = 1,
  kTexcoord = 2,
  kStatus = 3,
  kColor = 4,
  kCustom = 6,
  kTopology = 7
};

constexpr std::uint8_t version(unsigned major, unsigned minor) {
  return static_cast<std::uint8_t>(major << 5 | minor);
}

// The 16 bits that start a chunk.
struct ChunkHeader {
  std::uint16_t bits;

  bool has_name() const { return (bits >> 1 & 1) != 0; }
  unsigned entity() const { return bits >> 2 & 7; }
  unsigned type() const { return bits >> 5 & 15; }
  bool is_float() const { return (bits >> 10 & 1) != 0; }
  std::uint64_t dimensions() const { return (bits >> 11 & 7) + 1; }
  std::uint64_t integer_bytes() const { return 1ull << (bits >> 14); }
  std::uint64_t scalar_bytes() const { return is_float() ? 4ull << (bits >> 14) : integer_bytes(); }
};

class ChunkWalker {
 public:
  explicit ChunkWalker(const SourceFile& file) : file_(file) {}

  OmContent walk() {
    read_header();
    while (at_ != file_.bytes.size() && read_chunk()) {
    }
    check_complete();
    return std::move(content_);
  }

 private:
  void read_header() {
    if (!file_.bytes.starts_with("OM")) {
      fail(ErrorCode::kMeshUnreadable, "not an OpenMesh file: it does not start with 'OM'");
    }
    at_ = 2;
    kind_ = value<char>();
    version_ = value<std::uint8_t>();
    content_.vertices = value<std::uint32_t>();
    content_.faces = value<std::uint32_t>();
    content_.edges = value<std::uint32_t>();
    if (kind_ != 'T' && kind_ != 'Q' && kind_ != 'P') {
      fail(ErrorCode::kMeshUnreadable, "the OpenMesh file has an unknown kind of faces");
    }
    if (version_ > version(2, 2)) {
      fail(ErrorCode::kMeshUnsupported, "the version of this OpenMesh file is newer than 2.2");
    }
    content_.stripped = file_.bytes.substr(0, at_);
  }

  // Steps over one chunk; false at the sentinel that ends newer files.
  bool read_chunk() {
    const std::uint64_t start = at_;
    const ChunkHeader header{value<std::uint16_t>()};
    if (header.has_name()) skip_name();
    if (header.entity() == kSentinel) {
      content_.stripped += file_.bytes.substr(start, at_ - start);
      return false;
    }
    const bool wanted = header.type() == kPosition || header.type() == kTopology;
    if (wanted && !seen_.insert({header.entity(), header.type()}).second) {
      fail(ErrorCode::kMeshUnreadable, "positions or topology are stored twice");
    }
    skip_data(header);
    if (wanted) content_.stripped += file_.bytes.substr(start, at_ - start);
    return true;
  }

  void skip_data(ChunkHeader header) {
    switch (header.type()) {
      case kPosition:
        return skip_positions(header);
      case kTopology:
        return skip_topology(header);
      case kStatus:
        return skip_status(header);
      case kCustom:
        if (version_ > version(2, 1)) skip_name();  // the property's type
        return skip(value<std::uint32_t>());
      case kNormal:
      case kTexcoord:
      case kColor:
        return skip(count_of(header) * header.dimensions() * header.scalar_bytes());
      default:
        fail(ErrorCode::kMeshUnsupported, "the chunk has an unknown type");
    }
  }

  void skip_positions(ChunkHeader header) {
    const bool known = header.entity() == kVertex && header.is_float() &&
                       header.dimensions() == 3 && header.scalar_bytes() <= 8;
    if (!known)
      fail(ErrorCode::kMeshUnsupported,
           "each position must belong to a vertex and consist of three floats or three doubles");
    content_.single_precision = header.scalar_bytes() == 4;
    skip(content_.vertices * 3ull * header.scalar_bytes());
  }

  void skip_topology(ChunkHeader header) {
    // OpenMesh knows no other, and would take their bytes for the next chunk.
    if (header.entity() != kVertex && header.entity() != kFace && header.entity() != kHalfedge) {
      fail(ErrorCode::kMeshUnsupported,
           "the topology does not consist of vertices, faces and halfedges");
    }
    const std::uint64_t faces = content_.faces;
    if (header.entity() == kFace && version_ < version(2, 0)) {
      if (kind_ != 'P') return skip(faces * (kind_ == 'T' ? 3 : 4) * header.integer_bytes());
      for (std::uint64_t i = 0; i < faces; ++i) {
        skip(value<std::uint16_t>() * header.integer_bytes());
      }
      return;
    }
    // Next halfedge, vertex and face for each halfedge; one halfedge for each vertex and face.
    const std::uint64_t numbers = header.entity() == kHalfedge ? 3 : 1;
    skip(count_of(header) * numbers * header.integer_bytes());
  }

  void skip_status(ChunkHeader header) {
    constexpr std::uint64_t kStatusBytes = 4;
    constexpr std::uint32_t kDeleted = 1;
    const std::uint64_t first = at_;
    skip(count_of(header) * kStatusBytes);
    if (header.entity() != kFace) return;
    for (at_ = first; at_ != first + count_of(header) * kStatusBytes;) {
      if ((value<std::uint32_t>() & kDeleted) == 0) continue;
      fail(ErrorCode::kMeshUnsupported, "some faces are marked as deleted",
           "call garbage_collection() before you write the mesh");
    }
  }

  std::uint64_t count_of(ChunkHeader header) const {
    switch (header.entity()) {
      case kVertex:
        return content_.vertices;
      case kFace:
        return content_.faces;
      case kEdge:
        return content_.edges;
      case kHalfedge:
        return 2ull * content_.edges;
      case kMesh:
        return 1;
      default:
        fail(ErrorCode::kMeshUnsupported, "the chunk belongs to an unknown entity");
    }
  }

  void skip_name() { skip(value<std::uint8_t>()); }

  void skip(std::uint64_t bytes) {
    if (bytes > file_.bytes.size() - at_) fail_end();
    at_ += bytes;
  }

  template <typename T>
  T value() {
    T value;
    if (file_.bytes.size() - at_ < sizeof value) fail_end();
    std::memcpy(&value, file_.bytes.data() + at_, sizeof value);
    at_ += sizeof value;
    return value;
  }

  void check_complete() const {
    const bool has_faces = seen_.contains({kFace, kTopology}) &&
                           (version_ < version(2, 0) || (seen_.contains({kHalfedge, kTopology}) &&
                                                         seen_.contains({kVertex, kTopology})));
    if ((content_.vertices > 0 && !seen_.contains({kVertex, kPosition})) ||
        (content_.faces > 0 && !has_faces)) {
      fail(ErrorCode::kMeshIncomplete,
           "the header announces " + std::to_string(content_.vertices) + " vertices and " +
               counted(content_.faces, "face") + ", but chunks are missing",
           "copy or write the file again");
    }
  }

  [[noreturn]] void fail_end() const {
    fail(ErrorCode::kMeshIncomplete, "the file ends inside a chunk",
         "copy or write the file again");
  }
  [[noreturn]] void fail(ErrorCode code, std::string what, std::string mend = {}) const {
    fail_read(file_, code, at_byte(at_), std::move(what), std::move(mend));
  }

  const SourceFile& file_;
  std::uint64_t at_ = 0;
  char kind_ = 0;
  std::uint8_t version_ = 0;
  std::set<std::pair<unsigned, unsigned>> seen_;  // entity and type of the chunks that are wanted
  OmContent content_;
};

}  // namespace

OmContent read_om_chunks(const SourceFile& file) { return ChunkWalker(file).walk(); }

}  // namespace forcelayer::mesh
