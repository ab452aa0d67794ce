// Small damaged text files: the error's code, its place and a part of its reason.
#include <gtest/gtest.h>

#include "tests/support/mesh_files.h"

namespace forcelayer {
namespace {

using namespace test;

void expect_error(const std::string& text, const std::string& extension, ErrorCode code,
                  const std::string& where, const std::string& fragment) {
  const Result<mesh::Assembly> assembly = read_bytes(text, extension);
  ASSERT_FALSE(assembly) << text;
  EXPECT_EQ(assembly.error().code, code) << to_line(assembly.error());
  EXPECT_EQ(assembly.error().where, where) << to_line(assembly.error());
  EXPECT_NE(assembly.error().what.find(fragment), std::string::npos) << to_line(assembly.error());
}

constexpr ErrorCode kUnreadable = ErrorCode::kMeshUnreadable;
constexpr ErrorCode kIncomplete = ErrorCode::kMeshIncomplete;
constexpr ErrorCode kUnsupported = ErrorCode::kMeshUnsupported;
const std::string kVertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

TEST(DamagedObj, NamesTheLineOfABadCoordinate) {
  expect_error("v 0 0 0\nv 1 zero 0\n", ".obj", kUnreadable, "line 2", "'zero' is not a number");
  expect_error("v 0 0\nv 1 0 0\n", ".obj", kUnreadable, "line 1", "a coordinate is missing");
  expect_error("v 0 0 1e999\n", ".obj", kUnreadable, "line 1", "'1e999' is not a number");
  expect_error("v 0 0 0,5\n", ".obj", kUnreadable, "line 1", "'0,5' is not a number");
  expect_error("v 0 0", ".obj", kIncomplete, "line 1", "the file ends");
}

TEST(DamagedObj, NamesTheVertexThatIsNotFinite) {
  expect_error(kVertices + "v nan 0 0\nf 1 2 3\n", ".obj", kUnreadable, "vertex 3", "finite");
  expect_error("v 0 inf 0\n" + kVertices + "f 1 2 3\n", ".obj", kUnreadable, "vertex 0", "finite");
}

TEST(DamagedObj, NamesTheLineOfABadFace) {
  expect_error(kVertices + "f 1 2 4\n", ".obj", kIncomplete, "line 4",
               "uses vertex 4, but there are only 3 vertices");
  expect_error(kVertices + "f 1 2 -4\n", ".obj", kUnreadable, "line 4",
               "the vertex number of a corner of a face is out of range");
  expect_error(kVertices + "f 0 1 2\n", ".obj", kUnreadable, "line 4",
               "the vertex number of a corner of a face is out of range");
  expect_error(kVertices + "\nf 1 2\n", ".obj", kUnreadable, "line 5",
               "2 corners do not make a face");
  expect_error(kVertices + "f\n", ".obj", kUnreadable, "line 4", "0 corners do not make a face");
  expect_error(kVertices + "f a b c\n", ".obj", kUnreadable, "line 4", "no valid vertex number");
  expect_error(kVertices + "f 1.5 2 3\n", ".obj", kUnreadable, "line 4", "no valid vertex number");
  expect_error(kVertices + "f 1/1/1/1 2 3\n", ".obj", kUnreadable, "line 4", "no valid vertex");
  expect_error(kVertices + "f 1 2 99999999999999999999\n", ".obj", kUnreadable, "line 4",
               "no valid vertex number");
  expect_error(kVertices + "f 1 2 4294967297\n", ".obj", kUnreadable, "line 4", "vertex");
}

TEST(DamagedObj, RefusesFreeFormSurfaces) {
  expect_error(kVertices + "f 1 2 3\nsurf 0 1 0 1 1 2 3\n", ".obj", kUnsupported, "line 5",
               "free-form");
  expect_error(kVertices + "curv 0 1 1 2 3\n", ".obj", kUnsupported, "line 4", "free-form");
}

TEST(DamagedObj, WithoutFacesIsEmpty) {
  expect_error("", ".obj", ErrorCode::kMeshEmpty, "", "no triangles");
  expect_error(kVertices, ".obj", ErrorCode::kMeshEmpty, "", "only points or lines");
}

const std::string kOffVertices = "0 0 0\n1 0 0\n0 1 0\n";

TEST(DamagedOff, NamesTheLine) {
  expect_error("PFF\n3 1 0\n", ".off", kUnreadable, "line 1", "does not start with 'OFF'");
  expect_error("OFF BINARY\n3 1 0\n", ".off", kUnsupported, "line 1", "binary");
  expect_error("4OFF\n3 1 0\n", ".off", kUnsupported, "line 1", "three dimensions");
  expect_error("nOFF\n4\n3 1 0\n", ".off", kUnsupported, "line 1", "three dimensions");
  expect_error("OFF\n-3 1 0\n", ".off", kUnreadable, "line 2", "'-3' is not a whole number");
  expect_error("OFF\n", ".off", kIncomplete, "line 2", "ends before the vertex count");
  expect_error("OFF\n3 1 0\n0 0 0 1 1 1\n", ".off", kUnreadable, "line 3", "more than three");
  expect_error("OFF\n3 1 0\n" + kOffVertices + "3 0 1 3\n", ".off", kUnreadable, "line 6",
               "uses vertex 3, but there are only 3 vertices");
  expect_error("OFF\n3 1 0\n" + kOffVertices + "2 0 1\n", ".off", kUnreadable, "line 6",
               "2 corners do not make a face");
  expect_error("OFF\n3 1 0\n" + kOffVertices + "99999999 0 1 2\n", ".off", kUnreadable, "line 6",
               "corners do not make a face");
}

TEST(DamagedOff, CountsWhatIsThere) {
  expect_error("OFF\n3 2 0\n" + kOffVertices + "3 0 1 2\n", ".off", kIncomplete, "line 7",
               "ends before the end of face 1 of 2");
  expect_error("OFF\n4 1 0\n" + kOffVertices + "# the fourth is missing\n", ".off", kIncomplete,
               "line 7", "ends before the end of vertex 3 of 4");
  expect_error("OFF\n3 1 0\n" + kOffVertices + "3 0 1 2\n3 2 1 0\n", ".off", kIncomplete, "line 7",
               "more data");
  expect_error("OFF\n3000000000 1 0\n" + kOffVertices, ".off", kIncomplete, "line 2",
               "but the file is too short for them");
  expect_error("OFF\n3 3000000000 0\n" + kOffVertices, ".off", kIncomplete, "line 2",
               "but the file is too short for them");
}

const std::string kFacet =
    "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
    "endfacet\n";

TEST(DamagedAsciiStl, NamesTheLine) {
  expect_error("solid\n" + kFacet, ".stl", kIncomplete, "line 9", "after 1 facet: 'facet' or");
  expect_error("solid\n" + kFacet.substr(0, 40), ".stl", kIncomplete, "line 4", "the file ends");
  expect_error("solid\n" + kFacet + "endfacet\nendsolid\n", ".stl", kUnreadable, "line 9",
               "'endfacet' is not 'facet' or 'endsolid'");
  expect_error("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\n",
               ".stl", kUnreadable, "line 6", "'endloop' is not 'vertex'");
  expect_error("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 x\n", ".stl", kUnreadable,
               "line 4", "'x' is not a number");
  expect_error("solid a\n" + kFacet + "endsolid a\nfacet\n", ".stl", kUnreadable, "line 10",
               "'facet' is not 'solid'");
}

std::string ply(const std::string& elements, const std::string& data) {
  return "ply\nformat ascii 1.0\n" + elements + "end_header\n" + data;
}

const std::string kPlyVertices =
    "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
const std::string kPlyFaces = "element face 1\nproperty list uchar int vertex_indices\n";

TEST(DamagedPly, NamesTheHeadersLine) {
  expect_error("plx\n", ".ply", kUnreadable, "line 1", "does not start with 'ply'");
  expect_error("ply\nend_header\n", ".ply", kUnreadable, "line 2", "no 'format' line");
  expect_error("ply\nformat ascii 2.0\n", ".ply", kUnreadable, "line 2", "version 1.0");
  expect_error("ply\nformat utf8 1.0\n", ".ply", kUnreadable, "line 2", "unknown encoding 'utf8'");
  expect_error("ply\nformat ascii 1.0\nelement vertex x\n", ".ply", kUnreadable, "line 3",
               "'x' is not a whole number");
  expect_error("ply\nformat ascii 1.0\nproperty float x\n", ".ply", kUnreadable, "line 3",
               "before the first element");
  expect_error(ply("element vertex 3\nproperty quad x\n", ""), ".ply", kUnreadable, "line 4",
               "unknown type 'quad'");
  expect_error(ply("element vertex 3\nproperty list float int x\n", ""), ".ply", kUnreadable,
               "line 4", "the count of a list is not an integer");
  expect_error("ply\nformat ascii 1.0\nhello\n", ".ply", kUnreadable, "line 3", "'hello' is no");
  expect_error("ply\nformat ascii 1.0\nelement vertex 3\n", ".ply", kIncomplete, "line 4",
               "before 'end_header'");
  expect_error(ply("element vertex 3\nproperty float x\nproperty float y\n", "0 0\n0 0\n0 0\n"),
               ".ply", kUnreadable, "line 3", "lacks the property x, y or z");
  expect_error(ply(kPlyVertices + "element face 1\nproperty list uchar int corners\n",
                   "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
               ".ply", kUnreadable, "line 7", "has no property vertex_indices");
  expect_error(ply(kPlyVertices + "element face 1\nproperty list uchar float vertex_indices\n",
                   "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
               ".ply", kUnreadable, "line 7", "not a list of integers");
  expect_error(ply("element nothing 5\n" + kPlyVertices, "0 0 0\n1 0 0\n0 1 0\n"), ".ply",
               kUnreadable, "line 3", "has no properties");
}

TEST(DamagedPly, NamesTheDatasLine) {
  const std::string header = kPlyVertices + kPlyFaces;
  const auto faces = [&](const std::string& face) {
    return ply(header, "0 0 0\n1 0 0\n0 1 0\n" + face);
  };
  expect_error(faces("3 0 1 3\n"), ".ply", kUnreadable, "face 0",
               "uses vertex 3, but there are only 3 vertices");
  expect_error(faces("3 0 1 -1\n"), ".ply", kUnreadable, "line 13", "uses vertex -1");
  expect_error(faces("2 0 1\n"), ".ply", kUnreadable, "line 13", "has 2 corners");
  expect_error(faces("-1 0 1\n"), ".ply", kUnreadable, "line 13", "negative length");
  expect_error(faces("3 0 1 1.5\n"), ".ply", kUnreadable, "line 13", "whole number");
  expect_error(faces("3 0 1 1e300\n"), ".ply", kUnreadable, "line 13", "whole number");
  expect_error(faces("3 0 1\n"), ".ply", kUnreadable, "line 13", "is missing");
  expect_error(faces("3 0 1 2 2\n"), ".ply", kUnreadable, "line 13", "this line has more values");
  expect_error(faces("3 0 1 2\n3 0 1 2\n"), ".ply", kIncomplete, "line 14", "more data");
  expect_error(faces(""), ".ply", kIncomplete, "line 13", "ends before face 0 of 1");
  expect_error(ply(header, "0 0 0\n1 0 0\nnan 1 0\n3 0 1 2\n"), ".ply", kUnreadable, "vertex 2",
               "finite");
}

TEST(DamagedPly, TakesNoMoreMemoryThanItsSizeAllows) {
  for (const char* element : {"vertex", "face", "other"}) {
    const std::string elements = std::string("element ") + element +
                                 " 4000000000\nproperty float x\nproperty float y\n"
                                 "property float z\nproperty list uchar int vertex_indices\n";
    expect_error(ply(elements, "0 0 0\n"), ".ply", kIncomplete, "line 3",
                 "but the file is too short for them");
  }
}

}  // namespace
}  // namespace forcelayer
