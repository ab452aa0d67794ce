// The meshes of assembly_bench, by their formulas: a peg, a plate with a chamfered
// hole, a bolt and a nut of ISO metric thread. All are closed; lengths are in meters.
#pragma once

#include <filesystem>

#include "formats/mesh/mesh.h"

namespace forcelayer::bench {

// Faces around an axis. A circle's chord lies r (1 - cos(pi / 96)) = 0.00054 r inside it.
inline constexpr int kFacesAround = 96;

inline constexpr double kPegRadiusM = 0.005, kPegLengthM = 0.03, kPlateM = 0.02;

// About its middle, along z.
mesh::Mesh peg();
// From z = -kPlateM to 0, wider than the peg by `clearance_m` in diameter; `chamfer_m` by 45
// degrees at its mouth. Its faces touch the circle from outside.
mesh::Mesh plate_with_hole(double clearance_m, double chamfer_m);

// M20, coarse pitch; the basic profile of ISO 68-1.
inline constexpr double kThreadDiameterM = 0.02, kPitchM = 0.0025;
inline constexpr double kBoltLengthM = 0.03, kNutHeightM = 0.01, kAcrossFlatsM = 0.03;

// Radius of the basic profile at `height` in the pitch, 0 at the middle of a crest.
double thread_radius_m(double height_m);
// A threaded rod about its middle.
mesh::Mesh bolt();
// About its middle; its thread is the bolt's with `play_m` more of diameter, and in phase with it.
mesh::Mesh nut(double play_m);

void write_obj(const mesh::Mesh& mesh, const std::filesystem::path& path);

}  // namespace forcelayer::bench
