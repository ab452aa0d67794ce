// Files that no reader takes are called by their names.
#include <gtest/gtest.h>

#include <tuple>

#include "tests/support/mesh_files.h"

namespace forcelayer {
namespace {

using namespace test;
using namespace std::string_literals;

Error refusal(const std::string& bytes, const std::string& extension) {
  const auto read = read_bytes(bytes, extension);
  EXPECT_FALSE(read) << extension;
  return read ? Error{} : read.error();
}

std::string utf16(const std::string& text, bool little) {
  std::string bytes = little ? "\xff\xfe" : "\xfe\xff";
  for (const char c : text) bytes += little ? std::string{c, '\0'} : std::string{'\0', c};
  return bytes;
}

TEST(ForeignFiles, Utf16TextIsNamedInEveryTextFormat) {
  for (const bool little : {true, false}) {
    for (const char* extension : {".obj", ".off", ".ply", ".stl", ".gltf", ".step", ".igs"}) {
      SCOPED_TRACE(extension);
      for (const std::string text : {"v",
                                     "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n"
                                     "vertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"}) {
        const Error error = refusal(utf16(text, little), extension);
        EXPECT_EQ(error.code, ErrorCode::kMeshUnsupported);
        EXPECT_NE(error.what.find("UTF-16"), std::string::npos) << to_line(error);
        EXPECT_NE(error.mend.find("UTF-8"), std::string::npos);
      }
    }
  }
}

TEST(ForeignFiles, OthersAreNamedByTheirEnding) {
  for (const auto& [extension, name] : {std::pair{".sldprt", "a CAD system"},
                                        {".CATPart", "a CAD system"},
                                        {".jt", "a CAD system"},
                                        {".3MF", "another program"},
                                        {".fbx", "another program"},
                                        {".dae", "another program"}}) {
    // Many are archives or containers, which says less.
    for (const char* start : {"anything", "PK\x03\x04...", "\xd0\xcf\x11\xe0..."}) {
      const Error error = refusal(start, extension);
      EXPECT_EQ(error.code, ErrorCode::kMeshUnsupported);
      EXPECT_NE(error.what.find(name), std::string::npos) << to_line(error);
      EXPECT_EQ(error.mend.find("export the m"), 0u) << to_line(error);
    }
  }
  EXPECT_NE(
      refusal("anything", ".xyz").what.find("is not the extension of a supported mesh format"),
      std::string::npos);
  EXPECT_NE(refusal("anything", "").what.find("has no extension"), std::string::npos);
}

TEST(ForeignFiles, OthersAreNamedByTheirContent) {
  EXPECT_NE(refusal("PK\x03\x04...", ".obj").what.find("ZIP"), std::string::npos);
  EXPECT_NE(refusal("\x1f\x8b\x08...", ".step").what.find("gzip"), std::string::npos);
  EXPECT_NE(refusal("PK\x03\x04...", ".stl").what.find("ZIP"), std::string::npos);
  EXPECT_NE(refusal("\xd0\xcf\x11\xe0...", ".dat").what.find("CAD system"), std::string::npos);
}

// A file of a format that is read here, by the name of another one.
TEST(ForeignFiles, AWrongEndingIsNamedByTheContent) {
  const std::string obj = "# a\n\no a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  const std::string stl =
      "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
      "endloop\nendfacet\nendsolid a\n";
  const std::string off = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  const std::tuple<std::string, const char*, const char*> cases[] = {
      {obj, ".stl", "OBJ"}, {obj, ".off", "OBJ"}, {stl, ".obj", "STL"},
      {stl, ".off", "STL"}, {off, ".stl", "OFF"}, {off, ".obj", "OFF"},
      {obj, "", "OBJ"},     {stl, ".txt", "STL"}, {"ISO-10303-21;\nHEADER;\n", ".obj", "STEP"}};
  for (const auto& [bytes, extension, format] : cases) {
    const Error error = refusal(bytes, extension);
    EXPECT_NE(error.what.find(std::string("contains ") + format), std::string::npos)
        << to_line(error);
    EXPECT_EQ(error.mend.find("rename it to ."), 0u) << to_line(error);
  }
  // The reader's own words for a file that is what it says.
  EXPECT_EQ(refusal("v 0 0 0\n", ".obj").what.find("contains"), std::string::npos);
  EXPECT_EQ(refusal(stl.substr(0, 90), ".stl").what.find("contains"), std::string::npos);
}

// The header of a binary STL may begin with anything.
TEST(ForeignFiles, ABinaryStlThatBeginsLikeAnotherFileIsRead) {
  for (const std::string start : {"PK\x03\x04", "\xff\xfe", "<?xml"}) {
    std::string bytes = start;
    bytes.resize(80, ' ');
    put(bytes, std::uint32_t{1});
    for (const float x : {0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f})
      put(bytes, x);
    put(bytes, std::uint16_t{0});
    const auto read = read_bytes(bytes, ".stl");
    ASSERT_TRUE(read) << to_line(read.error());
    EXPECT_EQ(read->triangle_count(), 1u);
  }
}

}  // namespace
}  // namespace forcelayer
