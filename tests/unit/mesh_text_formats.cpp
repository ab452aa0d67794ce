// Legal but rare forms of OBJ, OFF, ASCII STL and ASCII PLY are read.
#include <gtest/gtest.h>

#include "tests/support/mesh_files.h"

namespace forcelayer {
namespace {

using namespace test;

// The corners of the only mesh; empty, with a failure, where reading fails.
Corners corners_in(const std::string& text, const std::string& extension) {
  const Result<mesh::Assembly> assembly = read_bytes(text, extension);
  EXPECT_TRUE(assembly) << to_line(assembly.error());
  return assembly ? corners_of(*assembly) : Corners{};
}

const mesh::Vec3d kO{0, 0, 0}, kX{1, 0, 0}, kY{0, 1, 0}, kXY{1, 1, 0};
const std::string kObjVertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n";

TEST(ObjReader, TakesEveryFormOfACorner) {
  const Corners expected{{kO, kX, kY}};
  for (const char* face :
       {"f 1 2 3\n", "f 1/4 2/5 3/6\n", "f 1//7 2//8 3//9\n", "f 1/1/1 2/2/2 3/3/3\n",
        "f 1/ 2/ 3/\n", "f -4 -3 -2\n", "f  1\t2   3 \n", "f 1 2 3", "fo 1 2 3\n",
        "f 1 2 3 # remark\n", "  f 1 2 3\n", "f 1 \\\n 2 3\n", "f 1\\\r\n 2 3\r\n",
        "f 1/-4/-1 2/-3/-1 3/-2/-1\n"}) {
    EXPECT_EQ(corners_in(kObjVertices + face, ".obj"), expected) << face;
  }
}

TEST(ObjReader, CountsNegativeNumbersFromTheNewestVertex) {
  EXPECT_EQ(corners_in("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 1 1 0\nf -3 -1 -2\n", ".obj"),
            (Corners{{kO, kX, kY}, {kX, kXY, kY}}));
}

TEST(ObjReader, TakesFacesBeforeTheirVertices) {
  EXPECT_EQ(corners_in("f 1 2 3\nf 1 2 4 3\n" + kObjVertices, ".obj"),
            (Corners{{kO, kX, kY}, {kO, kX, kXY}, {kO, kXY, kY}}));
}

TEST(ObjReader, KeepsTheOrderOfTrianglesAndPolygons) {
  EXPECT_EQ(corners_in(kObjVertices + "f 1 2 3\nf 1 2 4 3\nf 2 4 3\n", ".obj"),
            (Corners{{kO, kX, kY}, {kO, kX, kXY}, {kO, kXY, kY}, {kX, kXY, kY}}));
}

TEST(ObjReader, TakesAllLineEnds) {
  const std::string unix_text = kObjVertices + "# a comment\n\nf 1 2 3\n";
  for (const std::string line_end : {"\r\n", "\r", "\n\n", "\r\n\n"}) {
    std::string text;
    for (const char c : unix_text) text += c == '\n' ? line_end : std::string(1, c);
    EXPECT_EQ(corners_in(text, ".obj"), (Corners{{kO, kX, kY}}));
  }
}

TEST(ObjReader, IgnoresColorsWeightsGroupsAndMaterials) {
  EXPECT_EQ(corners_in("mtllib a.mtl\no thing\ng part\nusemtl red\ns off\nv 0 0 0 1\nv 1 0 0 0.5 0 "
                       "nan\nv 0 1 0\nvn 0 0 1\nvt 0 0\nvp 1\nf 1 2 3\n",
                       ".obj"),
            (Corners{{kO, kX, kY}}));
}

TEST(ObjReader, ReadsVerticesOverJoinedLines) {
  EXPECT_EQ(corners_in("v 0 0 \\\n0\nv 1 0 0\nv 0 1 0\n# a comment \\\nf 9 9 9\nf 1 2 3\n", ".obj"),
            (Corners{{kO, kX, kY}}));
}

TEST(ObjReader, WarnsOfLinesAndPoints) {
  const auto assembly = read_bytes(kObjVertices + "f 1 2 3\nl 1 2\np 4\n", ".obj");
  ASSERT_TRUE(assembly);
  ASSERT_EQ(assembly->warnings.size(), 1u);
  EXPECT_NE(assembly->warnings[0].find("2 line or point elements are left out"), std::string::npos);
}

TEST(ObjReader, NamesStatementsThatOBJDoesNotHave) {
  const std::string sound = "# box\nmtllib a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1 2 3\n";
  EXPECT_TRUE(read_bytes(sound + "#end\nusemtl red\n\n", ".obj")->warnings.empty());
  const auto odd = read_bytes(sound + "F 1 2 3\n 3 2 1\n", ".obj");
  ASSERT_TRUE(odd) << to_line(odd.error());
  EXPECT_EQ(odd->warnings,
            (std::vector<std::string>{"2 statements are ignored, because OBJ does not define this "
                                      "keyword: 'F' in line 8, ..."}));
}

TEST(OffReader, TakesItsHeadersAndComments) {
  const std::string body = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  for (const std::string header :
       {"OFF\n3 1 3\n", "OFF 3 1 0\n", "OFF3 1 0\n", "# c\n\n  OFF # c\n# c\n3 1 0 # c\n#c\n",
        "3 1 0\n", "OFF\n3 1\n", "OFF\n3\n1\n0\n", "OFF\r\n3 1 0\r\n"}) {
    EXPECT_EQ(corners_in(header + body, ".off"), (Corners{{kO, kX, kY}})) << header;
  }
}

TEST(OffReader, TakesColorsAndNormalsThatItsKeywordNames) {
  const std::string face = "3 0 1 2 0.5 0.5 0.5 1 # color\n";
  for (const std::string keyword : {"COFF", "CNOFF", "STCNOFF", "NOFF", "STOFF"}) {
    EXPECT_EQ(corners_in(keyword + "\n3 1 0\n0 0 0 9 9\n1 0 0 9 9 9 9\n0 1 0\n" + face, ".off"),
              (Corners{{kO, kX, kY}}))
        << keyword;
  }
}

TEST(OffReader, TakesPolygonsOverSeveralLines) {
  EXPECT_EQ(corners_in("OFF\n4 1 0\n0 0\n0\n1 0 0\n1 1 0\n0 1 0\n4 0\n1 2\n3\n", ".off"),
            (Corners{{kO, kX, kXY}, {kO, kXY, kY}}));
}

TEST(StlReader, TakesTextInAnyCaseWithSeveralSolids) {
  const std::string facet =
      "FACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 0 0 0\nVertex 1 0 0\nvertex 0 1 0\nENDLOOP\n"
      "ENDFACET\n";
  EXPECT_EQ(corners_in("SOLID a\n" + facet + "ENDSOLID a\n\nsolid\n" + facet + "endsolid", ".stl"),
            (Corners{{kO, kX, kY}, {kO, kX, kY}}));
  std::string dos;
  for (const char c : "solid\n" + facet + "endsolid\n")
    dos += c == '\n' ? "\r\n" : std::string(1, c);
  EXPECT_EQ(corners_in(dos, ".STL"), (Corners{{kO, kX, kY}}));
}

TEST(PlyReader, TakesOtherElementsPropertiesAndNames) {
  EXPECT_EQ(
      corners_in("ply\nformat ascii 1.0\nobj_info x\nelement camera 1\nproperty float f\n"
                 "property list int float g\nelement face 1\nproperty uchar flags\n"
                 "property list uint8 int16 vertex_index\nproperty list uchar float texcoord\n"
                 "element vertex 3\nproperty int z\nproperty double y\nproperty float32 x\n"
                 "element empty 0\nend_header\n"
                 "1 2 8 9\n7 3 0 1 2 2 0.5 0.5\n0 0 0\n0 0 1\n0 1 0\n",
                 ".ply"),
      (Corners{{kO, kX, kY}}));
}

TEST(PlyReader, TurnsEverySecondTriangleOfAStrip) {
  const Corners expected{{kO, kX, kY}, {kY, kX, kXY}, {kY, kX, kO}};
  EXPECT_EQ(corners_in("ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\n"
                       "property float y\nproperty float z\nelement tristrips 1\n"
                       "property list int int vertex_indices\nend_header\n"
                       "0 0 0\n1 0 0\n0 1 0\n1 1 0\n9 0 1 2 3 -1 2 1 0 -1\n",
                       ".ply"),
            expected);
}

TEST(PlyReader, TellsBinaryDataFromTheHeadersLineEnd) {
  mesh::Mesh mesh = cube();
  for (const std::string line_end : {"\n", "\r\n", "\r"}) {
    const std::string bytes = as_ply_binary(mesh, std::endian::little);
    const std::size_t end = bytes.find("end_header\n") + 11;
    std::string text;
    for (const char c : bytes.substr(0, end)) text += c == '\n' ? line_end : std::string(1, c);
    // The first coordinate starts with the byte of a line feed.
    std::string data = bytes.substr(end);
    data[0] = '\n';
    const auto assembly = read_bytes(text + data, ".ply");
    ASSERT_TRUE(assembly) << to_line(assembly.error());
    EXPECT_EQ(assembly->meshes[0].vertices[0][0], std::bit_cast<float>(std::uint32_t{'\n'}));
  }
}

TEST(ReadAssembly, NamesAnInstanceAfterItsFile) {
  const ScratchFolder folder;
  const auto assembly =
      mesh::read_assembly(write_file(folder / "left.bracket.obj", as_obj(cube())));
  ASSERT_TRUE(assembly);
  EXPECT_EQ(assembly->instances[0].name, "left.bracket");
  EXPECT_FALSE(assembly->meters_per_unit);
  EXPECT_EQ(assembly->triangle_count(), 12u);
}

TEST(ReadAssembly, GoesByContentWhereTheFormatHasASignature) {
  EXPECT_TRUE(read_bytes(as_ply_ascii(cube()), ".obj"));
  EXPECT_TRUE(read_bytes(as_glb(cube()), ".bin"));
}

TEST(ReadAssembly, SaysWhatItCannotOpen) {
  EXPECT_EQ(mesh::read_assembly("/nonexistent/a.stl").error().code, ErrorCode::kFileNotFound);
  EXPECT_EQ(mesh::read_assembly("/").error().code, ErrorCode::kFileNotFound);
  EXPECT_EQ(read_bytes("x", ".txt").error().code, ErrorCode::kMeshUnsupported);
  EXPECT_EQ(read_bytes("x", "").error().code, ErrorCode::kMeshUnsupported);
  EXPECT_EQ(read_bytes(as_obj(cube()), ".obj", "part").error().code, ErrorCode::kSceneInvalid);
}

TEST(ReadAssembly, TakesAHashInAFilesName) {
  const ScratchFolder folder;
  EXPECT_TRUE(mesh::read_assembly(write_file(folder / "bracket#2.obj", as_obj(cube()))));
}

TEST(Affines, Compose) {
  const mesh::Affine turn{{0, -1, 0, 1, 0, 0, 0, 0, 1}, {10, 0, 0}};
  const mesh::Affine stretch{{2, 0, 0, 0, 3, 0, 0, 0, 4}, {1, 2, 3}};
  const mesh::Vec3d point{5, 7, 11};
  const mesh::Affine both = mesh::compose(turn, stretch);
  const mesh::Vec3d stretched = mesh::apply(stretch, point);
  EXPECT_EQ(mesh::apply(both, point), mesh::apply(turn, stretched));
  EXPECT_EQ(mesh::apply(stretch, point), (mesh::Vec3d{11, 23, 47}));
}

}  // namespace
}  // namespace forcelayer
