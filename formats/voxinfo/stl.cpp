// STL, binary: 32-bit floats.
#include <cstdint>
#include <string>

#include "formats/voxinfo/output.h"
#include "formats/voxinfo/surface.h"

namespace forcelayer::voxinfo {

Status write_stl(const SolidSurface& surface, const std::string& out) {
  auto stl = BufferedOutput::create(out);
  if (!stl) return stl.error();
  std::string head = "Forcelayer: surface that contains the solid, meters";
  head.resize(80);
  stl->append(head);
  stl->append_number(static_cast<std::uint32_t>(surface.triangles.size()));
  for (const auto& triangle : surface.triangles) {
    // A normal of zeros: readers take it from the corners.
    for (int n = 0; n < 3; ++n) stl->append_number(0.0f);
    for (const std::uint32_t vertex : triangle) {
      for (const double coordinate : surface.vertices_m[vertex]) {
        stl->append_number(static_cast<float>(coordinate));
      }
    }
    stl->append_number(std::uint16_t{0});
  }
  return stl->finish();
}

}  // namespace forcelayer::voxinfo
