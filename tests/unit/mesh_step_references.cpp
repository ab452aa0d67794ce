// STEP assemblies whose parts are in files of their own.
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/step_files.h"

namespace forcelayer {
namespace {

using namespace test;

#ifdef FORCELAYER_STEP

namespace fs = std::filesystem;

// The assembly of make_step_assembly: clamp.step, and nut.stp, rod.stp, bolt.stp, bracket.stp,
// plate.stp beside it. whole.step holds the same in one file.
class StepReferences : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directory(home_);
    run_in(home_, "make_step_assembly clamp.step MM external");
    run_in(home_, "make_step_assembly whole.step MM");
  }

  std::string main() const { return (home_ / "clamp.step").string(); }

  // clamp.step calls `name` `by`.
  void rename(const std::string& name, const std::string& by) const {
    std::string text = read_text(main());
    for (std::size_t at = 0; (at = text.find("'" + name + "'", at)) != std::string::npos;) {
      text.replace(at, name.size() + 2, "'" + by + "'");
      at += by.size();
    }
    write_file(main(), text);
  }

  void expect_whole(const std::string& path, const mesh::ReadOptions& options = {}) const {
    const auto parts = mesh::read_assembly(path, options);
    ASSERT_TRUE(parts) << to_line(parts.error());
    const auto whole = mesh::read_assembly((home_ / "whole.step").string());
    ASSERT_TRUE(whole) << to_line(whole.error());
    ASSERT_EQ(parts->instances.size(), whole->instances.size());
    EXPECT_EQ(parts->meshes.size(), whole->meshes.size());
    for (std::size_t i = 0; i < whole->instances.size(); ++i) {
      EXPECT_EQ(parts->instances[i].name, whole->instances[i].name);
    }
    EXPECT_EQ(corners_of(*parts), corners_of(*whole));
  }

  void expect_error(ErrorCode code, const std::string& file, const std::string& where,
                    const std::string& what) const {
    const auto assembly = mesh::read_assembly(main());
    ASSERT_FALSE(assembly);
    EXPECT_EQ(assembly.error().code, code) << to_line(assembly.error());
    EXPECT_EQ(assembly.error().file, (home_ / file).string());
    EXPECT_EQ(assembly.error().where, where);
    EXPECT_NE(assembly.error().what.find(what), std::string::npos) << to_line(assembly.error());
  }

  ScratchFolder folder_;
  fs::path home_ = folder_ / "home";
};

TEST_F(StepReferences, GiveWhatOneFileGives) {
  expect_whole(main());
  const auto warnings = mesh::read_assembly(main())->warnings;
  EXPECT_TRUE(warnings.empty()) << warnings.front();
  const auto nut = mesh::read_assembly(main() + "#clamp/rod-assembly_1/nut_2");
  ASSERT_TRUE(nut) << to_line(nut.error());
  EXPECT_EQ(nut->instances.size(), 1u);
}

TEST_F(StepReferences, AMissingFileIsNamedWithItsNode) {
  fs::remove(home_ / "rod.stp");
  expect_error(ErrorCode::kFileNotFound, "clamp.step", "clamp/rod-assembly_1/rod_1",
               "'rod.stp', which is missing");
}

TEST_F(StepReferences, ADamagedFileIsNamedWithItsNode) {
  const std::string rod = read_text(home_ / "rod.stp");
  for (const std::string& damage : {std::string(), rod.substr(0, rod.size() / 2)}) {
    write_file(home_ / "rod.stp", damage);
    expect_error(ErrorCode::kMeshUnreadable, "rod.stp", "clamp/rod-assembly_1/rod_1",
                 "cannot parse");
  }
  write_file(home_ / "rod.stp", replaced(rod, " = ADVANCED_FACE", " = ADVANCED_FACX"));
  expect_error(ErrorCode::kMeshIncomplete, "rod.stp", "clamp/rod-assembly_1/rod_1",
               "damaged entity");
}

TEST_F(StepReferences, OfNodesThatAreLeftOutNeedNoFile) {
  mesh::ReadOptions options;
  options.without = {"rod_1"};
  const auto whole = mesh::read_assembly((home_ / "whole.step").string(), options);
  ASSERT_TRUE(whole) << to_line(whole.error());
  const std::string rod = read_text(home_ / "rod.stp");
  for (const bool is_missing : {true, false}) {
    fs::remove(home_ / "rod.stp");
    if (!is_missing) write_file(home_ / "rod.stp", rod.substr(0, rod.size() / 2));
    for (const char* name : {"rod_1", "rod-assembly_1"}) {
      options.without = {name};
      const auto parts = mesh::read_assembly(main(), options);
      ASSERT_TRUE(parts) << to_line(parts.error());
      EXPECT_EQ(parts->left_out, options.without);
      if (options.without.front() == "rod_1") {
        EXPECT_EQ(corners_of(*parts), corners_of(*whole));
      }
    }
    // A name that may be one of the file that is not there.
    for (const char* name : {"nut_2", "inner"}) {
      options.without = {name};
      const auto parts = mesh::read_assembly(main(), options);
      ASSERT_FALSE(parts);
      EXPECT_EQ(parts.error().where, "clamp/rod-assembly_1/rod_1") << to_line(parts.error());
    }
  }
}

TEST_F(StepReferences, AreFoundInFoldersAndByNameAlone) {
  fs::create_directory(home_ / "parts");
  fs::rename(home_ / "nut.stp", home_ / "parts" / "nut.stp");
  rename("nut.stp", "parts/nut.stp");
  expect_whole(main());
  EXPECT_TRUE(mesh::read_assembly(main())->warnings.empty());
  // As another system writes it; what is read from another place is a warning.
  rename("rod.stp", "C:\\\\cad\\\\rod.stp");
  rename("bolt.stp", "/nowhere/bolt.stp");
  expect_whole(main());
  const auto warnings = mesh::read_assembly(main())->warnings;
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_NE(warnings[0].find("but " + (home_ / "rod.stp").string() + " was read"),
            std::string::npos)
      << warnings[0];
}

TEST_F(StepReferences, OutsideTheFolderNeedLeave) {
  fs::rename(home_ / "nut.stp", folder_ / "nut.stp");
  rename("nut.stp", "../nut.stp");
  expect_error(ErrorCode::kMeshUnsupported, "clamp.step", "clamp/rod-assembly_1/nut_1",
               "lies outside the folder");
  expect_whole(main(), {.allow_outside = true});
  rename("../nut.stp", (folder_ / "nut.stp").string());
  expect_error(ErrorCode::kMeshUnsupported, "clamp.step", "clamp/rod-assembly_1/nut_1",
               "lies outside the folder");
  rename((folder_ / "nut.stp").string(), "nut.stp");
  fs::create_symlink(folder_ / "nut.stp", home_ / "nut.stp");
  expect_error(ErrorCode::kMeshUnsupported, "clamp.step", "clamp/rod-assembly_1/nut_1",
               "lies outside the folder");
}

// rod.stp becomes an assembly in a folder of its own, whose parts are the files of that folder.
TEST_F(StepReferences, Nest) {
  const fs::path inner = home_ / "inner";
  fs::create_directory(inner);
  run_in(inner, "make_step_assembly frame.stp MM external");
  rename("rod.stp", "inner/frame.stp");
  const auto assembly = mesh::read_assembly(main());
  ASSERT_TRUE(assembly) << to_line(assembly.error());
  EXPECT_EQ(assembly->instances.size(), 17u + 18u);
  EXPECT_EQ(assembly->instances[2].name, "clamp/rod-assembly_1/rod_1/rod-assembly_1/nut_1");
  // Two files of one name in two folders are two files.
  EXPECT_EQ(assembly->meshes.size(), 4u + 5u);
  const mesh::Vec3d rod = {90, 75, 20}, nut = {90, 75, 30};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(assembly->instances[2].assembly_from_mesh.translation[axis], rod[axis] + nut[axis],
                1e-9);
  }
  fs::remove(inner / "bolt.stp");
  fs::remove(home_ / "bolt.stp");
  expect_error(ErrorCode::kFileNotFound, "inner/frame.stp",
               "clamp/rod-assembly_1/rod_1/bracket-assembly_1/nut-bolt-assembly_1/bolt_1",
               "'bolt.stp', which is missing");
}

TEST_F(StepReferences, ToThemselvesAreRefused) {
  fs::copy_file(home_ / "clamp.step", home_ / "other.step");
  rename("rod.stp", "other.step");
  std::string other = read_text(home_ / "other.step");
  for (std::size_t at = 0; (at = other.find("'nut.stp'", at)) != std::string::npos;) {
    other.replace(at, 9, "'clamp.step'");
  }
  write_file(home_ / "other.step", other);
  expect_error(ErrorCode::kMeshUnreadable, "other.step",
               "clamp/rod-assembly_1/rod_1/rod-assembly_1/nut_1",
               "which contains this node itself");
}

TEST_F(StepReferences, ToOtherFormatsAreRefused) {
  rename("rod.stp", "rod.CATPart");
  write_file(home_ / "rod.CATPart", "not STEP");
  expect_error(ErrorCode::kMeshUnsupported, "clamp.step", "clamp/rod-assembly_1/rod_1",
               "'rod.CATPart', which is neither STEP nor IGES");
}

TEST_F(StepReferences, ToIgesAreRead) {
  run_in(home_, "make_box_file rod.igs solid");
  rename("rod.stp", "rod.igs");
  const auto assembly = mesh::read_assembly(main());
  ASSERT_TRUE(assembly) << to_line(assembly.error());
  EXPECT_EQ(assembly->instances[2].name, "clamp/rod-assembly_1/rod_1");
  EXPECT_EQ(assembly->meshes[assembly->instances[2].mesh].triangles.size(), 12u);
}

#endif

}  // namespace
}  // namespace forcelayer
