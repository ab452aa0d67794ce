// The outcome of reading, file by file: real models, and odd, damaged and empty ones.
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/analytic_shapes.h"
#include "tests/support/engine_glb.h"

namespace forcelayer {
namespace {

using namespace test;

// Triangles that come out, or the error's code and a part of its line.
class MeshModels : public ::testing::TestWithParam<OddMesh> {
 protected:
  void expect_outcome(const std::string& path) {
    const OddMesh& outcome = GetParam();
    const Result<mesh::Assembly> assembly = mesh::read_assembly(path);
    if (outcome.triangles > 0) {
      ASSERT_TRUE(assembly) << to_line(assembly.error());
      EXPECT_EQ(assembly->triangle_count(), outcome.triangles);
      return;
    }
    ASSERT_FALSE(assembly);
    EXPECT_EQ(assembly.error().code, outcome.code) << to_line(assembly.error());
    EXPECT_EQ(assembly.error().file, path);
    EXPECT_NE(to_line(assembly.error()).find(outcome.fragment), std::string::npos)
        << to_line(assembly.error());
  }
};

TEST_P(MeshModels, GivesTheNamedOutcome) {
  const ScratchFolder folder;
  expect_outcome(path_of(GetParam(), folder));
}

std::string start_of_a_stream() {
  std::ifstream stream(model_path("bunny.drc"), std::ios::binary);
  std::string start(40000, '\0');
  stream.read(start.data(), static_cast<std::streamsize>(start.size()));
  return start;
}

constexpr OddMesh kModels[] = {
    {"counter.drc", nullptr, 83750},
    {"sensor.drc", nullptr, 7436},
    {"featuretype.stl", nullptr, 3476},
    {"large_block.stl", nullptr, 12},
    {"plate_holes.stl", nullptr, 1252},
    {"box_draco.glb", nullptr, 12},
    {"car.drc", nullptr, 1744},
    {"bunny.drc", nullptr, 69451},
    {"dragon.drc", nullptr, 100000},
    {"old_version.drc", nullptr, 170},
#ifdef FORCELAYER_STEP
    {"featuretype.step", nullptr, 3512},
#else
    {"featuretype.step", nullptr, 0, ErrorCode::kMeshUnsupported, "built without STEP"},
#endif
    {"points_only.drc", nullptr, 0, ErrorCode::kMeshEmpty, "only points"},
    {"truncated.drc", start_of_a_stream, 0, ErrorCode::kMeshIncomplete, "cut short or damaged"},
    {"engine.glb", engine_glb, kEngineTriangles},
    {"kettle.obj", [] { return as_obj(testing::kettle_mesh(24)); }, 12 * 24 * 24},
};

std::string name_of(const ::testing::TestParamInfo<OddMesh>& model) {
  return test_name_of(model.param.file);
}

INSTANTIATE_TEST_SUITE_P(Real, MeshModels, ::testing::ValuesIn(kModels), name_of);
INSTANTIATE_TEST_SUITE_P(Odd, MeshModels, ::testing::ValuesIn(odd::kReadable), name_of);
INSTANTIATE_TEST_SUITE_P(Empty, MeshModels, ::testing::ValuesIn(odd::kUnreadable), name_of);

TEST(MeshModel, TheScanOfDebianIsWhole) {
  if (!std::filesystem::exists(bunny_obj_path()))
    GTEST_SKIP() << "needs glmark2-data of scripts/packages.txt";
  const auto bunny = mesh::read_assembly(bunny_obj_path());
  ASSERT_TRUE(bunny) << to_line(bunny.error());
  EXPECT_EQ(bunny->triangle_count(), 69666u);
}

}  // namespace
}  // namespace forcelayer
