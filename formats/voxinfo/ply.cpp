// PLY, binary little-endian.
#include "formats/voxinfo/export.h"
#include "formats/voxinfo/output.h"
#include "formats/voxinfo/surface.h"

namespace forcelayer::voxinfo {
namespace {

std::string header_text(const char* comment, std::uint64_t vertices, const char* properties,
                        std::uint64_t faces) {
  std::string text = "ply\nformat binary_little_endian 1.0\ncomment ";
  text += comment;
  text += "\nelement vertex " + std::to_string(vertices) +
          "\nproperty double x\nproperty double y\nproperty double z\n" + properties;
  if (faces > 0) {
    text += "element face " + std::to_string(faces) + "\nproperty list uchar int vertex_indices\n";
  }
  return text + "end_header\n";
}

}  // namespace

Status write_ply(const SolidSurface& surface, const std::string& out) {
  auto ply = BufferedOutput::create(out);
  if (!ply) return ply.error();
  ply->append(header_text("surface that contains the solid, meters", surface.vertices_m.size(), "",
                          surface.triangles.size()));
  for (const auto& vertex : surface.vertices_m) {
    for (const double coordinate : vertex) ply->append_number(coordinate);
  }
  for (const auto& triangle : surface.triangles) {
    ply->append_number(std::uint8_t{3});
    for (const std::uint32_t vertex : triangle) {
      ply->append_number(static_cast<std::int32_t>(vertex));
    }
  }
  return ply->finish();
}

Status export_pshell_ply(const Pshell& shell, const std::string& out) {
  auto ply = BufferedOutput::create(out);
  if (!ply) return ply.error();
  const PshellView& v = shell.view();
  ply->append(header_text("shell points with inward normals, meters, part frame", v.point_count,
                          "property float nx\nproperty float ny\nproperty float nz\n"
                          "property float weight_m2\nproperty uint block\n",
                          0));
  const auto& center = shell.header().center_m;
  for (std::size_t i = 0; i < v.point_count; ++i) {
    for (const double coordinate : {center[0] + v.x[i], center[1] + v.y[i], center[2] + v.z[i]}) {
      ply->append_number(coordinate);
    }
    for (const float number : {v.nx[i], v.ny[i], v.nz[i], v.weight_m2[i]}) {
      ply->append_number(number);
    }
    ply->append_number(static_cast<std::uint32_t>(i / v.block_points));
  }
  return ply->finish();
}

}  // namespace forcelayer::voxinfo
