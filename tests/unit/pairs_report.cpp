// The words, the table and the JSON of `forcelayer pairs`.
#include "workbench/pairs/report.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <vector>

#include "tests/support/pair_assembly.h"

namespace forcelayer::pairs {
namespace {

using test::box_mesh;
using test::moved;

// Cubes of 10 mm in a row, with these gaps between neighbors.
class Row {
 public:
  explicit Row(const std::vector<double>& gaps_m, Requirement otherwise = {})
      : otherwise_(otherwise) {
    double x = 0;
    for (std::size_t n = 0; n <= gaps_m.size(); ++n) {
      test::add_part(assembly_, "cube" + std::to_string(n),
                     moved(box_mesh(0.01, 0.01, 0.01), x, 0, 0));
      if (n < gaps_m.size()) x += 0.01 + gaps_m[n];
    }
  }
  AssemblyParts& assembly() { return assembly_; }
  void add_rule(const Rule& rule) { rules_.push_back(rule); }

  Answer answer() {
    std::vector<PartName> names;
    for (const AssemblyPart& part : assembly_.parts) names.push_back(part.name);
    const RuleTable table(rules_, names);
    findings_ = check_pairs(assembly_, rules_, table, otherwise_, [](double) {});
    return {assembly_, rules_, otherwise_, findings_};
  }

 private:
  AssemblyParts assembly_;
  std::vector<Rule> rules_;
  Requirement otherwise_;
  Findings findings_;
};

const Requirement kMillimeter{Requirement::Kind::kClearance, 1e-3};

TEST(PairsReport, IsOneSentence) {
  const auto words = [](const std::vector<double>& gaps_m, const Requirement& required) {
    Row row(gaps_m, required);
    return sentence(row.answer());
  };
  EXPECT_EQ(words({0.5}, {}), "The only pair keeps its rule.");
  EXPECT_EQ(words({0.5, 0.5}, {}), "All 3 pairs keep their rules.");
  EXPECT_EQ(words({0, 0}, {}), "All 3 pairs keep their rules; 2 touch as allowed.");
  EXPECT_EQ(words({-1e-3}, {}), "1 of 1 pair overlaps: cube0 1 mm into cube1.");
  EXPECT_EQ(words({5e-4, 5}, kMillimeter),
            "1 of 3 pairs is nearer than the required 1 mm: cube0 0.5 mm from cube1.");
  EXPECT_EQ(words({0, 5e-4}, kMillimeter),
            "2 of 3 pairs are nearer than the required 1 mm, the nearest: cube0 touches cube1.");
  EXPECT_EQ(words({1e-3, 5}, kMillimeter), "1 of 3 pairs is too close to call.");
}

TEST(PairsReport, NamesEachKindOfFinding) {
  Row row({-2.5e-3, -4e-4, 3e-4, 1e-3, 0, 0.02}, kMillimeter);
  row.add_rule({"cube4", "cube5", {}, 2});
  row.add_rule({"cube6", "*", {Requirement::Kind::kIgnore, 0}, 3});
  row.add_rule({"cube2", "cube3", {Requirement::Kind::kClearance, 2e-3}, 4});
  const Answer answer = row.answer();
  EXPECT_EQ(sentence(answer),
            "2 of 21 pairs overlap, the deepest: cube0 2.5 mm into cube1; 1 more is nearer than "
            "the required 2 mm: cube2 0.3 mm from cube3; 1 more is too close to call; 1 touches as "
            "allowed; 6 are ignored.");
  EXPECT_EQ(table(answer, 3),
            "  part   object  found           required  by           at x, y, z (mm)\n"
            "  cube0  cube1   overlap 2.5 mm  1 mm      --clearance  5, -1.67, -1.67\n"
            "  cube1  cube2   overlap 0.4 mm  1 mm      --clearance  12.5, -1.67, -1.67\n"
            "  cube2  cube3   0.3 mm apart    2 mm      line 4       22.25, -5, -5\n"
            "  and 1 more: see --json\n");
  const auto report = report_of(answer);
  EXPECT_EQ(report["verdict"], "not clear");
  EXPECT_EQ(report["kind"], "collides");
  EXPECT_EQ(report["sentence"], sentence(answer));
  EXPECT_EQ(report["parts"], 7);
  EXPECT_EQ(report["pairs"], 21);
  EXPECT_EQ(report["ignored"], 6);
  ASSERT_EQ(report["found"].size(), 5u);  // with the pair that touches
  EXPECT_EQ(report["found"][2]["rule_line"], 4);
  EXPECT_EQ(report["found"][2]["required_clearance_m"], 2e-3);
  EXPECT_EQ(report["found"][4]["kind"], "stays in contact");
  EXPECT_EQ(report["found"][4]["keeps_rule"], true);
  const Status ended = exit_of(answer, "row.glb");
  ASSERT_FALSE(ended);
  EXPECT_EQ(to_line(ended.error()), "row.glb: 4 of 21 pairs do not keep their rules");
}

TEST(PairsReport, SaysWhyAPairIsNotDecided) {
  Row row({0.5});
  mesh::Mesh open = moved(box_mesh(0.03, 0.03, 0.03), 0, 0, 0);
  open.triangles.pop_back();
  test::add_part(row.assembly(), "shell", open);
  const Answer answer = row.answer();
  EXPECT_EQ(sentence(answer), "1 of 3 pairs is undecided, because a mesh has no inside.");
  EXPECT_NE(table(answer).find("  cube0 and shell: it may be inside: the mesh of shell is open "
                               "(102.426 mm of open edges)\n"),
            std::string::npos)
      << table(answer);
  EXPECT_FALSE(exit_of(answer, "row.glb"));
}

// A pair may be undecided and too near at once, and still be apart.
TEST(PairsReport, SaysThatPartsTouchOnlyWhereTheyDo) {
  Row row({0.5}, {Requirement::Kind::kClearance, 0.02});
  mesh::Mesh open = box_mesh(0.03, 0.03, 0.03);
  open.triangles.pop_back();
  test::add_part(row.assembly(), "shell", open);
  EXPECT_EQ(sentence(row.answer()),
            "1 of 3 pairs is nearer than the required 20 mm: cube0 10 mm from shell.");
}

TEST(PairsReport, CountsCracksInTheMargin) {
  Row row({0});
  Answer answer = row.answer();
  const double margin_m = report_of(answer)["found"][0]["margin_m"];
  Findings cracked = answer.findings;
  cracked.by_rank[0].measure.crack_m = 1e-5;
  const Answer other{answer.assembly, answer.rules, answer.otherwise, cracked};
  EXPECT_EQ(report_of(other)["found"][0]["margin_m"], margin_m + 1e-5);
}

}  // namespace
}  // namespace forcelayer::pairs
