#include "formats/mesh/readers/draco_stream.h"

#include <draco/attributes/attribute_quantization_transform.h>
#include <draco/compression/config/compression_shared.h>
#include <draco/compression/decode.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/metadata_decoder.h>

#include <cmath>
#include <sstream>

namespace forcelayer::mesh {
namespace {

constexpr std::uint16_t kVersion20 = DRACO_BITSTREAM_VERSION(2, 0);
constexpr std::uint16_t kVersion22 = DRACO_BITSTREAM_VERSION(2, 2);

// A regular grid takes about a hundredth of a bit for a face. No encoder writes ten thousand faces
// a byte; a damaged count that announces more must not take gigabytes.
constexpr std::uint64_t kMaxPerByte = 10'000;

// A stream, its place in the file, and its errors.
struct Stream {
  const SourceFile& file;
  std::string_view bytes;
  const std::string& where;

  [[noreturn]] void fail(ErrorCode code, std::string what) const {
    fail_read(file, code, where, std::move(what), "encode the mesh again");
  }
};

// The counts at the head of a mesh stream. The decoder takes memory for them unchecked.
class CountReader {
 public:
  explicit CountReader(const Stream& stream) : stream_(stream) {
    buffer_.Init(stream.bytes.data(), stream.bytes.size());
  }

  // Checks every count against the stream's size; returns that of the faces.
  std::uint64_t read_faces() {
    read_header();
    if (method_ == draco::MESH_SEQUENTIAL_ENCODING) {
      const std::uint64_t faces = count(kVersion22, "faces");
      count(kVersion22, "points");
      return faces;
    }
    if (method_ != draco::MESH_EDGEBREAKER_ENCODING) {
      stream_.fail(ErrorCode::kMeshUnreadable, "the Draco stream has an unknown encoding");
    }
    value<std::uint8_t>();  // traversal
    if (version_ < kVersion22) count(kVersion20, "vertices");
    count(kVersion20, "vertices");
    const std::uint64_t faces = count(kVersion20, "faces");
    value<std::uint8_t>();  // attributes
    count(kVersion20, "symbols");
    count(kVersion20, "split symbols");
    return faces;
  }

 private:
  void read_header() {
    buffer_.Advance(5);  // "DRACO"
    const auto major = value<std::uint8_t>();
    const auto minor = value<std::uint8_t>();
    version_ = DRACO_BITSTREAM_VERSION(major, minor);
    buffer_.set_bitstream_version(version_);
    value<std::uint8_t>();  // geometry
    method_ = value<std::uint8_t>();
    const auto flags = value<std::uint16_t>();
    if (version_ < DRACO_BITSTREAM_VERSION(1, 3) || (flags & METADATA_FLAG_MASK) == 0) return;
    draco::GeometryMetadata metadata;
    if (!draco::MetadataDecoder().DecodeGeometryMetadata(&buffer_, &metadata)) fail_end();
  }

  template <typename T>
  T value() {
    T value{};
    if (!buffer_.Decode(&value)) fail_end();
    return value;
  }

  // A count, of variable length from the version `varint_since` on.
  std::uint64_t count(std::uint16_t varint_since, const char* what) {
    std::uint32_t number = 0;
    if (version_ < varint_since) {
      number = value<std::uint32_t>();
    } else if (!draco::DecodeVarint(&number, &buffer_)) {
      fail_end();
    }
    if (number / kMaxPerByte <= stream_.bytes.size()) return number;
    stream_.fail(ErrorCode::kMeshIncomplete,
                 "the Draco stream announces " + std::to_string(number) + " " + what +
                     ", but has only " + std::to_string(stream_.bytes.size()) + " bytes");
  }

  [[noreturn]] void fail_end() const {
    stream_.fail(ErrorCode::kMeshIncomplete, "the Draco stream ends inside its header");
  }

  const Stream& stream_;
  draco::DecoderBuffer buffer_;
  std::uint16_t version_ = 0;
  std::uint8_t method_ = 0;
};

void check_is_mesh(const Stream& stream) {
  if (!stream.bytes.starts_with("DRACO")) {
    stream.fail(ErrorCode::kMeshUnreadable, "not a Draco stream: it does not start with 'DRACO'");
  }
  draco::DecoderBuffer buffer;
  buffer.Init(stream.bytes.data(), stream.bytes.size());
  const auto type = draco::Decoder::GetEncodedGeometryType(&buffer);
  if (!type.ok()) {
    stream.fail(ErrorCode::kMeshUnreadable, "Draco header: " + type.status().error_msg_string());
  }
  if (type.value() != draco::TRIANGULAR_MESH) {
    stream.fail(ErrorCode::kMeshEmpty, "no triangles in this Draco stream, only points");
  }
}

std::unique_ptr<draco::Mesh> decode(const Stream& stream) {
  draco::DecoderBuffer buffer;
  buffer.Init(stream.bytes.data(), stream.bytes.size());
  draco::Decoder decoder;
  decoder.SetSkipAttributeTransform(draco::GeometryAttribute::POSITION);
  auto mesh = decoder.DecodeMeshFromBuffer(&buffer);
  if (mesh.ok()) return std::move(mesh).value();
  const std::string reason = mesh.status().error_msg_string();
  stream.fail(ErrorCode::kMeshIncomplete,
              "Draco cannot decode this stream, which is cut short or damaged" +
                  (reason.empty() ? "" : " (" + reason + ")"));
}

const draco::PointAttribute& positions_of(const Stream& stream, const draco::Mesh& mesh,
                                          std::optional<std::uint32_t> position_id) {
  const draco::PointAttribute* const positions =
      position_id ? mesh.GetAttributeByUniqueId(*position_id)
                  : mesh.GetNamedAttribute(draco::GeometryAttribute::POSITION);
  if (positions == nullptr || positions->num_components() != 3) {
    stream.fail(ErrorCode::kMeshUnreadable, "the Draco stream has no three-dimensional positions");
  }
  // Draco would read any byte as a bool, although not every byte is one.
  if (positions->data_type() == draco::DT_BOOL) {
    stream.fail(ErrorCode::kMeshUnreadable, "positions are stored as booleans, not numbers");
  }
  return *positions;
}

// Undoes the quantization in double precision.
void read_quantized(const draco::PointAttribute& positions,
                    const draco::AttributeQuantizationTransform& transform, DracoSurface& surface) {
  const double steps = std::ldexp(1.0, transform.quantization_bits()) - 1;
  surface.quantization = {transform.quantization_bits(), transform.range() / steps};
  for (draco::AttributeValueIndex i(0); i < static_cast<std::uint32_t>(positions.size()); ++i) {
    std::array<std::int32_t, 3> steps_of_vertex;
    positions.GetValue(i, &steps_of_vertex);
    Vec3d& vertex = surface.vertices.emplace_back();
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      vertex[a] = transform.min_value(axis) + steps_of_vertex[a] * surface.quantization->step;
    }
  }
}

void read_vertices(const Stream& stream, const draco::PointAttribute& positions,
                   DracoSurface& surface) {
  surface.vertices.reserve(positions.size());
  draco::AttributeQuantizationTransform transform;
  if (positions.GetAttributeTransformData() != nullptr && transform.InitFromAttribute(positions)) {
    return read_quantized(positions, transform, surface);
  }
  for (draco::AttributeValueIndex i(0); i < static_cast<std::uint32_t>(positions.size()); ++i) {
    Vec3d& vertex = surface.vertices.emplace_back();
    if (!positions.ConvertValue<double, 3>(i, vertex.data())) {
      stream.fail(ErrorCode::kMeshUnreadable, "positions are stored in a type that is not numeric");
    }
  }
}

void read_triangles(const Stream& stream, const draco::Mesh& mesh,
                    const draco::PointAttribute& positions, DracoSurface& surface) {
  surface.triangles.reserve(mesh.num_faces());
  for (draco::FaceIndex f(0); f < mesh.num_faces(); ++f) {
    Triangle& triangle = surface.triangles.emplace_back();
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const draco::PointIndex point = mesh.face(f)[static_cast<int>(corner)];
      const std::uint32_t value =
          point < mesh.num_points() ? positions.mapped_index(point).value() : UINT32_MAX;
      if (value >= surface.vertices.size()) {
        stream.fail(ErrorCode::kMeshUnreadable,
                    "face " + std::to_string(f.value()) + " uses a vertex that does not exist");
      }
      triangle[corner] = value;
    }
  }
}

}  // namespace

DracoSurface decode_draco(const SourceFile& file, std::string_view bytes, const std::string& where,
                          std::optional<std::uint32_t> position_id) {
  const Stream stream{file, bytes, where};
  check_is_mesh(stream);
  const std::uint64_t faces = CountReader(stream).read_faces();
  const std::unique_ptr<draco::Mesh> mesh = decode(stream);
  if (mesh->num_faces() != faces) {
    stream.fail(ErrorCode::kMeshIncomplete, "the Draco stream announces " + counted(faces, "face") +
                                                " but has " + std::to_string(mesh->num_faces()));
  }
  const draco::PointAttribute& positions = positions_of(stream, *mesh, position_id);
  DracoSurface surface;
  read_vertices(stream, positions, surface);
  read_triangles(stream, *mesh, positions, surface);
  return surface;
}

std::string quantization_warning(const DracoQuantization& quantization) {
  std::ostringstream text;
  text << "Draco rounded the positions to " << quantization.bits << " bits, in steps of "
       << quantization.step << " file units: every vertex may be off by "
       << std::sqrt(0.75) * quantization.step << " (see --mesh-deviation)";
  return text.str();
}

}  // namespace forcelayer::mesh
