// The readers of STL, OBJ, PLY and OFF against OpenMesh's, on files that OpenMesh reads right.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/analytic_shapes.h"
#include "tests/support/models.h"
#include "tests/support/om_files.h"

namespace forcelayer {
namespace {

using namespace test;

// Takes faces as they come, before OpenMesh drops what it cannot connect.
class FaceTaker : public OpenMesh::IO::ImporterT<DoubleMesh> {
 public:
  explicit FaceTaker(DoubleMesh& mesh) : ImporterT(mesh), om_mesh(mesh) {}

  OpenMesh::FaceHandle add_face(const VHandles& corners) override {
    ++polygons;
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
      std::array<mesh::Vec3d, 3>& triangle = triangles.emplace_back();
      const std::size_t fan[3] = {0, i, i + 1};
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const OpenMesh::Vec3d& point = om_mesh.point(corners[fan[corner]]);
        triangle[corner] = {point[0], point[1], point[2]};
      }
    }
    return OpenMesh::FaceHandle(static_cast<int>(polygons - 1));
  }

  // Nothing is stored under the faces' handles.
  void add_face_texcoords(OpenMesh::FaceHandle, OpenMesh::VertexHandle,
                          const std::vector<OpenMesh::Vec2f>&) override {}
  void add_face_texcoords(OpenMesh::FaceHandle, OpenMesh::VertexHandle,
                          const std::vector<OpenMesh::Vec3f>&) override {}

  DoubleMesh& om_mesh;
  std::size_t polygons = 0;
  Corners triangles;
};

Corners read_by_openmesh(const std::string& path) {
  DoubleMesh mesh;
  FaceTaker taker(mesh);
  OpenMesh::IO::Options options;
  if (!OpenMesh::IO::IOManager().read(path, taker, options)) return {};
  return taker.triangles;
}

void expect_as_openmesh(const std::string& path) {
  const auto assembly = mesh::read_assembly(path);
  ASSERT_TRUE(assembly) << to_line(assembly.error());
  const Corners ours = corners_of(*assembly), theirs = read_by_openmesh(path);
  ASSERT_EQ(ours.size(), theirs.size()) << path;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        // OpenMesh parses some formats in single precision.
        const double a = ours[i][corner][axis], b = theirs[i][corner][axis];
        ASSERT_NEAR(a, b, std::max(std::abs(a), 1e-30) * 1.2e-7) << path << " triangle " << i;
      }
    }
  }
}

TEST(MeshReaders, AgreeWithOpenMeshOnRandomSoups) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    std::mt19937_64 random(seed);
    mesh::Mesh mesh = random_soup(random);
    // OpenMesh leaves out OBJ faces that name a vertex twice.
    std::erase_if(mesh.triangles, [](const mesh::Triangle& t) {
      return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
    });
    if (mesh.triangles.empty()) continue;
    const ScratchFolder folder;
    SCOPED_TRACE("seed " + std::to_string(seed));
    expect_as_openmesh(write_file(folder / "a.obj", as_obj(mesh)));
    expect_as_openmesh(write_file(folder / "a.off", as_off(mesh)));
    expect_as_openmesh(write_file(folder / "ascii.ply", as_ply_ascii(mesh)));
    expect_as_openmesh(write_file(folder / "little.ply", as_ply_binary(mesh, std::endian::little)));
    expect_as_openmesh(write_file(folder / "big.ply", as_ply_binary(mesh, std::endian::big)));
  }
}

TEST(MeshReaders, AgreeWithOpenMeshOnRealFiles) {
  if (!std::filesystem::exists(bunny_obj_path()))
    GTEST_SKIP() << "needs glmark2-data of scripts/packages.txt";
  expect_as_openmesh(bunny_obj_path());
  for (const char* file : {"featuretype.stl", "plate_holes.stl", "large_block.stl"}) {
    expect_as_openmesh(model_path(file));
  }
}

TEST(MeshReaders, AgreeWithOpenMeshOnRealShapes) {
  const ScratchFolder folder;
  expect_as_openmesh(write_file(folder / "kettle.obj", as_obj(testing::kettle_mesh(40))));
  for (const char* file : {"dragon.drc", "sensor.drc"}) {
    const auto model = mesh::read_assembly(model_path(file));
    ASSERT_TRUE(model) << to_line(model.error());
    expect_as_openmesh(write_file(folder / "a.obj", as_obj(model->meshes[0])));
    expect_as_openmesh(write_file(folder / "a.stl", as_stl_ascii(model->meshes[0])));
  }
}

}  // namespace
}  // namespace forcelayer
