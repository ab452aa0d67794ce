// Placings of IGES files: read as IGES 5.3 defines them, or refused by entity.
#include <gtest/gtest.h>

#include <functional>

#include "tests/support/step_files.h"

namespace forcelayer {
namespace {

using namespace test;

#ifdef FORCELAYER_STEP

// Entities of the 10 x 20 x 30 mm of iges_box(), the group of its faces, and its solid.
constexpr int kGroup = 1, kSolid = 1;
constexpr const char* kIdentity = "1.,0.,0.,0.,0.,1.,0.,0.,0.,0.,1.,0.;";
constexpr const char* kAlongX = "1.,0.,0.,100.,0.,1.,0.,0.,0.,0.,1.,0.;";
constexpr const char* kAlongY = "1.,0.,0.,0.,0.,1.,0.,50.,0.,0.,1.,0.;";
constexpr const char* kQuarterTurn = "0.,-1.,0.,0.,1.,0.,0.,0.,0.,0.,1.,0.;";
constexpr const char* kMirror = "-1.,0.,0.,100.,0.,1.,0.,0.,0.,0.,1.,0.;";
constexpr const char* kTwice = "2.,0.,0.,0.,0.,2.,0.,0.,0.,0.,2.,0.;";
constexpr const char* kSkew = "1.,1.,0.,0.,0.,1.,0.,0.,0.,0.,1.,0.;";

mesh::Box box_of_text(const std::string& text) {
  const ScratchFolder folder;
  const auto assembly = mesh::read_assembly(write_file(folder / "a.igs", text));
  if (!assembly) throw std::runtime_error(to_line(assembly.error()));
  mesh::Box box = mesh::empty_box();
  for (const mesh::MeshInstance& instance : assembly->instances) extend(box, instance.box);
  return box;
}

void expect_box(const IgesText& file, const mesh::Vec3d& low, const mesh::Vec3d& high) {
  const mesh::Box box = box_of_text(file.text());
  for (std::size_t d = 0; d < 3; ++d) {
    EXPECT_NEAR(box.low[d], low[d], 1e-9) << d;
    EXPECT_NEAR(box.high[d], high[d], 1e-9) << d;
  }
}

// The file is refused, and the error names the entry as a lost placing.
void expect_refused(const IgesText& file, int entry, int type) {
  const ScratchFolder folder;
  const auto assembly = mesh::read_assembly(write_file(folder / "a.igs", file.text()));
  ASSERT_FALSE(assembly) << type;
  EXPECT_EQ(assembly.error().code, ErrorCode::kMeshIncomplete);
  const std::string line = to_line(assembly.error());
  const std::string name = "D" + std::to_string(entry) + " (type " + std::to_string(type) + ")";
  EXPECT_NE(line.find("placing: " + name), std::string::npos) << name << " is not in: " << line;
}

// The box in a subfigure definition.
struct Subfigure {
  IgesText file{iges_box(false)};
  std::string definition;

  Subfigure() {
    const int entry = file.add(308, "0,4HPOST,1," + std::to_string(kGroup) + ";", 0, 0, "00000200");
    definition = std::to_string(entry);
  }
};

TEST(IgesPlacings, AMatrixThatNamesAnotherIsAppliedFirst) {
  IgesText file(iges_box(false));
  const int outer = file.add(124, kQuarterTurn);
  file.set_matrix(kGroup, file.add(124, kAlongX, outer));
  expect_box(file, {-20, 100, 0}, {0, 110, 30});
}

TEST(IgesPlacings, ThreeMatricesAndOneThatTwoChainsShare) {
  IgesText file(iges_box(false));
  const int outermost = file.add(124, kAlongX);
  const int middle = file.add(124, kQuarterTurn, outermost);
  file.set_matrix(kGroup, file.add(124, kAlongY, middle));
  expect_box(file, {30, 0, 0}, {50, 10, 30});
  const int group = file.add(402, "1," + std::to_string(kGroup) + ";", middle, 7);
  EXPECT_GT(group, 0);
  // The group of the group: all three matrices, then the quarter turn and the step along x again.
  expect_box(file, {90, 30, 0}, {100, 50, 30});
}

TEST(IgesPlacings, TheMatrixOfAnInstanceTurnsItsTranslationToo) {
  for (const auto& [matrix, form, low, high] :
       {std::tuple{kQuarterTurn, 0, mesh::Vec3d{-27, 5, 0}, mesh::Vec3d{-7, 15, 30}},
        {kMirror, 1, mesh::Vec3d{85, 7, 0}, mesh::Vec3d{95, 27, 30}},
        {kAlongX, 0, mesh::Vec3d{105, 7, 0}, mesh::Vec3d{115, 27, 30}}}) {
    Subfigure post;
    post.file.add(408, post.definition + ",5.,7.,0.;", post.file.add(124, matrix, 0, form));
    expect_box(post.file, low, high);
  }
}

TEST(IgesPlacings, AnInstanceThatIsScaledIsRefused) {
  Subfigure post;
  const int scaled = post.file.add(408, post.definition + ",5.,7.,0.,2.;");
  expect_refused(post.file, scaled, 408);
  Subfigure turned;
  const int matrix = turned.file.add(124, kQuarterTurn);
  expect_refused(turned.file, turned.file.add(408, turned.definition + ",5.,7.,0.,2.;", matrix),
                 408);
}

TEST(IgesPlacings, AMatrixThatIsNotRigidOrNotThereIsRefused) {
  using Add = std::function<int(IgesText&)>;
  for (const Add& add : {Add([](IgesText& f) { return f.add(124, kTwice); }),
                         Add([](IgesText& f) { return f.add(124, kSkew); }),
                         Add([](IgesText& f) { return f.add(124, kAlongX, 0, 11); }),
                         Add([](IgesText& f) { return f.add(124, kAlongX, f.add(124, kTwice)); }),
                         Add([](IgesText& f) { return f.add(124, kAlongX, 99999); }),
                         Add([](IgesText& f) { return f.add(124, kAlongX, 5); }),
                         Add([](IgesText&) { return 99999; }), Add([](IgesText&) { return 5; }),
                         Add([](IgesText& f) {
                           const int inner = f.add(124, kAlongX);
                           f.set_matrix(inner, f.add(124, kAlongX, inner));
                           return inner;
                         })}) {
    IgesText file(iges_box(false));
    file.set_matrix(kGroup, add(file));
    expect_refused(file, kGroup, 402);
  }
}

// How far from a rotation a matrix may be that a file gives with few digits.
TEST(IgesPlacings, AMatrixIsRigidWithinTheRoundingOfAFile) {
  for (const auto& [factor, is_rigid] : {std::pair{1.00004, true}, {1.0001, false}}) {
    IgesText file(iges_box(false));
    const std::string f = std::to_string(factor);
    file.set_matrix(kGroup,
                    file.add(124, f + ",0.,0.,100.,0.," + f + ",0.,0.,0.,0.," + f + ",0.;"));
    if (is_rigid) {
      expect_box(file, {100, 0, 0}, {110, 20, 30});
    } else {
      expect_refused(file, kGroup, 402);
    }
  }
}

// OpenCASCADE ignores the matrix of a solid and of its parts.
TEST(IgesPlacings, TheMatrixOfASolidIsRefused) {
  IgesText file(iges_box(true));
  const int identity = file.add(124, kIdentity), moved = file.add(124, kAlongX);
  file.set_matrix(kSolid, identity);
  expect_box(file, {0, 0, 0}, {10, 20, 30});
  for (const auto& [entry, type] :
       {std::pair{kSolid, 186}, {3, 514}, {5, 510}, {15, 508}, {17, 504}, {21, 502}}) {
    IgesText damaged = file;
    damaged.set_matrix(entry, moved);
    expect_refused(damaged, entry, type);
  }
}

TEST(IgesPlacings, ArraysAndNetworksAreRefused) {
  for (const auto& [type, parameters] : {std::pair{412, ",1.,0.,0.,0.,3,2,60.,60.;"},
                                         {412, ",1.,0.,0.,0.,3,2,60.,60.,0.,0,0;"},
                                         {414, ",4,0.,0.,0.,60.,0.,1.5707963267948966,0,0;"},
                                         {414, ",4,0.,0.,0.,60.;"}}) {
    Subfigure post;
    post.file.add(408, post.definition + ",0.,0.,0.;");
    expect_refused(post.file, post.file.add(type, post.definition + parameters), type);
  }
  IgesText file(iges_box(false));
  const int network =
      file.add(320, "0,4HPOST,1," + std::to_string(kGroup) + ",1,0,0;", 0, 0, "00000200");
  const int instance = file.add(420, std::to_string(network) + ",9.,0.,0.,1.,1.,1.,1,0,0,0;");
  expect_refused(file, instance, 420);
}

// Nobody knows what it places.
TEST(IgesPlacings, AnInstanceOfNothingIsRefused) {
  for (const char* definition : {"99999", "5", "0"}) {
    IgesText file(iges_box(false));
    expect_refused(file, file.add(408, std::string(definition) + ",5.,7.,0.;"), 408);
  }
}

#endif

}  // namespace
}  // namespace forcelayer
