// `pointshell verify` on files: proves a shell that is whole, refuses one that lacks a point.
#include <gtest/gtest.h>

#include <sys/wait.h>

#include <cstdlib>

#include "pointshell/bake.h"
#include "pointshell/certificate/point_grid.h"
#include "pointshell/part/part_files.h"
#include "tests/support/mesh_files.h"
#include "tests/support/part_support.h"
#include "tests/support/places.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/stored_shell.h"

namespace forcelayer {
namespace {

using namespace testing;

// The exit status of `pointshell verify`.
int verify_status(const std::filesystem::path& shell, const std::filesystem::path& mesh) {
  const std::string command = test::command_path("pointshell") + " verify " + shell.string() + " " +
                              mesh.string() + " --units m --quiet 2>/dev/null";
  return WEXITSTATUS(std::system(command.c_str()));
}

// A point without which some sampled place is farther than the radius from all others.
std::size_t needed_point(const part::Part& part, const pointshell::BakedShell& shell,
                         std::uint64_t seed) {
  const double radius = shell.header.covering_radius_m;
  const auto& c = shell.header.center_m;
  const std::vector<part::Vec3> points = positions_of(shell);
  const certificate::PointGrid grid(points, radius);
  SurfaceDice dice(part, seed);
  for (int n = 0; n < 100000; ++n) {
    const part::Vec3 place = dice.throw_once() - part::Vec3{c[0], c[1], c[2]};
    std::vector<std::size_t> within;
    grid.visit_near(place, radius, [&](std::uint32_t point, const part::Vec3& p) {
      if (part::length(p - place) <= radius) within.push_back(point);
    });
    if (within.size() == 1) return within.front();
  }
  ADD_FAILURE() << "no point is needed; seed " << seed;
  return 0;
}

TEST(Verify, RefusesAFileThatLacksAPoint) {
  const test::ScratchFolder scratch;
  const std::pair<const char*, mesh::Mesh> shapes[] = {{"torus", torus_mesh(1, 0.3, 24)},
                                                       {"box", box_mesh(1, 2, 0.5)},
                                                       {"cone", cone_mesh(0.5, 0, 2, 32)}};
  for (const auto& [name, mesh] : shapes) {
    const auto file = scratch / (std::string(name) + ".obj");
    test::write_file(file, test::as_obj(mesh));
    const part::Part part = std::move(part::read_part({file.string()}, 1.0)).value().part;
    for (const ShellMethod method : {ShellMethod::kSurface, ShellMethod::kVoxelCenters}) {
      SCOPED_TRACE(std::string(name) + ", method " + std::to_string(static_cast<int>(method)));
      pointshell::ShellOptions options;
      options.voxel_size_m = 0.1;
      options.method = method;
      const pointshell::BakedShell shell =
          std::move(pointshell::bake_shell(part, options, [](const std::string&, double) {
          })).value();
      const auto path = scratch / "part.pshell";
      ASSERT_TRUE(write_pshell(path, shell.content()).ok());
      EXPECT_EQ(verify_status(path, file), 0);
      for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        const std::size_t needed = needed_point(part, shell, seed);
        ASSERT_TRUE(write_pshell(path, without_point(shell, needed).content()).ok());
        EXPECT_EQ(verify_status(path, file), 4) << "without point " << needed;
      }
    }
  }
}

TEST(Verify, EndsForARadiusAndACenterThatNoShellHas) {
  const test::ScratchFolder scratch;
  const auto file = scratch / "box.obj";
  test::write_file(file, test::as_obj(box_mesh(1, 2, 0.5)));
  const part::Part part = std::move(part::read_part({file.string()}, 1.0)).value().part;
  pointshell::ShellOptions options;
  options.voxel_size_m = 0.1;
  pointshell::BakedShell shell =
      std::move(pointshell::bake_shell(part, options, [](const std::string&, double) {})).value();
  for (const double radius : {1e-6, 1e-300, 0.0}) {
    shell.header.covering_radius_m = radius;
    const auto path = scratch / "part.pshell";
    ASSERT_TRUE(write_pshell(path, shell.content()).ok());
    EXPECT_EQ(verify_status(path, file), 4) << radius;
  }
  // Centers so far away that the part's corners look alike from there.
  shell.header.covering_radius_m = 0.05;
  for (const double x : {1e13, 1e20, 1e300}) {
    shell.header.center_m = {x, 0, 0};
    const auto path = scratch / "part.pshell";
    ASSERT_TRUE(write_pshell(path, shell.content()).ok());
    EXPECT_EQ(verify_status(path, file), 4) << x;
  }
}

}  // namespace
}  // namespace forcelayer
