// Draco streams: whole .drc files and the compressed primitives of glTF.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "formats/mesh/mesh.h"
#include "formats/mesh/reader.h"

namespace forcelayer::mesh {

struct DracoQuantization {
  int bits = 0;
  double step = 0;  // between neighboring positions, file units
};

struct DracoSurface {
  std::vector<Vec3d> vertices;
  std::vector<Triangle> triangles;
  std::optional<DracoQuantization> quantization;  // none: positions are exact
};

// Decodes the triangle mesh in `stream`, a part of `file` that errors name as `where`. Positions
// are the attribute of the unique id `position_id` or, without one, the first of position type.
DracoSurface decode_draco(const SourceFile& file, std::string_view stream, const std::string& where,
                          std::optional<std::uint32_t> position_id);

// The warning that positions were rounded, with the bound for --mesh-deviation.
std::string quantization_warning(const DracoQuantization& quantization);

}  // namespace forcelayer::mesh
