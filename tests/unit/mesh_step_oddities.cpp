// Odd STEP and IGES files that are read all the same, or refused for the right reason.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/step_files.h"

namespace forcelayer {
namespace {

using namespace test;

#ifdef FORCELAYER_STEP

Result<mesh::Assembly> read_text_as(const std::string& extension, const std::string& text) {
  const ScratchFolder folder;
  return mesh::read_assembly(write_file(folder / ("a" + extension), text));
}

bool has_warning(const mesh::Assembly& assembly, const std::string& part) {
  return std::any_of(
      assembly.warnings.begin(), assembly.warnings.end(),
      [&](const std::string& warning) { return warning.find(part) != std::string::npos; });
}

// The box of make_box_file as a product of this name and identifier.
std::string box_called(const std::string& id, const std::string& name) {
  return replaced(step_box(), R"(PRODUCT\('[^']*',\s*'[^']*')",
                  "PRODUCT('" + id + "','" + name + "'");
}

TEST(StepOddities, NamesThatAreNotUtf8AreReadAsLatin1) {
  constexpr const char* kHousing = "Geh\xc3\xa4use";
  for (const auto& [id, name, read, is_odd] :
       {std::tuple{"box", "Geh\xe4use", kHousing, true},
        // UTF-8, beside a name that is not, and alone
        {"b\xf6x", kHousing, kHousing, true},
        {"box", kHousing, kHousing, false},
        // a Chinese name as Windows writes it, and one that is written by its code
        {"box",
         "\xba\xa3\xc3\xe0"
         "2",
         "\xc2\xba\xc2\xa3\xc3\x83\xc3\xa0"
         "2",
         true},
        {"b\xf6x", "\\X2\\6D77\\X0\\2",
         "\xe6\xb5\xb7"
         "2",
         true}}) {
    const auto assembly = read_text_as(".step", box_called(id, name));
    ASSERT_TRUE(assembly) << to_line(assembly.error());
    EXPECT_EQ(assembly->instances[0].name, read);
    EXPECT_EQ(has_warning(*assembly, "are not valid UTF-8: they are read as Latin-1"), is_odd)
        << read;
  }
  for (const std::string name : {"7HGeh\xe4use", "8HGeh\xc3\xa4use"}) {
    IgesText file(iges_box(false));
    const int post = file.add(308, "0," + name + ",1,1;", 0, 0, "00000200");
    file.add(408, std::to_string(post) + ",0.,0.,0.;");
    const auto iges = read_text_as(".igs", file.text());
    ASSERT_TRUE(iges) << to_line(iges.error());
    EXPECT_EQ(iges->instances[0].name.substr(0, 8), kHousing);
    EXPECT_EQ(has_warning(*iges, "names such as 'Geh\xc3\xa4use' are not valid"), name[0] == '7');
  }
}

// The box in assemblies, of which each holds the one before it twice.
std::string doubled(int levels) {
  const auto number = [](int n) { return std::to_string(n); };
  std::string text, product = "#5", shape = "#10";
  for (int level = 0; level < levels; ++level) {
    const int first = 10000 + 100 * level;
    const auto id = [&](int n) { return "#" + number(first + n); };
    const std::string name = "'A" + number(level) + "'";
    text += id(0) + "=PRODUCT(" + name + "," + name + ",'',(#8));";
    text += id(1) + "=PRODUCT_DEFINITION_FORMATION('',''," + id(0) + ");";
    text += id(2) + "=PRODUCT_DEFINITION('',''," + id(1) + ",#9);";
    text += id(3) + "=PRODUCT_DEFINITION_SHAPE('',''," + id(2) + ");";
    text += id(4) + "=SHAPE_REPRESENTATION(" + name + ",(#11),#345);";
    text += id(5) + "=SHAPE_DEFINITION_REPRESENTATION(" + id(3) + "," + id(4) + ");";
    for (const int at : {10, 20}) {
      text += id(at) + "=NEXT_ASSEMBLY_USAGE_OCCURRENCE('" + number(at) + "','',''," + id(2) + "," +
              product + ",$);";
      text += id(at + 1) + "=PRODUCT_DEFINITION_SHAPE('',''," + id(at) + ");";
      text += id(at + 2) + "=ITEM_DEFINED_TRANSFORMATION('','',#11,#11);";
      text += id(at + 3) + "=(REPRESENTATION_RELATIONSHIP('',''," + shape + "," + id(4) +
              ")REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(" + id(at + 2) +
              ")SHAPE_REPRESENTATION_RELATIONSHIP());";
      text += id(at + 4) + "=CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(" + id(at + 3) + "," +
              id(at + 1) + ");";
    }
    product = id(2), shape = id(4);
  }
  return with_entities(step_box(), text);
}

// 2^40 boxes in a file of 50 kB would take a reader more than any memory.
TEST(StepOddities, AssembliesThatHoldEachOtherTooOftenAreRefused) {
  const auto taken = read_text_as(".step", doubled(5));
  ASSERT_TRUE(taken) << to_line(taken.error());
  EXPECT_EQ(taken->instances.size(), 32u);
  const auto refused = read_text_as(".step", doubled(40));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kMeshUnsupported);
  EXPECT_NE(refused.error().what.find("nested assemblies are repeated too often"),
            std::string::npos)
      << to_line(refused.error());
}

TEST(StepOddities, ASolidOfNoProductIsNamedAsOne) {
  const std::string alone =
      replaced(step_box(), R"(#3 = SHAPE_DEFINITION_REPRESENTATION\([^;]*;)", "");
  const auto refused = read_text_as(".step", alone);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kMeshIncomplete);
  const std::string line = to_line(refused.error());
  EXPECT_NE(line.find("could not read 1 solid: #15 MANIFOLD_SOLID_BREP; export each solid as "
                      "a boundary representation within a product"),
            std::string::npos)
      << line;
}

TEST(StepOddities, HiddenBodiesAreReadAndCounted) {
  const std::string styled =
      "#9001=PRESENTATION_STYLE_ASSIGNMENT((NULL_STYLE(.NULL.)));\n"
      "#9002=STYLED_ITEM('',(#9001),#15);\n"
      "#9003=PRESENTATION_LAYER_ASSIGNMENT('','',(#15));\n"
      "#9004=STYLED_ITEM('',(#9001),#11);\n";  // a frame is no body
  for (const auto& [hidden, count] : {std::pair{"#9005=INVISIBILITY((#9002));\n", 1},
                                      {"#9005=INVISIBILITY((#9003));\n", 1},
                                      {"#9005=INVISIBILITY((#9002,#9003));\n", 1},
                                      {"#9005=INVISIBILITY((#9004));\n", 0},
                                      {"", 0}}) {
    const auto assembly = read_text_as(".step", with_entities(step_box(), styled + hidden));
    ASSERT_TRUE(assembly) << to_line(assembly.error());
    EXPECT_EQ(assembly->triangle_count(), 12u);
    EXPECT_EQ(has_warning(*assembly, "the file hides 1 body, but hidden shapes are read, too"),
              count == 1)
        << hidden;
  }
  for (const bool is_solid : {false, true}) {  // the group of its faces, or the solid
    IgesText file(iges_box(is_solid));
    const auto shown = read_text_as(".igs", file.text());
    ASSERT_TRUE(shown);
    EXPECT_FALSE(has_warning(*shown, "hides"));
    file.set_status(1, "01000000");
    const auto assembly = read_text_as(".igs", file.text());
    ASSERT_TRUE(assembly) << to_line(assembly.error());
    EXPECT_EQ(assembly->triangle_count(), 12u);
    EXPECT_TRUE(has_warning(
        *assembly, "the file hides the faces of 1 entity, but hidden shapes are read, too"));
  }
}

#endif

}  // namespace
}  // namespace forcelayer
