// Real and odd models against the dense reference, voxel for voxel, and whole bakes
// of them under symmetries. FORCELAYER_LONG_TESTS=1 does it finer and under all symmetries.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "formats/mesh/scene.h"
#include "tests/support/analytic_shapes.h"
#include "tests/support/baked_scene.h"
#include "tests/support/engine_glb.h"
#include "tests/support/lattice_symmetry.h"
#include "tests/support/long_tests.h"
#include "tests/support/soups.h"

namespace forcelayer {
namespace {

using reference::BakedScene;
using reference::DenseGrid;
using reference::LatticeMesh;
using reference::objects_of;
using reference::options_with;
using reference::Random;
using reference::Symmetry;
using reference::whole;
using test::long_tests;
using test::OddMesh;

constexpr OddMesh kModels[] = {
    {"bunny.drc", nullptr, 69451},
    {"car.drc", nullptr, 1744},
    {"counter.drc", nullptr, 83750},
    {"dragon.drc", nullptr, 100000},
    {"featuretype.stl", nullptr, 3476},
    {"large_block.stl", nullptr, 12},
    {"old_version.drc", nullptr, 170},
    {"plate_holes.stl", nullptr, 1252},
    {"sensor.drc", nullptr, 7436},
    {"box_draco.glb", nullptr, 12},
#ifdef FORCELAYER_STEP
    {"featuretype.step", nullptr, 3512},
#endif
    {"engine.glb", test::engine_glb, test::kEngineTriangles},
    {"kettle.obj", [] { return test::as_obj(testing::kettle_mesh(24)); }, 12 * 24 * 24},
};

double longest_side(const mesh::Scene& scene) {
  mesh::Vec3d low =
      mesh::apply(scene.objects[0].world_from_mesh, scene.mesh_of(scene.objects[0]).vertices[0]);
  mesh::Vec3d high = low;
  for (const mesh::MeshObject& part : scene.objects) {
    for (const mesh::Vec3d& vertex : scene.mesh_of(part).vertices) {
      const mesh::Vec3d world = mesh::apply(part.world_from_mesh, vertex);
      for (std::size_t d = 0; d < 3; ++d) {
        low[d] = std::min(low[d], world[d]);
        high[d] = std::max(high[d], world[d]);
      }
    }
  }
  return std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
}

std::vector<LatticeMesh> lattice_of(const mesh::Scene& scene, double voxel_size_m) {
  std::vector<LatticeMesh> meshes;
  for (const mesh::MeshObject& part : scene.objects) {
    meshes.push_back(reference::snapped(scene.mesh_of(part), part.world_from_mesh, voxel_size_m));
  }
  return meshes;
}

class BakeModels : public ::testing::TestWithParam<OddMesh> {
 protected:
  void SetUp() override {
    const test::ScratchFolder folder;
    const std::string path = path_of(GetParam(), folder);
    auto read = mesh::read_scene(std::span(&path, 1), std::nullopt);
    if (!read && read.error().code == ErrorCode::kUsage) {  // a format that defines no unit
      read = mesh::read_scene(std::span(&path, 1), 1.0);
    }
    ASSERT_TRUE(read) << to_line(read.error());
    scene_ = std::move(*read);
    size_m_ = longest_side(scene_);
  }

  mesh::Scene scene_;
  double size_m_ = 0;
};

// Voxels across. Large single meshes are compared finer in every run: the reference takes a second.
std::vector<int> resolutions(const std::string& model) {
  if (long_tests()) return {37, 96, 128, 160};
  const bool finer = model == "bunny.drc" || model == "dragon.drc" || model == "counter.drc" ||
                     model == "large_block.stl";
  return finer ? std::vector{64, 128} : std::vector{64};
}

TEST_P(BakeModels, EqualTheReference) {
  for (const int across : resolutions(GetParam().file)) {
    const double voxel_size_m = size_m_ / across;
    const auto united = reference::united_scene(lattice_of(scene_, voxel_size_m), {}, 5);
    for (const std::uint32_t layers : {0u, 1u, 2u, 3u}) {
      SCOPED_TRACE(::testing::Message() << across << " voxels, " << layers << " layers");
      const BakedScene baked(objects_of(scene_), options_with(layers, voxel_size_m));
      reference::expect_equal(baked.map(),
                              reference::offset_scene(united, static_cast<int>(layers)));
      if (HasFatalFailure()) return;
    }
  }
}

// The model's triangles on the snapping lattice, in voxels of 1 m: moving them rounds nothing.
class LatticeScene {
 public:
  explicit LatticeScene(const std::vector<LatticeMesh>& meshes) {
    for (const LatticeMesh& lattice : meshes) {
      mesh::Mesh& mesh = meshes_.emplace_back();
      for (const lattice::LatticeTriangle& t : lattice) {
        const auto corner = [&](std::size_t k) {
          mesh::Vec3d at;
          for (std::size_t d = 0; d < 3; ++d)
            at[d] = static_cast<double>(t[k][d]) / lattice::kSnapUnits;
          return at;
        };
        reference::add_triangle(mesh, corner(0), corner(1), corner(2));
      }
    }
  }

  BakedScene baked(const mesh::Affine& placing = {}) const {
    std::vector<voxelize::SceneObject> objects;
    for (const mesh::Mesh& mesh : meshes_) objects.push_back({"part", &mesh, placing, {}, 0});
    return BakedScene(objects, options_with(2, 1));
  }

  std::vector<mesh::Mesh>& meshes() { return meshes_; }

 private:
  std::vector<mesh::Mesh> meshes_;
};

// All 48, or in the normal run one for each model, not the same for all.
std::vector<Symmetry> symmetries_for(const std::string& model) {
  std::vector<Symmetry> all = reference::symmetries();
  if (long_tests()) return all;
  const int number = std::accumulate(model.begin(), model.end(), 0);
  return {all[static_cast<std::size_t>(number) % all.size()]};
}

void expect_equal_turned_and_mirrored(const std::vector<LatticeMesh>& lattice,
                                      const std::vector<Symmetry>& chosen) {
  const BakedScene still = LatticeScene(lattice).baked();
  for (const Symmetry& symmetry : chosen) {
    SCOPED_TRACE(::testing::Message()
                 << "axes " << symmetry.from[0] << symmetry.from[1] << symmetry.from[2] << " signs "
                 << symmetry.sign[0] << symmetry.sign[1] << symmetry.sign[2]);
    // The half-open rule turned along: the bake's voxels, turned.
    const DenseGrid expected = reference::moved_reference(lattice, symmetry, 2);
    std::uint64_t wrong = 0, held = 0;
    reference::grid_around(lattice, 4).for_each([&](const lattice::VoxelIndex& v) {
      const auto value = static_cast<std::uint8_t>(still.map().value(v[0], v[1], v[2]));
      wrong += value != expected.at(symmetry.voxel(v));
      held += value != 0;
    });
    ASSERT_EQ(wrong, 0u);
    ASSERT_GT(held, 0u);
    // The rule left as it is: the turned mesh is one like any other.
    const std::vector<LatticeMesh> turned = symmetry.meshes(lattice);
    reference::expect_equal(LatticeScene(turned).baked().map(),
                            reference::offset_scene(reference::united_scene(turned, {}, 4), 2));
    if (::testing::Test::HasFatalFailure()) return;
  }
}

void expect_equal_shifted(const std::vector<LatticeMesh>& lattice) {
  const LatticeScene scene(lattice);
  const BakedScene still = scene.baked();
  Random random(lattice.size());
  for (const std::int64_t far : {700, 1'000'000'000}) {
    SCOPED_TRACE(::testing::Message() << "by up to " << far);
    lattice::VoxelIndex shift;
    for (std::int64_t& x : shift) x = whole(random, -far, far);
    mesh::Affine placing;
    for (std::size_t d = 0; d < 3; ++d) placing.translation[d] = static_cast<double>(shift[d]);
    const BakedScene moved = scene.baked(placing);
    std::uint64_t wrong = 0;
    reference::grid_around(lattice, 4).for_each([&](const lattice::VoxelIndex& v) {
      wrong += moved.map().value(v[0] + shift[0], v[1] + shift[1], v[2] + shift[2]) !=
               still.map().value(v[0], v[1], v[2]);
    });
    ASSERT_EQ(wrong, 0u);
    ASSERT_EQ(moved.map().header().dims_voxels, still.map().header().dims_voxels);
  }
}

// Shuffled parts and triangles, turned corners; then every triangle twice.
void expect_equal_shuffled_and_doubled(const std::vector<LatticeMesh>& lattice) {
  LatticeScene scene(lattice);
  const std::string expected = scene.baked().bytes();
  Random random(7);
  std::shuffle(scene.meshes().begin(), scene.meshes().end(), random);
  for (mesh::Mesh& mesh : scene.meshes()) {
    std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
    for (mesh::Triangle& triangle : mesh.triangles) {
      std::rotate(triangle.begin(), triangle.begin() + whole(random, 0, 2), triangle.end());
      if (whole(random, 0, 1) == 0) std::swap(triangle[0], triangle[1]);
    }
  }
  const BakedScene shuffled = scene.baked();
  ASSERT_EQ(shuffled.bytes(), expected);
  for (mesh::Mesh& mesh : scene.meshes()) {
    const std::vector<mesh::Triangle> triangles = mesh.triangles;
    mesh.triangles.insert(mesh.triangles.end(), triangles.begin(), triangles.end());
  }
  const BakedScene doubled = scene.baked();  // its header counts twice the triangles
  EXPECT_EQ(doubled.map().header().triangles, 2 * shuffled.map().header().triangles);
  std::uint64_t wrong = 0;
  reference::grid_around(lattice, 4).for_each([&](const lattice::VoxelIndex& v) {
    wrong += doubled.map().value(v[0], v[1], v[2]) != shuffled.map().value(v[0], v[1], v[2]);
  });
  EXPECT_EQ(wrong, 0u);
}

TEST_P(BakeModels, StayTheSameUnderSymmetries) {
  const auto lattice = lattice_of(scene_, size_m_ / (long_tests() ? 64 : 32));
  expect_equal_turned_and_mirrored(lattice, symmetries_for(GetParam().file));
  if (HasFatalFailure()) return;
  expect_equal_shifted(lattice);
  if (HasFatalFailure()) return;
  expect_equal_shuffled_and_doubled(lattice);
}

std::string name_of(const ::testing::TestParamInfo<OddMesh>& model) {
  return test::test_name_of(model.param.file);
}

INSTANTIATE_TEST_SUITE_P(Real, BakeModels, ::testing::ValuesIn(kModels), name_of);
INSTANTIATE_TEST_SUITE_P(Odd, BakeModels, ::testing::ValuesIn(test::odd::kReadable), name_of);

}  // namespace
}  // namespace forcelayer
