// Draco files.
#include "formats/mesh/reader.h"
#include "formats/mesh/readers/draco_stream.h"

namespace forcelayer::mesh {

Assembly read_drc(const SourceFile& file) {
  DracoSurface surface = decode_draco(file, file.bytes, "", std::nullopt);
  Mesh mesh{std::move(surface.vertices), std::move(surface.triangles), /*single_precision=*/true};
  check_finite(file, mesh);
  Assembly assembly = assembly_of(file, std::move(mesh));
  if (surface.quantization)
    assembly.warnings.push_back(quantization_warning(*surface.quantization));
  return assembly;
}

}  // namespace forcelayer::mesh
