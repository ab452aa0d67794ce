// Stands in for vdb.cpp and glb.cpp in a build without the offline libraries.
#include "formats/voxinfo/export.h"
#include "formats/voxinfo/surface.h"

namespace forcelayer::voxinfo {

Status export_voxmap_vdb(const Voxmap&, const std::string& out) {
  return Error{ErrorCode::kUsage, out, "", "this build has no OpenVDB and writes no .vdb",
               "export .csv, or use a build with the offline tools"};
}

Status write_surface_glb(const SolidSurface&, const std::string& out) {
  return Error{ErrorCode::kUsage, out, "", "this build has no mesh library and writes no .glb",
               "export .stl or .ply, or use a build with the offline tools"};
}

}  // namespace forcelayer::voxinfo
