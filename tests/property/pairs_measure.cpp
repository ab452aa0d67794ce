// Pairs of parts, against slow twins: every pair of triangles, and places sampled densely on every
// triangle, with the side by solid angles in long double.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "tests/support/pair_assembly.h"
#include "tests/support/random_numbers.h"
#include "tests/support/sanitized.h"
#include "workbench/exact/triangle_distance.h"
#include "workbench/pairs/check.h"

namespace forcelayer::pairs {
namespace {

using command::VerdictKind;
using test::box_mesh;
using test::moved;
using test::rod_mesh;
using Wide = glm::vec<3, long double>;
using WideTriangle = std::array<Wide, 3>;

std::vector<exact::Corners> corners_of(const AssemblyParts& assembly, std::size_t part) {
  const mesh::Mesh& mesh = assembly.scene.mesh_of(assembly.scene.objects[part]);
  std::vector<exact::Corners> all;
  for (const mesh::Triangle& t : mesh.triangles) {
    exact::Corners corners;
    for (std::size_t n = 0; n < 3; ++n) {
      const mesh::Vec3d& v = mesh.vertices[t[n]];
      corners[n] = {v[0], v[1], v[2]};
    }
    all.push_back(corners);
  }
  return all;
}

double brute_distance_m(const std::vector<exact::Corners>& a,
                        const std::vector<exact::Corners>& b) {
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const exact::Corners& s : a) {
    for (const exact::Corners& t : b) {
      nearest_m = std::min(nearest_m, exact::triangle_distance(s, t).distance_m);
    }
  }
  return nearest_m;
}

// The distance of a place from a closed body's triangles; negative outside.
long double depth_in(const glm::dvec3& place, const std::vector<exact::Corners>& body) {
  const Wide p(place);
  long double winding = 0, nearest = 1e30L;
  for (const exact::Corners& t : body) {
    nearest = std::min<long double>(nearest,
                                    exact::triangle_distance({place, place, place}, t).distance_m);
    const Wide a = Wide(t[0]) - p, b = Wide(t[1]) - p, c = Wide(t[2]) - p;
    const long double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    winding += 2 * std::atan2(glm::dot(a, glm::cross(b, c)), la * lb * lc + glm::dot(a, b) * lc +
                                                                 glm::dot(b, c) * la +
                                                                 glm::dot(c, a) * lb);
  }
  return std::abs(winding) > 2 * std::numbers::pi_v<long double> ? nearest : -nearest;
}

// The deepest of a lattice of places on a surface.
long double sampled_depth(const std::vector<exact::Corners>& surface,
                          const std::vector<exact::Corners>& body) {
  constexpr int kSteps = 4;
  long double deepest = -1e30L;
  for (const exact::Corners& t : surface) {
    for (int i = 0; i <= kSteps; ++i) {
      for (int j = 0; i + j <= kSteps; ++j) {
        const double u = static_cast<double>(i) / kSteps, v = static_cast<double>(j) / kSteps;
        deepest = std::max(deepest, depth_in(t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0]), body));
      }
    }
  }
  return deepest;
}

Findings check(const AssemblyParts& assembly, const Requirement& otherwise = {},
               const std::vector<Rule>& rules = {}) {
  std::vector<PartName> names;
  for (const AssemblyPart& part : assembly.parts) names.push_back(part.name);
  const RuleTable table(rules, names);
  return check_pairs(assembly, rules, table, otherwise, [](double) {});
}

Requirement apart(double clearance_m) { return {Requirement::Kind::kClearance, clearance_m}; }

mesh::Mesh random_mesh(test::Random& random) {
  switch (test::integer(random, 0, 3)) {
    case 0:
      return box_mesh(test::uniform(random, 0.2, 1), test::uniform(random, 0.2, 1),
                      test::uniform(random, 0.2, 1));
    case 1: {
      const double radius = test::uniform(random, 0.2, 0.6);
      return test::ring_mesh(8, test::uniform(random, 0.4, 0.9) * radius, radius,
                             test::uniform(random, 0.1, 0.6));
    }
    case 2:
      return box_mesh(test::uniform(random, 0.5, 1.2), test::uniform(random, 0.5, 1.2), 0.03);
    default:
      return rod_mesh(7, test::uniform(random, 0.05, 0.2), test::uniform(random, 0.5, 1.5));
  }
}

// Whether a finding about two parts is what the twins say.
void expect_as_brute(const AssemblyParts& assembly, std::uint32_t a, std::uint32_t b,
                     const PairFinding* finding, const Requirement& requirement) {
  const auto first = corners_of(assembly, a), second = corners_of(assembly, b);
  const double margin_m = assembly.parts[a].deviation_m + assembly.parts[b].deviation_m +
                          assembly.parts[a].rounding_m + assembly.parts[b].rounding_m;
  const double distance_m = brute_distance_m(first, second);
  const long double sampled_m =
      std::max(sampled_depth(first, second), sampled_depth(second, first));
  SCOPED_TRACE(assembly.parts[a].name.listed + " and " + assembly.parts[b].name.listed +
               ", distance " + std::to_string(distance_m) + " m, sampled depth " +
               std::to_string(static_cast<double>(sampled_m)) + " m");
  const bool must_overlap = sampled_m > margin_m;
  if (finding == nullptr) {
    EXPECT_FALSE(must_overlap);
    EXPECT_GE(distance_m, requirement.clearance_m + margin_m);
    return;
  }
  EXPECT_NEAR(finding->measure.distance_m, distance_m, 1e-12);
  const PairMeasure& measure = finding->measure;
  if (measure.contact != Contact::kOverlap) {
    EXPECT_FALSE(must_overlap);
    const VerdictKind expected =
        distance_m < requirement.clearance_m -
                         (margin_m - assembly.parts[a].deviation_m - assembly.parts[b].deviation_m)
            ? VerdictKind::kTooNear
        : requirement.clearance_m == 0 ? VerdictKind::kStaysInstalled
                                       : VerdictKind::kTooCloseToCall;
    EXPECT_EQ(finding->kind, expected);
    return;
  }
  EXPECT_EQ(finding->kind, VerdictKind::kCollides);
  EXPECT_GT(measure.depth_m, margin_m);
  const glm::dvec3 place(measure.at_m[0], measure.at_m[1], measure.at_m[2]);
  const auto depth_of_place_m = [&](std::uint32_t solid) {
    return static_cast<double>(depth_in(place, solid == a ? first : second));
  };
  if (measure.is_at_least) {
    EXPECT_NEAR(std::min(depth_of_place_m(a), depth_of_place_m(b)), measure.depth_m, 1e-9);
  } else {
    EXPECT_NEAR(depth_of_place_m(finding->object), measure.depth_m, 1e-9);
    EXPECT_NEAR(std::abs(depth_of_place_m(finding->part)), 0, 1e-9);  // a place of its surface
    EXPECT_GE(measure.depth_m, static_cast<double>(sampled_m) * (1 - 1.0 / 128) - 2e-6);
  }
}

TEST(PairsMeasure, AgreesWithBruteForceInRandomAssemblies) {
  int overlaps = 0, near = 0, none = 0;
  for (std::uint64_t seed = 1; seed <= 10; seed += test::seed_step(4)) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    test::Random random(seed);
    AssemblyParts assembly;
    for (int n = 0; n < 9; ++n) {
      const glm::dvec3 place(test::uniform(random, -1.1, 1.1), test::uniform(random, -1.1, 1.1),
                             test::uniform(random, -1.1, 1.1));
      test::add_part(assembly, "part" + std::to_string(n),
                     moved(random_mesh(random), Pose{place, test::random_orientation(random)}),
                     test::integer(random, 0, 1) == 0 ? 0 : test::uniform(random, 0, 0.03));
    }
    const Requirement requirement =
        seed % 3 == 0 ? Requirement{} : apart(test::uniform(random, 0.01, 0.5));
    const Requirement ignored{Requirement::Kind::kIgnore, 0};
    const std::vector<Rule> rules = {
        {"part0", "part1", ignored, 2}, {"part2", "*", apart(0.7), 3}, {"part3", "part?", {}, 4}};
    const auto required = [&](std::uint32_t a, std::uint32_t b) {
      if (a == 0 && b == 1) return ignored;
      if (a == 2 || b == 2) return rules[1].requirement;
      return a == 3 || b == 3 ? rules[2].requirement : requirement;
    };
    const Findings findings = check(assembly, requirement, rules);
    EXPECT_EQ(findings.pairs, 36u);
    EXPECT_EQ(findings.ignored, 1u);
    std::map<std::pair<std::uint32_t, std::uint32_t>, const PairFinding*> found;
    for (const PairFinding& finding : findings.by_rank) {
      const auto ordered = std::minmax(finding.part, finding.object);
      EXPECT_TRUE(found.emplace(ordered, &finding).second);
      (finding.kind == VerdictKind::kCollides ? overlaps : near) += 1;
    }
    for (std::uint32_t a = 0; a < 9; ++a) {
      for (std::uint32_t b = a + 1; b < 9; ++b) {
        const auto at = found.find({a, b});
        const PairFinding* const finding = at == found.end() ? nullptr : at->second;
        none += finding == nullptr;
        if (required(a, b).kind == Requirement::Kind::kIgnore) {
          EXPECT_EQ(finding, nullptr);
        } else {
          expect_as_brute(assembly, a, b, finding, required(a, b));
        }
      }
    }
  }
  EXPECT_GT(overlaps, 20 / static_cast<int>(test::seed_step(4)));
  EXPECT_GT(near, 30 / static_cast<int>(test::seed_step(4)));
  EXPECT_GT(none, 30);
}

// The one finding about two parts.
PairFinding only_finding(const AssemblyParts& assembly, const Requirement& requirement = {}) {
  const Findings findings = check(assembly, requirement);
  EXPECT_EQ(findings.by_rank.size(), 1u);
  return findings.by_rank.empty() ? PairFinding{} : findings.by_rank.front();
}

TEST(PairsMeasure, RequiresTheClearanceToTheMicrometer) {
  const Requirement millimeter = apart(1e-3);
  const auto two_boxes = [](double gap_m, double deviation_m) {
    AssemblyParts assembly;
    test::add_part(assembly, "left", moved(box_mesh(0.01, 0.01, 0.01), -0.005, 0, 0), deviation_m);
    test::add_part(assembly, "right", moved(box_mesh(0.01, 0.01, 0.01), 0.005 + gap_m, 0, 0));
    return assembly;
  };
  EXPECT_EQ(only_finding(two_boxes(0.999e-3, 0), millimeter).kind, VerdictKind::kTooNear);
  EXPECT_EQ(only_finding(two_boxes(1e-3, 0), millimeter).kind, VerdictKind::kTooCloseToCall);
  EXPECT_TRUE(check(two_boxes(1.001e-3, 0), millimeter).by_rank.empty());
  // A deviation may have brought the true surfaces nearer.
  EXPECT_EQ(only_finding(two_boxes(1.049e-3, 5e-5), millimeter).kind, VerdictKind::kTooCloseToCall);
  EXPECT_TRUE(check(two_boxes(1.051e-3, 5e-5), millimeter).by_rank.empty());
}

TEST(PairsMeasure, DecidesOneRepresentableStepBesideEachBound) {
  const double margin_m = 3e-5, rounding_m = 1e-9;
  const auto kind = [&](double distance_m) {
    PairMeasure measure;
    measure.distance_m = distance_m;
    return kind_of(measure, apart(1e-3), margin_m, rounding_m);
  };
  const double kept_m = 1e-3 + margin_m, near_m = 1e-3 - rounding_m;
  EXPECT_EQ(kind(kept_m), VerdictKind::kKeepsClearance);
  EXPECT_EQ(kind(std::nextafter(kept_m, 0)), VerdictKind::kTooCloseToCall);
  EXPECT_EQ(kind(near_m), VerdictKind::kTooCloseToCall);
  EXPECT_EQ(kind(std::nextafter(near_m, 0)), VerdictKind::kTooNear);
}

// Flat on flat, and a rod in a bore of its own size: what deviations explain is contact.
TEST(PairsMeasure, TellsContactFromOverlap) {
  const auto stacked = [](double overlap_m, double deviation_m) {
    AssemblyParts assembly;
    test::add_part(assembly, "low", moved(box_mesh(0.1, 0.1, 0.02), 0, 0, -0.01), deviation_m);
    test::add_part(assembly, "high", moved(box_mesh(0.03, 0.02, 0.02), 0, 0, 0.01 - overlap_m));
    return assembly;
  };
  EXPECT_EQ(only_finding(stacked(0, 0)).measure.contact, Contact::kTouch);
  EXPECT_EQ(only_finding(stacked(1e-6, 0)).measure.contact, Contact::kOverlap);
  EXPECT_NEAR(only_finding(stacked(1e-6, 0)).measure.depth_m, 1e-6, 1e-9);
  EXPECT_EQ(only_finding(stacked(1.9e-5, 2e-5)).measure.contact, Contact::kTouch);
  EXPECT_EQ(only_finding(stacked(2.1e-5, 2e-5)).measure.contact, Contact::kOverlap);
  EXPECT_EQ(only_finding(stacked(0, 0), apart(1e-3)).kind, VerdictKind::kTooNear);
  // Corners of the rod's 16 sides pass through the bore's 20 flat ones by 0.12 mm at most.
  for (const double deviation_m : {0.0, 1e-4}) {
    AssemblyParts fit;
    test::add_part(fit, "bore", test::ring_mesh(20, 0.01, 0.02, 0.03), deviation_m);
    test::add_part(fit, "rod", rod_mesh(16, 0.01, 0.05), deviation_m);
    EXPECT_EQ(only_finding(fit).measure.contact,
              deviation_m > 0 ? Contact::kTouch : Contact::kOverlap);
  }
}

TEST(PairsMeasure, FindsPartsThatLieInsideOthers) {
  AssemblyParts assembly;
  test::add_part(assembly, "block", box_mesh(0.1, 0.1, 0.1));
  test::add_part(assembly, "buried", moved(box_mesh(0.01, 0.01, 0.01), 0.02, 0, 0));
  const PairFinding found = only_finding(assembly);
  EXPECT_EQ(found.kind, VerdictKind::kCollides);
  EXPECT_EQ(assembly.parts[found.part].name.listed, "buried");
  EXPECT_NEAR(found.measure.depth_m, 0.035, 0.035 / 128);
  EXPECT_NEAR(found.measure.distance_m, 0.025, 1e-12);
  // So is one of the two bodies of a part whose other body lies outside.
  mesh::Mesh pair = moved(box_mesh(0.01, 0.01, 0.01), 0.3, 0, 0);
  const mesh::Mesh second = moved(box_mesh(0.01, 0.01, 0.01), 0.02, 0, 0);
  for (const mesh::Vec3d& v : second.vertices) pair.vertices.push_back(v);
  for (const mesh::Triangle& t : second.triangles) {
    pair.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
  }
  AssemblyParts half_buried;
  test::add_part(half_buried, "block", box_mesh(0.1, 0.1, 0.1));
  test::add_part(half_buried, "pair", pair);
  EXPECT_EQ(only_finding(half_buried).kind, VerdictKind::kCollides);
  // In a hollow block the same part is apart.
  mesh::Mesh hollow = box_mesh(0.1, 0.1, 0.1);
  mesh::Mesh cavity = box_mesh(0.06, 0.06, 0.06);
  for (const mesh::Vec3d& v : cavity.vertices) hollow.vertices.push_back(v);
  for (const mesh::Triangle& t : cavity.triangles) {
    hollow.triangles.push_back({t[0] + 8, t[2] + 8, t[1] + 8});
  }
  AssemblyParts held;
  test::add_part(held, "hollow", hollow);
  test::add_part(held, "inner", moved(box_mesh(0.01, 0.01, 0.01), 0.02, 0, 0));
  EXPECT_TRUE(check(held).by_rank.empty());
  EXPECT_NEAR(only_finding(held, apart(0.02)).measure.distance_m, 0.005, 1e-12);
}

// No place of one surface is inside of the other then.
TEST(PairsMeasure, FindsPartsThatStandInTheSamePlace) {
  AssemblyParts assembly;
  test::add_part(assembly, "bolt", rod_mesh(12, 0.005, 0.03));
  test::add_part(assembly, "bolt again", rod_mesh(12, 0.005, 0.03));
  const PairFinding found = only_finding(assembly);
  EXPECT_EQ(found.kind, VerdictKind::kCollides);
  EXPECT_TRUE(found.measure.is_at_least);
  EXPECT_GT(found.measure.depth_m, 0.003);
  // The copy may be smaller by less than deviations explain. Then no surfaces meet.
  AssemblyParts nested;
  test::add_part(nested, "block", box_mesh(0.04, 0.04, 0.04), 2e-5);
  test::add_part(nested, "smaller", box_mesh(0.03999, 0.03999, 0.03999));
  const PairFinding copy = only_finding(nested);
  EXPECT_EQ(copy.kind, VerdictKind::kCollides);
  EXPECT_NEAR(copy.measure.depth_m, 0.02, 1e-4);
  EXPECT_NEAR(copy.measure.distance_m, 5e-6, 1e-9);
  // A plug fills the bore of a ring exactly: all of its side touches.
  AssemblyParts filled;
  test::add_part(filled, "ring", test::ring_mesh(12, 0.005, 0.01, 0.03));
  test::add_part(filled, "plug", rod_mesh(12, 0.005, 0.03));
  EXPECT_EQ(only_finding(filled).measure.contact, Contact::kTouch);
}

TEST(PairsMeasure, ClaimsNoDepthInOpenMeshes) {
  mesh::Mesh open = box_mesh(0.1, 0.1, 0.1);
  open.triangles.pop_back();
  AssemblyParts buried;
  test::add_part(buried, "open", open);
  test::add_part(buried, "small", box_mesh(0.01, 0.01, 0.01));
  const PairFinding inside = only_finding(buried);
  EXPECT_EQ(inside.kind, VerdictKind::kUndecided);
  EXPECT_NEAR(inside.measure.distance_m, 0.045, 1e-12);
  EXPECT_EQ(inside.measure.depth_m, 0);
  EXPECT_NE(inside.measure.doubt.find("may be inside: the mesh of open is open"), std::string::npos)
      << inside.measure.doubt;
  // Where the distance alone breaks the rule, that is known.
  EXPECT_EQ(only_finding(buried, apart(0.05)).kind, VerdictKind::kTooNear);
  // Outside of it nothing is in doubt.
  AssemblyParts beside;
  test::add_part(beside, "open", open);
  test::add_part(beside, "small", moved(box_mesh(0.01, 0.01, 0.01), 0.07, 0, 0));
  EXPECT_TRUE(check(beside).by_rank.empty());
  AssemblyParts crossing;
  test::add_part(crossing, "open", open);
  test::add_part(crossing, "other", moved(open, 0.05, 0.02, 0));
  EXPECT_EQ(only_finding(crossing).kind, VerdictKind::kUndecided);
}

// Two bodies of one part.
mesh::Mesh both(mesh::Mesh a, const mesh::Mesh& b) {
  const auto first = static_cast<std::uint32_t>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const mesh::Triangle& t : b.triangles) {
    a.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  return a;
}

// A box without its upper face.
mesh::Mesh bowl_mesh(double size_m) {
  mesh::Mesh bowl = box_mesh(size_m, size_m, size_m);
  bowl.triangles.erase(bowl.triangles.begin() + 2, bowl.triangles.begin() + 4);
  return bowl;
}

TEST(PairsMeasure, KeepsNoPairThatAnOpenMeshMayHold) {
  const auto with_bowl = [](const mesh::Mesh& other, double deviation_m = 0) {
    AssemblyParts assembly;
    test::add_part(assembly, "bowl", bowl_mesh(0.04), deviation_m);
    test::add_part(assembly, "other", other);
    return assembly;
  };
  const auto doubted = [&](const mesh::Mesh& other, double deviation_m = 0) {
    const PairFinding finding = only_finding(with_bowl(other, deviation_m));
    return finding.kind == VerdictKind::kUndecided &&
           finding.measure.doubt.find("it may be inside: the mesh of ") != std::string::npos;
  };
  // On the inner side of a wall, or of the floor.
  EXPECT_TRUE(doubted(moved(box_mesh(0.01, 0.01, 0.01), 0.015, 0, 0)));
  EXPECT_TRUE(doubted(moved(box_mesh(0.01, 0.01, 0.01), 0, 0, -0.015)));
  EXPECT_TRUE(doubted(moved(box_mesh(0.01, 0.01, 0.001), 0, 0, -0.0195)));
  // A small body of a part of which a larger one touches it from outside.
  EXPECT_TRUE(doubted(both(moved(rod_mesh(16, 0.02, 0.1), 0, 0, -0.07),
                           moved(box_mesh(0.002, 0.002, 0.002), 0.01, 0.01, 0))));
  // A rod stands out of it, and touches nothing.
  EXPECT_TRUE(doubted(moved(rod_mesh(12, 0.005, 0.05), 0, 0, 0.02)));
  // A solid fills it, or does so but for less than deviations explain.
  EXPECT_TRUE(doubted(box_mesh(0.04, 0.04, 0.04)));
  EXPECT_TRUE(doubted(box_mesh(0.03999, 0.03999, 0.03999), 2e-5));
  EXPECT_TRUE(doubted(bowl_mesh(0.03999), 2e-5));
  // Outside of it: on a wall, under the floor, and farther away.
  const auto contact = [&](const mesh::Mesh& other) {
    return only_finding(with_bowl(other)).measure.contact;
  };
  EXPECT_EQ(contact(moved(box_mesh(0.01, 0.01, 0.01), 0.025, 0, 0)), Contact::kTouch);
  EXPECT_EQ(contact(moved(box_mesh(0.01, 0.01, 0.01), 0, 0, -0.025)), Contact::kTouch);
  EXPECT_TRUE(check(with_bowl(moved(box_mesh(0.01, 0.01, 0.01), 0.026, 0, 0))).by_rank.empty());
  // A wall in a solid is an overlap, and how deep the solid is in the open mesh is not known.
  const PairFinding through =
      only_finding(with_bowl(moved(box_mesh(0.01, 0.01, 0.01), 0.02, 0, 0)));
  EXPECT_EQ(through.kind, VerdictKind::kCollides);
  EXPECT_TRUE(through.measure.is_at_least);
}

// Two bodies of each part: one pair of them touches, the other overlaps, and no surfaces meet.
TEST(PairsMeasure, LooksInsideBothWays) {
  // The first part is within rounding of a wall of the second's thin shell; the second's other
  // body lies inside the first's other body.
  const mesh::Mesh thin = box_mesh(0.04, 0.04, 1.2e-5);
  AssemblyParts assembly;
  test::add_part(assembly, "a",
                 both(box_mesh(0.0399, 0.0399, 2e-6), moved(box_mesh(0.05, 0.05, 0.05), 0, 0, 0.2)),
                 2e-5);
  test::add_part(assembly, "b", both(thin, moved(box_mesh(0.02, 0.02, 0.02), 0, 0, 0.2)));
  const PairFinding found = only_finding(assembly);
  EXPECT_EQ(found.kind, VerdictKind::kCollides);
  EXPECT_GT(found.measure.depth_m, 0.014);
}

// A place may come through a crack of a solid as deep as the crack is wide, but only near it.
TEST(PairsMeasure, CracksWidenTheBoundOfAContact) {
  mesh::Mesh cracked = moved(box_mesh(0.1, 0.1, 0.1), 0, 0, -0.05);
  const auto first = static_cast<std::uint32_t>(cracked.vertices.size());
  for (std::size_t n = 4; n < 8; ++n) {  // the upper face gets corners of its own, 5 um higher
    mesh::Vec3d corner = cracked.vertices[n];
    corner[2] += 5e-6;
    cracked.vertices.push_back(corner);
  }
  cracked.triangles[2] = {first, first + 1, first + 2};
  cracked.triangles[3] = {first + 1, first + 3, first + 2};
  const auto pressed = [&](double depth_m, double width_m, double x_m) {
    AssemblyParts assembly;
    test::add_part(assembly, "cracked", cracked);
    test::add_part(assembly, "foot",
                   moved(box_mesh(width_m, width_m, 0.02), x_m, 0, 0.01 + 5e-6 - depth_m));
    return only_finding(assembly).measure;
  };
  const PairMeasure beside = pressed(2e-6, 4e-6, 0.05 - 3e-6);
  EXPECT_EQ(beside.contact, Contact::kTouch);
  EXPECT_GE(beside.crack_m, 5e-6);
  EXPECT_EQ(pressed(1e-4, 4e-6, 0.05 - 3e-6).contact, Contact::kOverlap);
  EXPECT_EQ(pressed(0, 0.02, 0).contact, Contact::kTouch);
  EXPECT_EQ(pressed(0, 0.02, 0).crack_m, 0);
  EXPECT_EQ(pressed(2e-6, 0.02, 0).contact, Contact::kOverlap);
  AssemblyParts feet;  // at the middle of both parts there is nothing
  test::add_part(feet, "cracked", cracked);
  test::add_part(feet, "foot",
                 moved(test::ring_mesh(8, 0.005, 0.01, 0.02), 0, 0, 0.01 + 5e-6 - 2e-6));
  EXPECT_EQ(only_finding(feet).measure.contact, Contact::kOverlap);
  EXPECT_EQ(pressed(1e-3, 0.02, 0).contact, Contact::kOverlap);
  EXPECT_NEAR(pressed(1e-3, 0.02, 0).depth_m, 1e-3, 1e-5);
}

TEST(PairsMeasure, RanksTheWorstFirst) {
  AssemblyParts assembly;
  test::add_part(assembly, "a", box_mesh(0.1, 0.1, 0.1));
  test::add_part(assembly, "b", moved(box_mesh(0.1, 0.1, 0.1), 0.1004, 0, 0));
  test::add_part(assembly, "c", moved(box_mesh(0.1, 0.1, 0.1), 0, 0.099, 0));
  test::add_part(assembly, "d", moved(box_mesh(0.1, 0.1, 0.1), 0, 0, 0.0995));
  test::add_part(assembly, "e", moved(box_mesh(0.1, 0.1, 0.1), -0.1001, 0, 0));
  std::vector<double> order;
  for (const PairFinding& finding : check(assembly, apart(5e-4)).by_rank) {
    if (finding.part == 0 || finding.object == 0) {
      order.push_back(finding.measure.distance_m - finding.measure.depth_m);
    }
  }
  ASSERT_EQ(order.size(), 4u);
  for (const auto& [n, wanted] : {std::pair(0, -1e-3), {1, -5e-4}, {2, 1e-4}, {3, 4e-4}}) {
    EXPECT_NEAR(order[static_cast<std::size_t>(n)], wanted, 2e-6);
  }
}

}  // namespace
}  // namespace forcelayer::pairs
