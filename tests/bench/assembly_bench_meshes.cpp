#include "tests/bench/assembly_bench_meshes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <stdexcept>

#include "tests/stress/shapes.h"

namespace forcelayer::bench {
namespace {

// ISO 68-1: the height of the fundamental triangle, and the corners of the basic profile over one
// pitch: the crest is P/8 wide, the root P/4, and 5/8 of H lie between them.
const double kTriangleM = std::sqrt(3.0) / 2 * kPitchM;
constexpr std::array<double, 4> kCorners{-kPitchM / 16, kPitchM / 16, kPitchM * 3 / 8,
                                         kPitchM * 5 / 8};

// The z of the k-th corner along the helix at a fraction of a turn.
double corner_m(int k, double turn) {
  const int pitch = k >= 0 ? k / 4 : (k - 3) / 4;
  return kPitchM * (pitch + turn) + kCorners[static_cast<std::size_t>(k - 4 * pitch)];
}

// A body of revolution but for its thread: columns of vertices around the axis, whose last but one
// row of each end lies on the end's rim. Rows follow the helix and are cut at the ends, so a
// column's k-th corner is the (k + 4)-th of the column a turn before.
mesh::Mesh threaded(double half_m, double play_m, bool inside,
                    const std::function<double(double)>& rim_m) {
  mesh::Mesh mesh;
  mesh.single_precision = false;
  const int first = -4 * static_cast<int>(std::ceil(half_m / kPitchM)) - 8;
  const int rows = 2 * (-first) + 4;
  const auto at = [&](int column, int row) {
    const int turned = column == kFacesAround ? 4 : 0;
    return static_cast<std::uint32_t>((column % kFacesAround) * (rows + 2) + 1 +
                                      std::min(row + turned, rows - 1));
  };
  for (int i = 0; i < kFacesAround; ++i) {
    const double turn = static_cast<double>(i) / kFacesAround, angle = 2 * M_PI * turn;
    const auto add = [&](double radius_m, double z_m) {
      mesh.vertices.push_back({radius_m * std::cos(angle), radius_m * std::sin(angle), z_m});
    };
    add(rim_m(angle), -half_m);
    for (int row = 0; row < rows; ++row) {
      const double z_m = std::clamp(corner_m(first + row, turn), -half_m, half_m);
      add(thread_radius_m(z_m - kPitchM * turn) + play_m / 2, z_m);
    }
    add(rim_m(angle), half_m);
  }
  const auto end_of = [&](int column, bool high) {
    return static_cast<std::uint32_t>((column % kFacesAround) * (rows + 2) + (high ? rows + 1 : 0));
  };
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    for (mesh::Triangle t : {mesh::Triangle{a, b, c}, mesh::Triangle{a, c, d}}) {
      if (inside) std::swap(t[1], t[2]);
      const auto& v = mesh.vertices;
      if (v[t[0]] != v[t[1]] && v[t[1]] != v[t[2]] && v[t[2]] != v[t[0]])
        mesh.triangles.push_back(t);
    }
  };
  for (int i = 0; i < kFacesAround; ++i) {
    for (int row = 0; row + 1 < rows; ++row) {
      quad(at(i, row), at(i + 1, row), at(i + 1, row + 1), at(i, row + 1));
    }
    // The ends: from the thread to the rim.
    quad(end_of(i, false), end_of(i + 1, false), at(i + 1, 0), at(i, 0));
    quad(at(i, rows - 1), at(i + 1, rows - 1), end_of(i + 1, true), end_of(i, true));
    if (inside) quad(end_of(i, true), end_of(i + 1, true), end_of(i + 1, false), end_of(i, false));
  }
  return mesh;
}

}  // namespace

mesh::Mesh peg() { return stress::cylinder(kPegRadiusM, kPegLengthM / 2, kFacesAround); }

mesh::Mesh plate_with_hole(double clearance_m, double chamfer_m) {
  const double outside = 1 / std::cos(M_PI / kFacesAround);
  const double inner_m = (kPegRadiusM + clearance_m / 2) * outside, outer_m = 4 * kPegRadiusM;
  std::vector<glm::dvec2> profile{{inner_m, -kPlateM}, {outer_m, -kPlateM}, {outer_m, 0}};
  profile.push_back({inner_m + chamfer_m, 0});
  if (chamfer_m > 0) profile.push_back({inner_m, -chamfer_m});
  return stress::revolved(profile, kFacesAround);
}

double thread_radius_m(double height_m) {
  const double from_crest = std::abs(std::remainder(height_m, kPitchM));
  const double flank = (from_crest - kPitchM / 16) / (kPitchM * 5 / 16);
  return kThreadDiameterM / 2 - std::clamp(flank, 0.0, 1.0) * kTriangleM * 5 / 8;
}

mesh::Mesh bolt() {
  return threaded(kBoltLengthM / 2, 0, false, [](double) { return 0.0; });
}

mesh::Mesh nut(double play_m) {
  return threaded(kNutHeightM / 2, play_m, true, [](double angle) {
    const double sixth = M_PI / 3;
    return kAcrossFlatsM / 2 / std::cos(std::remainder(angle, sixth));
  });
}

void write_obj(const mesh::Mesh& mesh, const std::filesystem::path& path) {
  std::ofstream file(path);
  file.precision(std::numeric_limits<double>::max_digits10);
  for (const mesh::Vec3d& v : mesh.vertices) {
    file << "v " << 1e3 * v[0] << ' ' << 1e3 * v[1] << ' ' << 1e3 * v[2] << '\n';
  }
  for (const mesh::Triangle& t : mesh.triangles) {
    file << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
  }
  if (!file.flush()) throw std::runtime_error("cannot write " + path.string());
}

}  // namespace forcelayer::bench
