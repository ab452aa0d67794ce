// The outcome of reading every file of the collection of real and damaged models.
#include <gtest/gtest.h>

#include <filesystem>

#include "formats/mesh/mesh.h"

namespace forcelayer {
namespace {

// Triangles that come out, or the error's code and a part of its line.
struct Outcome {
  const char* file;
  std::uint64_t triangles;  // 0: an error
  ErrorCode code = ErrorCode::kInternal;
  const char* fragment = "";
};

std::string path_of(const char* file) {
  return std::string(FORCELAYER_SOURCE_DIR) + "/../shared/models/" + file;
}

class MeshModels : public testing::TestWithParam<Outcome> {};

TEST_P(MeshModels, GivesTheNamedOutcome) {
  const Outcome& outcome = GetParam();
  const std::string path = path_of(outcome.file);
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "the model collection is not there: " << path;
  const Result<Assembly> assembly = read_assembly(path);
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

constexpr Outcome kOutcomes[] = {
    {"cad/counter.unitsmm.stl", 83750},
    {"cad/ADIS16480.stl", 7436},
    {"cad/featuretype.stl", 3476},
    {"cad/large_block.stl", 12},
    {"cad/plate_holes.stl", 1252},
    {"cad/2CylinderEngine.glb", 121496},
    {"cad/Box_Draco.glb", 12},
    {"cad/car.drc", 1744},
#ifdef FORCELAYER_STEP
    {"cad/as1-oc-214.stp", 6392},
    {"cad/featuretype.step", 3512},
#else
    {"cad/as1-oc-214.stp", 0, ErrorCode::kMeshUnsupported, "built without STEP"},
    {"cad/featuretype.step", 0, ErrorCode::kMeshUnsupported, "built without STEP"},
#endif
    {"scan/bunny.drc", 69451},
    {"scan/stanford-bunny.obj", 69451},
    {"scan/dragon-100k.obj", 100000},
    {"scan/teapot.obj", 6320},
    {"malformed/busted.STL", 3878},
    {"malformed/comments.off", 12},
    {"malformed/empty.obj", 0, ErrorCode::kMeshEmpty, "no triangles"},
    {"malformed/empty.ply", 0, ErrorCode::kMeshEmpty, "no triangles"},
    {"malformed/empty.stl", 0, ErrorCode::kMeshEmpty, "no triangles"},
    {"malformed/empty_nodes.glb", 0, ErrorCode::kMeshEmpty, "no node with a mesh"},
    {"malformed/nested.glb", 36},
    {"malformed/multibody.stl", 32},
    {"malformed/nancolor.obj", 12},
    {"malformed/not_convex.obj", 96},
    {"malformed/obj_points.obj", 0, ErrorCode::kMeshEmpty, "only points or lines"},
    {"malformed/obj_wireframe.obj", 0, ErrorCode::kMeshEmpty, "only points or lines"},
    {"malformed/ply_empty_header.ply", 0, ErrorCode::kMeshEmpty, "no triangles"},
    {"malformed/ply_points_ascii.ply", 0, ErrorCode::kMeshEmpty, "only points or lines"},
    {"malformed/points_emptyface.ply", 0, ErrorCode::kMeshEmpty, "only points or lines"},
    {"malformed/old_version_0.9.1.drc", 170},
    {"malformed/points_only.drc", 0, ErrorCode::kMeshEmpty, "only points"},
    {"malformed/soup.stl", 100},
    {"malformed/stl_empty_ascii.stl", 0, ErrorCode::kMeshEmpty, "no triangles"},
    {"malformed/stl_empty_bin.stl", 0, ErrorCode::kMeshEmpty, "no triangles"},
    {"malformed/tristrips_igea.ply", 268686},
    {"malformed/truncated.drc", 0, ErrorCode::kMeshIncomplete, "cut short or damaged"},
    {"malformed/truncated_binary.stl", 0, ErrorCode::kMeshIncomplete, "announces 83750 triangles"},
    {"malformed/wallhole.obj", 66},
    {"malformed/whitespace.off", 12},
};

std::string test_name(const testing::TestParamInfo<Outcome>& info) {
  std::string name = info.param.file;
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  }
  return name;
}

INSTANTIATE_TEST_SUITE_P(Collection, MeshModels, testing::ValuesIn(kOutcomes), test_name);

}  // namespace
}  // namespace forcelayer
