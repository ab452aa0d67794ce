// Draco streams for tests, written by Draco's own encoder.
#pragma once

#include <draco/compression/encode.h>
#include <draco/core/encoder_buffer.h>
#include <draco/mesh/mesh.h>

#include <stdexcept>
#include <string>

#include "formats/mesh/mesh.h"

namespace forcelayer::test {

struct DracoChoice {
  int position_bits = 0;     // 0: positions are stored as they are
  bool edgebreaker = false;  // else sequential, which keeps the order of faces and vertices
};

inline std::string as_drc(const mesh::Mesh& mesh, const DracoChoice& choice = {}) {
  draco::Mesh encoded;
  const auto count = static_cast<std::uint32_t>(mesh.vertices.size());
  encoded.set_num_points(count);
  draco::GeometryAttribute attribute;
  attribute.Init(draco::GeometryAttribute::POSITION, nullptr, 3, draco::DT_FLOAT32, false,
                 3 * sizeof(float), 0);
  const int id = encoded.AddAttribute(attribute, true, count);
  for (std::uint32_t i = 0; i < count; ++i) {
    std::array<float, 3> position{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      position[axis] = static_cast<float>(mesh.vertices[i][axis]);
    }
    encoded.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i), position.data());
  }
  for (const auto& [a, b, c] : mesh.triangles) {
    encoded.AddFace({{draco::PointIndex(a), draco::PointIndex(b), draco::PointIndex(c)}});
  }
  draco::Encoder encoder;
  encoder.SetEncodingMethod(choice.edgebreaker ? draco::MESH_EDGEBREAKER_ENCODING
                                               : draco::MESH_SEQUENTIAL_ENCODING);
  if (choice.position_bits > 0) {
    encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, choice.position_bits);
  }
  draco::EncoderBuffer buffer;
  if (!encoder.EncodeMeshToBuffer(encoded, &buffer).ok()) throw std::runtime_error("no stream");
  return {buffer.data(), buffer.size()};
}

}  // namespace forcelayer::test
