// Stands in for vdb.cpp in a build without OpenVDB.
#include "formats/voxinfo/export.h"

namespace forcelayer::voxinfo {

Status export_voxmap_vdb(const Voxmap&, const std::string& out) {
  return Error{ErrorCode::kUsage, out, "", "this build has no OpenVDB and writes no .vdb",
               "export .csv or .ply, or use a build with the offline tools"};
}

}  // namespace forcelayer::voxinfo
