// Baked files in formats that other programs read.
#pragma once

#include <string>

#include "formats/voxinfo/files.h"

namespace forcelayer::voxinfo {

// Writes `file` to `out` in the format that the name's ending asks for: .csv (i,j,k,value of every
// non-free voxel), .ply (the force layer's voxel faces, or a shell's points) or .vdb. Errors:
// kUsage for an ending that is none of these or does not fit the file, or a .vdb in a build without
// OpenVDB.
Status export_baked_file(const BakedFile& file, const std::string& out);

// The single formats; memory does not grow with the scene's volume.
Status export_voxmap_csv(const Voxmap& map, const std::string& out);
Status export_voxmap_ply(const Voxmap& map, const std::string& out);
Status export_pshell_ply(const Pshell& shell, const std::string& out);
// A UInt8 grid of VoxelValues named "voxmap": index (i, j, k) is world voxel (i, j, k), active
// where not free, and the transform puts it at the voxel's center in meters.
Status export_voxmap_vdb(const Voxmap& map, const std::string& out);

}  // namespace forcelayer::voxinfo
