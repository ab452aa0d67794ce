// How nodes of an assembly are named: paths, ends of paths, wildcards, lists.
#include <gtest/gtest.h>

#include <random>

#include "formats/command/spelling/spelling.h"
#include "formats/mesh/checks/grouped_warnings.h"
#include "formats/mesh/node_names.h"

namespace forcelayer {
namespace {

using mesh::AssemblyNode;

// Gearbox with a lid of a cover and three bolts, a clip of two halves, and one more cover, which
// holds what is oddly named.
std::vector<AssemblyNode> gearbox() {
  const std::vector<std::pair<int, const char*>> names = {
      {0, "Gearbox"}, {1, "Lid"},  {2, "Cover"}, {2, "Bolt"},  {2, "Bolt"},    {2, "Bolt"},
      {1, "Clip"},    {2, "Half"}, {2, "Half"},  {1, "Cover"}, {2, "M6 1/2*"}, {2, "{Clip,Lid}"}};
  std::vector<AssemblyNode> nodes;
  std::vector<std::pair<AssemblyNode, mesh::UsedLabels>> open = {{}};
  for (const auto& [depth, name] : names) {
    open.resize(static_cast<std::size_t>(depth) + 1);
    const AssemblyNode* const parent = depth == 0 ? nullptr : &open.back().first;
    nodes.push_back(mesh::name_node(name, parent, open.back().second));
    open.push_back({nodes.back(), {}});
  }
  return nodes;
}

// The paths of the outermost nodes that are chosen, or the error.
std::string chosen(const std::vector<std::string>& names) {
  const auto nodes = gearbox();
  const auto is_in = mesh::choose_nodes(names, nodes);
  if (!is_in) return to_line(is_in.error());
  std::string text;
  std::size_t inside_of = nodes.size();  // depth of the chosen node above, else none
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (inside_of < nodes.size() && nodes[i].depth <= inside_of) inside_of = nodes.size();
    if (inside_of < nodes.size()) {
      EXPECT_TRUE((*is_in)[i]) << nodes[i].path << " is below a chosen node";
      continue;
    }
    if (!(*is_in)[i]) continue;
    text += (text.empty() ? "" : " ") + nodes[i].path;
    inside_of = nodes[i].depth;
  }
  return text;
}

TEST(NodeNames, ArePathsOrEndsOfPaths) {
  EXPECT_EQ(chosen({}), "Gearbox");
  EXPECT_EQ(chosen({"Gearbox/Lid/Cover"}), "Gearbox/Lid/Cover");
  EXPECT_EQ(chosen({"Lid/Cover"}), "Gearbox/Lid/Cover");
  EXPECT_EQ(chosen({"Clip"}), "Gearbox/Clip");
  EXPECT_EQ(chosen({"Gearbox/Cover"}), "Gearbox/Cover");
}

// A control letter as listings show it; a name that holds these letters itself goes first.
TEST(NodeNames, CanBeTypedAsTheyAreListed) {
  const std::vector<AssemblyNode> nodes = {{"tab\there", "top/tab\there", 0},
                                           {"b", "b", 0},
                                           {R"(c\x09d)", R"(c\x09d)", 0},
                                           {"c\td", "c\td", 0}};
  const auto indices = [&](const std::string& name) {
    std::vector<std::size_t> found;
    const auto is_in = mesh::choose_nodes(std::vector{name}, nodes);
    for (std::size_t i = 0; is_in && i < nodes.size(); ++i) {
      if ((*is_in)[i]) found.push_back(i);
    }
    return found;
  };
  using Indices = std::vector<std::size_t>;
  EXPECT_EQ(indices(R"(tab\x09here)"), Indices{0});
  EXPECT_EQ(indices(escaped(nodes[0].path)), Indices{0});
  EXPECT_EQ(indices(R"(top/tab\x09*)"), Indices{0});
  EXPECT_EQ(indices(R"({tab\x09here,b})"), (Indices{0, 1}));
  EXPECT_EQ(indices("tab\there"), Indices{0});
  EXPECT_EQ(indices(R"(c\x09d)"), Indices{2});
  EXPECT_EQ(indices("c\td"), Indices{3});
  EXPECT_EQ(indices(R"(tab\x9here)"), Indices{});
}

TEST(NodeNames, EscapesAreUndone) {
  using command::meanings_of;
  using command::unescaped;
  EXPECT_EQ(unescaped(R"(a\x09b\xc3\xa4)"), "a\tb\xc3\xa4");
  for (const std::string plain : {"", "\\", "\\x", "\\x0", "\\xg0", "\\x0g", "\\x+1", "a\\n"}) {
    EXPECT_EQ(unescaped(plain), plain);
  }
  EXPECT_EQ(meanings_of("a"), std::vector<std::string>{"a"});
  EXPECT_EQ(meanings_of(R"(a\x09[1])"),
            (std::vector<std::string>{R"(a\x09[1])", R"(a\x09)", "a\t[1]", "a\t"}));
}

TEST(NodeNames, NumberSiblingsOfOneName) {
  EXPECT_EQ(chosen({"Bolt[2]"}), "Gearbox/Lid/Bolt[2]");
  EXPECT_EQ(chosen({"Lid/Bolt[3]"}), "Gearbox/Lid/Bolt[3]");
  EXPECT_EQ(chosen({"Half"}), "Gearbox/Clip/Half");
}

// A name may be the label that another one has.
TEST(NodeNames, AreNumberedByTheFirstNumberThatIsFree) {
  const char* const names[] = {"a", "a[2]", "a", "a", "a[2]", "a[3]", "a[2][2]", "a"};
  const char* const labels[] = {"a",       "a[2]",    "a[3]",       "a[4]",
                                "a[2][2]", "a[3][2]", "a[2][2][2]", "a[5]"};
  mesh::UsedLabels used;
  for (std::size_t i = 0; i < std::size(names); ++i) {
    EXPECT_EQ(mesh::name_node(names[i], nullptr, used).label, labels[i]) << i;
  }
  // Each number up to the last was tried for each node once: 5 * 10^9 for these.
  for (int n = 0; n < 100'000; ++n) mesh::name_node("bolt", nullptr, used);
  EXPECT_EQ(mesh::name_node("bolt", nullptr, used).label, "bolt[100001]");
}

TEST(NodeNames, HaveWildcardsWithinALabel) {
  EXPECT_EQ(chosen({"Bolt*"}), "Gearbox/Lid/Bolt Gearbox/Lid/Bolt[2] Gearbox/Lid/Bolt[3]");
  EXPECT_EQ(chosen({"Bolt[?]"}), "Gearbox/Lid/Bolt[2] Gearbox/Lid/Bolt[3]");
  EXPECT_EQ(chosen({"C*"}), "Gearbox/Lid/Cover Gearbox/Clip Gearbox/Cover");
  EXPECT_EQ(chosen({"Gearbox/*/Cover"}), "Gearbox/Lid/Cover");
  EXPECT_EQ(chosen({"*"}), "Gearbox");
  EXPECT_EQ(chosen({"Cl??"}), "Gearbox/Clip");
}

TEST(NodeNames, MayBeLists) {
  EXPECT_EQ(chosen({"{Lid/Cover,Half*}"}),
            "Gearbox/Lid/Cover Gearbox/Clip/Half Gearbox/Clip/Half[2]");
  EXPECT_EQ(chosen({"Clip", "Lid"}), "Gearbox/Lid Gearbox/Clip");
  EXPECT_EQ(chosen({"{Clip}"}), "Gearbox/Clip");
}

TEST(NodeNames, OfDesignersMayHoldWhatElseHasAMeaning) {
  EXPECT_EQ(chosen({"M6 1/2*"}), "Gearbox/Cover/M6 1/2*");
  EXPECT_EQ(chosen({"{Clip,Lid}"}), "Gearbox/Cover/{Clip,Lid}");
  EXPECT_EQ(chosen({"Cover/{Clip,Lid}"}), "Gearbox/Cover/{Clip,Lid}");
  EXPECT_EQ(mesh::names_in("{}"), std::vector<std::string>{"{}"});
  EXPECT_EQ(mesh::names_in("a,b"), std::vector<std::string>{"a,b"});
}

// Each name that is left out is known by itself, or as one of a list, or as a part of a manifest.
TEST(NodeNames, OfListsAreLeftOut) {
  mesh::Assembly assembly;
  assembly.nodes = gearbox();
  for (const auto& [without, left_out] :
       {std::pair<std::string, std::vector<std::string>>{"{Clip,Lid}", {"{Clip,Lid}"}},
        {"{Clip,Bolt*}", {"Clip", "Bolt*"}},
        {"{Clip,Bold}", {"Clip"}}}) {
    mesh::SourceFile file{"", "", {}};
    file.options.without = {without};
    const mesh::NodesToRead to_read = mesh::nodes_to_read(file, assembly.nodes);
    EXPECT_EQ(to_read.left_out, left_out);
    assembly.left_out = left_out;
    const bool all_known = without != "{Clip,Bold}";
    EXPECT_EQ(bool(mesh::check_left_out(file.options.without, std::span(&assembly, 1))), all_known);
    EXPECT_TRUE(mesh::check_left_out(file.options.without, std::span(&assembly, 1), {"Bold", "x"}));
  }
}

// A file of two equal carriages, with two wheels each, and a rail.
std::vector<AssemblyNode> train() {
  std::vector<AssemblyNode> nodes;
  mesh::UsedLabels roots;
  for (const char* const name : {"Carriage", "Carriage"}) {
    const AssemblyNode carriage = mesh::name_node(name, nullptr, roots);
    nodes.push_back(carriage);
    mesh::UsedLabels wheels;
    for (int n = 0; n < 2; ++n) nodes.push_back(mesh::name_node("Wheel", &carriage, wheels));
  }
  nodes.push_back(mesh::name_node("Rail", nullptr, roots));
  return nodes;
}

// The nodes of the train that are read, or the error.
std::string read_of_train(std::vector<std::string> names, std::vector<std::string> without) {
  const std::vector<AssemblyNode> nodes = train();
  mesh::SourceFile file{"", "", {}};
  file.options.nodes = std::move(names);
  file.options.without = std::move(without);
  try {
    const mesh::NodesToRead to_read = mesh::nodes_to_read(file, nodes);
    std::string text;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (to_read.is_read[i]) text += (text.empty() ? "" : " ") + nodes[i].path;
    }
    return text;
  } catch (const mesh::ReadFailure& failure) {
    return to_line(failure.error);
  }
}

// A user who does not know that there are two would keep, or leave out, one alone.
TEST(NodeNames, OfOneOfSeveralSiblingsAreRefused) {
  const std::string doubt = ": several siblings have this name: ";
  EXPECT_EQ(read_of_train({"Carriage"}, {}),
            "#Carriage" + doubt +
                "Carriage[1], Carriage[2]; write Carriage[1] for only the first node, or " +
                "Carriage* for all nodes that match this pattern");
  EXPECT_EQ(read_of_train({}, {"Carriage"}),
            "--without Carriage" + doubt +
                "Carriage[1], Carriage[2]; write Carriage[1] for only the first node, or Carriage* "
                "for all nodes that match this pattern");
  EXPECT_EQ(read_of_train({"Rail"}, {"Carriage"}), "Rail") << "the other one is not read anyway";
  EXPECT_EQ(read_of_train({"{Carriage,Carriage[2]}"}, {"Wheel*"}), "Carriage Carriage[2]");
  EXPECT_EQ(read_of_train({"Carriage", "Carriage[2]"}, {"Wheel*"}), "Carriage Carriage[2]");
  EXPECT_EQ(read_of_train({}, {"Carriage", "Carriage[2]"}), "Rail");
  EXPECT_EQ(read_of_train({"Carriage"}, {"Carriage[2]", "Wheel*"}), "Carriage");
  EXPECT_EQ(read_of_train({"Carriage*"}, {"Wheel*"}), "Carriage Carriage[2]");
  // The first alone.
  EXPECT_EQ(read_of_train({"Carriage[1]"}, {}), "Carriage Carriage/Wheel Carriage/Wheel[2]");
  EXPECT_EQ(read_of_train({}, {"Carriage[1]"}),
            "Carriage[2] Carriage[2]/Wheel Carriage[2]/Wheel[2] Rail");
  EXPECT_EQ(read_of_train({"Carriage[1]/Wheel[1]"}, {}), "Carriage/Wheel");
  EXPECT_EQ(read_of_train({"Carriage[2]/Wheel[1]"}, {}), "Carriage[2]/Wheel");
  EXPECT_EQ(read_of_train({"Carriage[1]/Wheel[2]"}, {}), "Carriage/Wheel[2]");
  EXPECT_EQ(read_of_train({"Rail[1]"}, {}), "Rail");
  EXPECT_EQ(read_of_train({"Carriage[1]"}, {"Wheel[1]"}),
            "--without Wheel[1]: several nodes have this name; use one of: "
            "Carriage[1]/Wheel[1], Carriage[2]/Wheel[1]");
  // A name may go through one of several.
  EXPECT_EQ(read_of_train({"Carriage/Wheel[2]"}, {}),
            "#Carriage/Wheel[2]" + doubt + "Carriage[1]/Wheel[2], Carriage[2]/Wheel[2]; write " +
                "Carriage[1]/Wheel[2] for only the first node, or Carriage*/Wheel[2] for all nodes "
                "that match this pattern");
  EXPECT_EQ(read_of_train({"Carriage/Wheel"}, {}),
            "#Carriage/Wheel" + doubt +
                "Carriage[1]/Wheel[1], Carriage[1]/Wheel[2], Carriage[2]/Wheel[1], "
                "Carriage[2]/Wheel[2]; " +
                "write Carriage[1]/Wheel[1] for only the first node, or Carriage*/Wheel* for all "
                "nodes that match this pattern");
  EXPECT_EQ(read_of_train({"Carriage[2]/Wheel"}, {}),
            "#Carriage[2]/Wheel" + doubt + "Carriage[2]/Wheel[1], Carriage[2]/Wheel[2]; write " +
                "Carriage[2]/Wheel[1] for only the first node, or Carriage[2]/Wheel* for all nodes "
                "that match this pattern");
  // A wildcard stands for siblings where it is written, and nowhere else.
  EXPECT_EQ(read_of_train({}, {"*/Wheel"}),
            "--without */Wheel" + doubt +
                "Carriage[1]/Wheel[1], Carriage[1]/Wheel[2]; write */Wheel[1] " +
                "for only the first node, or */Wheel* for all nodes that match this pattern");
  EXPECT_EQ(read_of_train({"Carriage/Wh*"}, {}),
            "#Carriage/Wh*" + doubt +
                "Carriage[1]/Wheel[1], Carriage[2]/Wheel[1]; write Carriage[1]/Wh* for only the "
                "first node, or " +
                "Carriage*/Wh* for all nodes that match this pattern");
  EXPECT_EQ(read_of_train({"*/Wheel[1]"}, {}), "Carriage/Wheel Carriage[2]/Wheel");
  EXPECT_EQ(read_of_train({"{*/Wheel,*/Wheel[2]}"}, {}),
            "Carriage/Wheel Carriage/Wheel[2] Carriage[2]/Wheel Carriage[2]/Wheel[2]");
  EXPECT_EQ(read_of_train({"Carriage[1]/Wh*"}, {}), "Carriage/Wheel Carriage/Wheel[2]");
  EXPECT_EQ(read_of_train({"*/Wheel[2]"}, {}), "Carriage/Wheel[2] Carriage[2]/Wheel[2]");
  EXPECT_TRUE(read_of_train({"*[1]"}, {}).starts_with("#*[1]: no node has this name"));
}

// Whatever its siblings and those of its parents are called.
TEST(NodeNames, OfAListingMeanOneNode) {
  const std::vector<AssemblyNode> nodes = train();
  const std::vector<std::string> names = mesh::numbered_paths(nodes);
  EXPECT_EQ(names, (std::vector<std::string>{
                       "Carriage[1]", "Carriage[1]/Wheel[1]", "Carriage[1]/Wheel[2]", "Carriage[2]",
                       "Carriage[2]/Wheel[1]", "Carriage[2]/Wheel[2]", "Rail"}));
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    EXPECT_TRUE((read_of_train({names[i]}, {}) + " ").starts_with(nodes[i].path + " ")) << names[i];
  }
}

// A label may hold a slash, and two nodes one path.
TEST(NodeNames, OfTwoNodesWithOnePathAreRefused) {
  mesh::UsedLabels roots, leaves;
  std::vector<AssemblyNode> nodes{mesh::name_node("a/b", nullptr, roots)};
  nodes.push_back(mesh::name_node("a", nullptr, roots));
  const AssemblyNode parent = nodes.back();
  nodes.push_back(mesh::name_node("b", &parent, leaves));
  const std::vector<std::string> names{"a/b"};
  const auto chosen = mesh::choose_nodes(names, nodes);
  ASSERT_FALSE(chosen);
  EXPECT_EQ(
      to_line(chosen.error()),
      "#a/b: several nodes have this name; all have the path a/b, because one node's own name "
      "contains a slash: rename that node");
}

TEST(NodeNames, ThatFitNothingOrSeveralSayWhatWould) {
  EXPECT_EQ(chosen({"Cover"}),
            "#Cover: several nodes have this name; use one of: Gearbox/Lid/Cover, Gearbox/Cover");
  const std::string missing = chosen({"Bold"});
  EXPECT_TRUE(missing.starts_with(
      "#Bold: no node has this name; the nearest names are: Gearbox/Lid/Bolt, "))
      << missing;
  EXPECT_TRUE(chosen({"{Clip,Bolt[4]}"}).starts_with("#Bolt[4]: no node has this name"));
  EXPECT_TRUE(chosen({"Screw*"}).starts_with("#Screw*: no node has this name"));
}

// Against all ways to let a star take letters.
bool slow_match(std::string_view text, std::string_view pattern) {
  if (pattern.empty()) return text.empty();
  if (pattern[0] == '*') {
    for (std::size_t taken = 0;; ++taken) {
      if (slow_match(text.substr(taken), pattern.substr(1))) return true;
      if (taken == text.size() || text[taken] == '/') return false;
    }
  }
  if (text.empty()) return false;
  const bool same = text[0] == pattern[0] || (pattern[0] == '?' && text[0] != '/');
  return same && slow_match(text.substr(1), pattern.substr(1));
}

TEST(NodeNames, MatchAsTheDefinitionDoes) {
  std::mt19937 random(25);
  const auto word = [&](std::string_view letters) {
    std::string text;
    for (unsigned n = random() % 7; n > 0; --n) text += letters[random() % letters.size()];
    return text;
  };
  int matched = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const std::string path = word("ab/"), pattern = word("ab/*?");
    bool expected = false;
    for (std::size_t start = 0; start <= path.size(); ++start) {
      if (start > 0 && path[start - 1] != '/') continue;
      expected = expected || slow_match(std::string_view(path).substr(start), pattern);
    }
    EXPECT_EQ(mesh::fits_name(path, pattern), expected) << path << " " << pattern;
    matched += expected;
  }
  EXPECT_GT(matched, 1000);
}

TEST(NodeNames, GiveEachNodeTheInstancesBelowIt) {
  auto nodes = gearbox();
  const std::vector<std::size_t> nodes_of_instances = {2, 3, 4, 4, 7, 8, 9};
  mesh::set_instances(nodes_of_instances, nodes);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    std::uint32_t first = 0, count = 0;
    for (const std::size_t node : nodes_of_instances) {
      const bool is_below = node == i || nodes[node].path.starts_with(nodes[i].path + "/");
      count += is_below;
      first += node < i;
    }
    EXPECT_EQ(nodes[i].instance_count, count) << nodes[i].path;
    EXPECT_EQ(nodes[i].first_instance, first) << nodes[i].path;
  }
}

TEST(NodeTreeLimit, TakesWhatTheSizeOfTheFilesJustifies) {
  mesh::NodeTreeLimit limit;
  limit.allow_for(10);
  const std::uint64_t allowed = mesh::NodeTreeLimit::kAlways + 10 * mesh::NodeTreeLimit::kPerByte;
  const auto of_bytes = [](std::uint64_t bytes) {
    return mesh::AssemblyNode{"n", std::string(bytes - mesh::NodeTreeLimit::kOfNode, 'n'), 1};
  };
  EXPECT_EQ(limit.add(of_bytes(allowed - 1000)), "");
  EXPECT_NE(limit.add(of_bytes(1001)), "");
  EXPECT_EQ(limit.add(of_bytes(1000)), "");
  EXPECT_NE(limit.add(of_bytes(500)), "");
}

TEST(NodeTreeLimit, EndsAThousandLevelsDown) {
  mesh::NodeTreeLimit limit;
  EXPECT_EQ(limit.add({"n", "n", mesh::NodeTreeLimit::kDeepestNode}), "");
  EXPECT_EQ(limit.add({"n", "n", mesh::NodeTreeLimit::kDeepestNode + 1}),
            "is nested deeper than 1000 levels");
}

TEST(GroupedWarnings, AreOneLineForAllThatSayTheSame) {
  mesh::GroupedWarnings warnings("files");
  for (int n = 0; n < 66; ++n) warnings.add("part" + std::to_string(n) + ".stl", "is coarse");
  warnings.add("part0.stl", "is coarse");
  warnings.add("part0.stl", "is odd");
  warnings.add("part1.stl", "is odd");
  EXPECT_EQ(warnings.lines(), (std::vector<std::string>{"part0.stl and 65 other files: is coarse",
                                                        "part0.stl and 1 other file: is odd"}));
}

}  // namespace
}  // namespace forcelayer
