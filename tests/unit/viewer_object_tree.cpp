// The tree of objects: rows, choosing, hiding; and the mesh under the pointer.
#include <gtest/gtest.h>

#include "workbench/viewer/plan/mesh_pick.h"
#include "workbench/viewer/plan/object_tree.h"
#include "workbench/viewer/run/moment.h"

namespace forcelayer::viewer {
namespace {

using Shown = ObjectTree::Shown;

const std::vector<std::string> kNames = {"Gearbox/Housing", "Gearbox/Lid/Cover", "Gearbox/Lid/Bolt",
                                         "Gearbox/Lid/Bolt[2]", "rack"};

std::string drawn(const ObjectTree& tree) {
  std::string text;
  for (const ObjectTree::Row& row : tree.rows()) {
    text += std::string(2 * row.depth, ' ') + (row.node == tree.selected() ? ">" : "") +
            std::string(row.label) +
            (row.shown == Shown::kAll    ? ""
             : row.shown == Shown::kSome ? " some"
                                         : " none") +
            "\n";
  }
  return text;
}

TEST(ObjectTree, HidesAndIsolatesWhatIsChosen) {
  ObjectTree tree(kNames);
  EXPECT_EQ(drawn(tree), ">Gearbox\n  Housing\n  Lid\n    Cover\n    Bolt\n    Bolt[2]\nrack\n");
  tree.step(2);
  tree.toggle();
  EXPECT_EQ(
      drawn(tree),
      "Gearbox some\n  Housing\n  >Lid none\n    Cover none\n    Bolt none\n    Bolt[2] none\n"
      "rack\n");
  EXPECT_EQ(tree.hidden(), (std::vector<std::string>{kNames[1], kNames[2], kNames[3]}));
  tree.select_object("Gearbox/Lid/Bolt");
  tree.toggle();
  EXPECT_TRUE(tree.is_shown(2));
  tree.select_object("Gearbox/Lid/Cover");
  tree.isolate();
  EXPECT_EQ(tree.hidden(), (std::vector<std::string>{kNames[0], kNames[2], kNames[3], kNames[4]}));
  tree.isolate();
  EXPECT_TRUE(tree.hidden().empty());
  tree.hide({"rack", "nothing"});
  EXPECT_EQ(tree.hidden(), std::vector<std::string>{"rack"});
  tree.show_all();
  EXPECT_TRUE(tree.hidden().empty());
}

TEST(ObjectTree, ClosedGroupsHoldTheirRows) {
  ObjectTree tree(kNames);
  tree.step(2);
  tree.fold();
  EXPECT_EQ(drawn(tree), "Gearbox\n  Housing\n  >Lid\nrack\n");
  tree.step(1);
  EXPECT_EQ(tree.rows().back().node, tree.selected());
  tree.step(100);
  EXPECT_EQ(tree.rows().back().node, tree.selected());
  tree.step(-100);
  EXPECT_EQ(tree.rows().front().node, tree.selected());
  tree.select_object("Gearbox/Lid/Bolt[2]");  // opens what it is in
  EXPECT_EQ(drawn(tree), "Gearbox\n  Housing\n  Lid\n    Cover\n    Bolt\n    >Bolt[2]\nrack\n");
  tree.select_object("no such");
  EXPECT_EQ(tree.rows()[5].node, tree.selected());
}

TEST(ObjectTree, OfNothingIsEmpty) {
  ObjectTree tree({});
  EXPECT_TRUE(tree.empty());
  tree.toggle();
  tree.isolate();
  tree.fold();
  tree.step(1);
  EXPECT_TRUE(tree.rows().empty());
}

// Two unit squares across x, at x = 1 and at x = 2, about an origin of their own.
TEST(MeshOn, MeetsTheFirstThatIsShown) {
  ViewScene scene;
  scene.origin_m = {10, 0, 0};
  for (const float x : {2.0f, 1.0f}) {
    scene.meshes.push_back({x == 1 ? "near" : "far",
                            {{x, 0, 0}, {x, 1, 0}, {x, 1, 1}, {x, 0, 1}},
                            {{0, 1, 2}, {0, 2, 3}}});
  }
  const auto met = [&](const std::vector<char>& hidden, const Ray& ray,
                       const std::optional<Cut>& cut) {
    const auto hit = mesh_on(scene, hidden, ray, cut);
    return hit ? text_of("%s at %g", std::string(hit->name).c_str(),
                         ray.from_m.x + hit->along * ray.along.x)
               : std::string();
  };
  const Ray ray{{5, 0.25, 0.5}, {2, 0, 0}};
  EXPECT_EQ(met({0, 0}, ray, {}), "near at 11");
  EXPECT_EQ(met({0, 1}, ray, {}), "far at 12");
  EXPECT_EQ(met({1, 1}, ray, {}), "");
  EXPECT_EQ(met({0, 0}, ray, Cut{0, 11.5, false}), "far at 12");
  EXPECT_EQ(met({0, 0}, {{5, 1.25, 0.5}, {1, 0, 0}}, {}), "") << "beside";
  EXPECT_EQ(met({0, 0}, {{5, 0.25, 0.5}, {-1, 0, 0}}, {}), "") << "behind";
  EXPECT_EQ(met({0, 0}, {{15, 0.25, 0.5}, {-1, 0, 0}}, {}), "far at 12");
}

}  // namespace
}  // namespace forcelayer::viewer
