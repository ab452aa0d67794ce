// The contacts with a formula as triangle meshes, for the peers that know nothing else.
#pragma once

#include "formats/mesh/mesh.h"
#include "tests/bench/wrench_bench_case.h"

namespace forcelayer::bench {

// The part in its own frame, m; its triangles deviate from it by at most `deviation_m`.
mesh::Mesh part_mesh(Part part, double deviation_m);

// The surface at `offset_m` in front of the body's, world frame, facing free space, half a meter
// each way; rounded around a convex edge.
mesh::Mesh offset_mesh(const AnalyticStatic& body, double offset_m, double deviation_m);

}  // namespace forcelayer::bench
