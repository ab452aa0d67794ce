// Baked files in formats that other programs read.
#pragma once

#include <optional>
#include <string>

#include "formats/voxinfo/files.h"

namespace forcelayer::voxinfo {

// Writes `file` (read from `path`) to `out` in the format that the name's ending asks for: .csv
// (i,j,k,value of every non-free voxel), .vdb, .stl, .glb or .ply (a surface that contains all
// points within `offset_m` of the solid, or a shell's points). Errors: kUsage for an ending that is
// not one of these or does not fit the file, an offset that has no effect, a format whose library
// this build lacks, and those of solid_surface().
Status export_baked_file(const BakedFile& file, const std::string& path, const std::string& out,
                         std::optional<double> offset_m);

// The single formats; memory does not grow with the scene's volume.
Status export_voxmap_csv(const Voxmap& map, const std::string& out);
Status export_pshell_ply(const Pshell& shell, const std::string& out);
// Grids of OpenVDB's own types; index (i, j, k) is world voxel (i, j, k), and the transform puts it
// at the voxel's center in meters:
//   "voxmap"      Int32: VoxelValues, active where not free
//   "distance_m"  Float: the lower ends of the stored distances' steps, m; the background is that
//   of
//                 code 255, and all other codes are active; only where the map stores distances
//   "object"      Int32: numbers of the nearest objects, active where there is one; only where the
//                 map stores objects
Status export_voxmap_vdb(const Voxmap& map, const std::string& out);

}  // namespace forcelayer::voxinfo
