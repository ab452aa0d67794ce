// Rules of pairs, against a matcher that looks at every row for every pair, label by label.
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/random_numbers.h"
#include "tests/support/scratch_folder.h"
#include "workbench/pairs/near_boxes.h"
#include "workbench/pairs/rules/rules.h"

namespace forcelayer::pairs {
namespace {

using Labels = std::vector<std::string>;

Labels labels_of(const std::string& path) {
  Labels labels;
  std::istringstream text(path);
  for (std::string label; std::getline(text, label, '/');) labels.push_back(label);
  return labels;
}

bool glob(const char* pattern, const char* text) {
  if (*pattern == 0) return *text == 0;
  if (*pattern == '*') return glob(pattern + 1, text) || (*text != 0 && glob(pattern, text + 1));
  return *text != 0 && (*pattern == '?' || *pattern == *text) && glob(pattern + 1, text + 1);
}

bool has_wildcard(const std::string& text) { return text.find_first_of("*?") != std::string::npos; }

// Whether a label of a name is that of a node, as its path or as a listing writes it.
bool label_means(const std::string& wanted, const std::string& label, const std::string& listed) {
  if (glob(wanted.c_str(), label.c_str()) || glob(wanted.c_str(), listed.c_str())) return true;
  return !has_wildcard(wanted) && wanted == label + "[1]";
}

// Whether the last labels of a path, cut off below any node, are those of the name or of one in a
// list of names.
bool brute_means(const std::string& name, const PartName& part) {
  if (name.front() == '{') {
    std::istringstream list(name.substr(1, name.size() - 2));
    bool any = false;
    for (std::string one; std::getline(list, one, ',');) any = any || brute_means(one, part);
    return any;
  }
  const Labels wanted = labels_of(name), labels = labels_of(part.path),
               listed = labels_of(part.listed);
  for (std::size_t end = wanted.size(); end <= labels.size(); ++end) {
    bool all = true;
    for (std::size_t n = 0; n < wanted.size(); ++n) {
      const std::size_t at = end - wanted.size() + n;
      all = all && label_means(wanted[n], labels[at], listed[at]);
    }
    if (all) return true;
  }
  return false;
}

std::string random_label(test::Random& random) {
  const std::string names[] = {"Bolt", "Nut", "Lid", "Box", "Bo"};
  std::string label = names[test::integer(random, 0, 4)];
  const auto number = test::integer(random, 0, 3);
  return number < 2 ? label : label + "[" + std::to_string(number) + "]";
}

std::string random_path(test::Random& random) {
  std::string path = random_label(random);
  for (auto n = test::integer(random, 0, 2); n > 0; --n) path += "/" + random_label(random);
  return path;
}

// The path as a listing shows it: the first of some siblings has a number.
std::string random_listed(test::Random& random, const std::string& path) {
  std::string listed;
  for (const std::string& label : labels_of(path)) {
    const bool is_first = label.back() != ']' && test::integer(random, 0, 2) == 0;
    listed += (listed.empty() ? "" : "/") + label + (is_first ? "[1]" : "");
  }
  return listed;
}

// A name, with wildcards and numbers of first siblings in some places, or a list of names.
std::string random_name(test::Random& random) {
  std::string name = random_path(random);
  switch (test::integer(random, 0, 7)) {
    case 0:
      return "*";
    case 4:
      return "*[1]";
    case 5:
      return name.substr(0, static_cast<std::size_t>(test::integer(random, 1, 4))) + "*[1]";
    case 6:
      return random_listed(random, name);
    case 7:
      return "{" + name + "," + random_label(random) + "*}";
    case 1:
      name[static_cast<std::size_t>(
          test::integer(random, 0, static_cast<std::int64_t>(name.size()) - 1))] = '?';
      return name;
    case 2:
      return name.substr(0, static_cast<std::size_t>(test::integer(random, 1, 4))) + "*";
    default:
      return name;
  }
}

TEST(PairsRules, AreThoseOfABruteForceMatcherInRandomFiles) {
  int named = 0, unnamed = 0;
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    test::Random random(seed);
    test::ScratchFolder folder;
    std::vector<PartName> parts;
    for (int n = 0; n < 12; ++n) {
      const std::string path = random_path(random);
      parts.push_back({path, random_listed(random, path)});
    }
    std::ostringstream text;
    text << "part,object,clearance\n";
    std::vector<std::pair<std::string, std::string>> names;
    const auto count = test::integer(random, 1, 6);
    for (int n = 0; n < count; ++n) {
      names.emplace_back(random_name(random), random_name(random));
      text << '"' << names.back().first << "\",\"" << names.back().second << "\"," << n + 1
           << "mm\n";
    }
    const std::string file = folder / "rules.csv";
    std::ofstream(file) << text.str();
    const auto rules = read_rules(file);
    ASSERT_TRUE(rules) << to_line(rules.error()) << text.str();
    const RuleTable table(*rules, parts);
    for (std::size_t a = 0; a < parts.size(); ++a) {
      for (std::size_t b = a + 1; b < parts.size(); ++b) {
        std::size_t expected = 0;
        for (; expected < names.size(); ++expected) {
          const auto& [part, object] = names[expected];
          const PartName &p = parts[a], &q = parts[b];
          if (brute_means(part, p) && brute_means(object, q)) break;
          if (brute_means(part, q) && brute_means(object, p)) break;
        }
        EXPECT_EQ(table.first_rule(a, b), expected) << parts[a].path << " " << parts[b].path << "\n"
                                                    << text.str();
        EXPECT_EQ(table.first_rule(b, a), expected);
        (expected < names.size() ? named : unnamed) += 1;
      }
    }
  }
  EXPECT_GT(named, 5000);
  EXPECT_GT(unnamed, 5000);
}

// How much a requirement asks: nothing of what is ignored.
double strictness(const Requirement& requirement) {
  return requirement.kind == Requirement::Kind::kIgnore ? -1 : requirement.clearance_m;
}

// A part moves as one with all of its bodies: the strictest of their rules counts.
TEST(PartRules, AreTheStrictestOfABruteForceMatcherInRandomFiles) {
  int ignored = 0, touching = 0, apart = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    test::Random random(seed);
    test::ScratchFolder folder;
    const auto random_parts = [&](std::int64_t count) {
      std::vector<PartName> parts;
      for (std::int64_t n = 0; n < count; ++n) {
        const std::string path = random_path(random);
        parts.push_back({path, path});
      }
      return parts;
    };
    const std::vector<PartName> objects = random_parts(8);
    const std::vector<PartName> bodies = random_parts(test::integer(random, 1, 3));
    struct Row {
      std::string part, object;
      Requirement requirement;
    };
    std::vector<Row> rows;
    std::ostringstream text;
    text << "part,object,clearance\n";
    for (auto n = test::integer(random, 1, 6); n > 0; --n) {
      const std::string cells[] = {"touch", "ignore", std::to_string(n) + "mm"};
      const std::string& cell = cells[test::integer(random, 0, 2)];
      rows.push_back({random_name(random), random_name(random), *parse_requirement(cell)});
      text << '"' << rows.back().part << "\",\"" << rows.back().object << "\"," << cell << "\n";
    }
    const std::string file = folder / "rules.csv";
    std::ofstream(file) << text.str();
    const Requirement otherwise = *parse_requirement(seed % 2 == 0 ? "touch" : "2.5mm");
    const auto rules = read_part_rules(file, bodies, objects, otherwise);
    ASSERT_TRUE(rules) << to_line(rules.error()) << text.str();
    ASSERT_EQ(rules->of_object.size(), objects.size());
    for (std::size_t object = 0; object < objects.size(); ++object) {
      double expected = -1;
      for (const PartName& body : bodies) {
        Requirement own = otherwise;
        for (const Row& row : rows) {
          const bool names_both =
              (brute_means(row.part, body) && brute_means(row.object, objects[object])) ||
              (brute_means(row.part, objects[object]) && brute_means(row.object, body));
          if (!names_both) continue;
          own = row.requirement;
          break;
        }
        expected = std::max(expected, strictness(own));
      }
      EXPECT_EQ(strictness(rules->of_object[object]), expected) << objects[object].path << "\n"
                                                                << text.str();
      (expected < 0 ? ignored : expected == 0 ? touching : apart) += 1;
    }
  }
  EXPECT_GT(ignored, 50);
  EXPECT_GT(touching, 200);
  EXPECT_GT(apart, 200);
}

class RuleFile {
 public:
  explicit RuleFile(const std::string& text) : path_(folder_ / "rules.csv") {
    std::ofstream(path_, std::ios::binary) << text;
  }
  Result<std::vector<Rule>> read() const { return read_rules(path_); }
  // The error behind the file's name.
  std::string error() const {
    const auto rules = read();
    return rules ? "" : to_line(rules.error()).substr(path_.size() + 2);
  }

 private:
  test::ScratchFolder folder_;
  std::string path_;
};

TEST(PairsRules, AreReadAsSpreadsheetsWriteThem) {
  const std::string text =
      "\xef\xbb\xbf# of the gearbox\r\n"
      "note;clearance;part;object\r\n"
      "why;0,5mm;Pin;\"Lid/*\"\r\n";
  EXPECT_NE(RuleFile(text).error(), "");  // a decimal comma is no number of ours
  const auto rules = RuleFile(
                         "\xef\xbb\xbf\r\n# of the gearbox\r\nnote;clearance;part;object\r\n"
                         "why;0.5mm;Pin;\"Lid/*\"\r\n;;;\r\n;touch;*;*\r\n;ignore;A;B\r\n;0;C;D")
                         .read();
  ASSERT_TRUE(rules) << to_line(rules.error());
  ASSERT_EQ(rules->size(), 4u);
  EXPECT_EQ((*rules)[0].part, "Pin");
  EXPECT_EQ((*rules)[0].object, "Lid/*");
  EXPECT_EQ((*rules)[0].line, 4u);
  EXPECT_EQ((*rules)[0].requirement.clearance_m, 0.0005);
  EXPECT_EQ((*rules)[1].requirement.kind, Requirement::Kind::kTouch);
  EXPECT_EQ((*rules)[2].requirement.kind, Requirement::Kind::kIgnore);
  EXPECT_EQ((*rules)[3].requirement.kind, Requirement::Kind::kTouch);
}

TEST(PairsRules, AreRefusedWithLineAndMend) {
  const std::string columns =
      "; the first line names the columns part,object,clearance, and each row has a cell for each";
  const std::string clearances = "; write a length such as 1mm, touch or ignore";
  const std::string header = "part,object,clearance\n";
  EXPECT_EQ(RuleFile("").error(), "line 1: the header is missing" + columns);
  EXPECT_EQ(RuleFile("part,clearance\n").error(), "line 1: the column object is missing" + columns);
  EXPECT_EQ(RuleFile(header).error(), "line 2: the file has no rules" + columns);
  EXPECT_EQ(RuleFile(header + "A,B\n").error(),
            "line 2: has 2 cells, but the header has 3" + columns);
  EXPECT_EQ(RuleFile(header + "A,,1mm\n").error(),
            "line 2: the object is empty; * means every part" + columns);
  EXPECT_EQ(RuleFile(header + "A,B,1mm\nA,B,1\n").error(),
            "line 3: the clearance '1' is not a length with a unit" + clearances);
  EXPECT_EQ(RuleFile(header + "A,B,1furlong\n").error(),
            "line 2: the clearance '1furlong' is not a length with a unit" + clearances);
  EXPECT_EQ(RuleFile(header + "A,B,-1mm\n").error(),
            "line 2: the clearance '-1mm' must not be negative" + clearances);
  EXPECT_EQ(RuleFile(std::string("PK\3\4\0\0", 6)).error(), "line 1: is not text" + columns);
  // Behind the header a row is no comment, whatever it begins with.
  EXPECT_EQ(RuleFile("# rules\n" + header + "# bolts\nA,B,1mm\n").error(),
            "line 3: has 1 cells, but the header has 3" + columns);
  const auto screw = RuleFile(header + "#10 screw,Housing,1mm\n").read();
  ASSERT_TRUE(screw);
  EXPECT_EQ((*screw)[0].part, "#10 screw");
  const auto missing = read_rules("no/such/rules.csv");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::kFileNotFound);
}

// A file that is there and cannot be opened, for any user: a socket.
TEST(PairsRules, AFileThatCannotBeReadHasNoLines) {
  test::ScratchFolder folder;
  const std::string path = folder / "s";
  const int made = socket(AF_UNIX, SOCK_STREAM, 0);
  ASSERT_GE(made, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  ASSERT_LT(path.size(), sizeof address.sun_path);
  path.copy(address.sun_path, path.size());
  ASSERT_EQ(bind(made, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  const auto read = read_rules(path);
  close(made);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::kReadFailed);
}

// Siblings with one name: the first has no number in its path, but has one in listings.
const std::vector<PartName> kSiblings = {
    {"Lid/Bolt", "Lid/Bolt[1]"}, {"Lid/Bolt[2]", "Lid/Bolt[2]"}, {"Box", "Box"}};

TEST(PairsRules, WarnOfRowsThatDecideNothing) {
  const auto rules = RuleFile(
                         "part,object,clearance\nLid/Bolt[1],Box,1mm\nBolts,Box,touch\n"
                         "Lid,Box,3mm\nBox,Bolt?2?,ignore\n*,*,touch\n")
                         .read();
  ASSERT_TRUE(rules);
  EXPECT_TRUE(check_siblings(*rules, kSiblings, "rules.csv"));
  const RuleTable table(*rules, kSiblings);
  EXPECT_EQ(table.first_rule(0, 2), 0u);
  EXPECT_EQ(table.first_rule(2, 1), 2u);
  EXPECT_EQ(table.first_rule(0, 1), 4u);
  EXPECT_EQ(table.warnings("rules.csv"),
            (std::vector<std::string>{
                "rules.csv: line 3: no part has the name 'Bolts'; the nearest names are: "
                "Box, Lid/Bolt[1], Lid/Bolt[2]",
                "rules.csv: line 5: the row decides about no pair, because earlier rows name all "
                "pairs that it names"}));
}

TEST(PairsRules, RefuseANameOfSeveralSiblings) {
  const auto refused = [](const std::string& row) {
    const auto rules = RuleFile("part,object,clearance\n" + row + ",1mm\n").read();
    const Status status = check_siblings(*rules, kSiblings, "r.csv");
    return status ? "" : to_line(status.error());
  };
  EXPECT_EQ(refused("Box,Bolt"),
            "r.csv: line 2: several siblings have the name 'Bolt', such as Lid/Bolt[1]; write "
            "Bolt[1] for only the first, or Bolt* for all");
  EXPECT_NE(refused("Lid/Bolt,Box"), "");
  EXPECT_EQ(refused("*/Bolt,Box"),
            "r.csv: line 2: several siblings have the name '*/Bolt', such as Lid/Bolt[1]; write "
            "*/Bolt[1] for only the first, or */Bolt* for all");
  EXPECT_NE(refused("\"{Box,Bolt}\",Box"), "");
  EXPECT_EQ(refused("\"{Box,Bolt*}\",Box"), "");
  EXPECT_EQ(refused("*/Bolt[1],Box"), "");
  for (const char* const row : {"Box,Bolt[1]", "Box,Bolt[2]", "Box,Bolt*", "Box,Lid", "Box,*"}) {
    EXPECT_EQ(refused(row), "") << row;
  }
}

TEST(PairsRules, NumbersBesideWildcardsMeanFirstSiblings) {
  const auto meant = [](const std::string& name) {
    std::string parts;
    for (const PartName& part : kSiblings) parts += means(name, part) ? part.listed + " " : "";
    return parts;
  };
  EXPECT_EQ(meant("*[1]"), "Lid/Bolt[1] ");
  EXPECT_EQ(meant("Bolt*[1]"), "Lid/Bolt[1] ");
  EXPECT_EQ(meant("L*/Bolt[1]"), "Lid/Bolt[1] ");
  EXPECT_EQ(meant("Bolt*"), "Lid/Bolt[1] Lid/Bolt[2] ");
  EXPECT_EQ(meant("{Box,Bolt[2]}"), "Lid/Bolt[2] Box ");
}

// One name of a list may be wrong.
TEST(PairsRules, WarnOfEachNameOfAList) {
  const auto rules = RuleFile("part,object,clearance\n\"{Bolt*,Nut}\",Box,1mm\n").read();
  ASSERT_TRUE(rules);
  EXPECT_EQ(RuleTable(*rules, kSiblings).warnings("r"),
            (std::vector<std::string>{"r: line 2: no part has the name 'Nut'; the nearest names "
                                      "are: Box, Lid/Bolt[1], Lid/Bolt[2]"}));
}

TEST(PairsRules, OnePartAloneIsNoPair) {
  const std::vector<PartName> parts = {{"A", "A"}, {"B", "B"}};
  const auto rules = RuleFile("part,object,clearance\nA,A,1mm\n").read();
  ASSERT_TRUE(rules);
  EXPECT_EQ(RuleTable(*rules, parts).warnings("r"),
            std::vector<std::string>{"r: line 2: the row decides about no pair, because both names "
                                     "mean only one part, A"});
}

// The broad phase against all pairs.
TEST(PairsNearBoxes, AreAllThatAreNear) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    test::Random random(seed);
    std::vector<mesh::Box> boxes;
    const auto count = test::integer(random, 0, 60);
    for (int n = 0; n < count; ++n) {
      mesh::Box box;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        // On a lattice, so that some boxes are exactly as far apart as is asked.
        box.low[axis] = static_cast<double>(test::integer(random, 0, 40));
        box.high[axis] = box.low[axis] + static_cast<double>(test::integer(random, 0, 12));
      }
      boxes.push_back(box);
    }
    const auto odd = [](const Pair& pair) { return (pair.first + pair.second) % 3 != 0; };
    std::vector<Pair> found = near_boxes(boxes, 2, odd), expected;
    std::sort(found.begin(), found.end());
    for (std::uint32_t a = 0; a < boxes.size(); ++a) {
      for (std::uint32_t b = a + 1; b < boxes.size(); ++b) {
        double squared = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const double gap = std::max(boxes[a].low[axis], boxes[b].low[axis]) -
                             std::min(boxes[a].high[axis], boxes[b].high[axis]);
          if (gap > 0) squared += gap * gap;
        }
        if (squared <= 4 && odd({a, b})) expected.push_back({a, b});
      }
    }
    EXPECT_EQ(found, expected);
  }
}

}  // namespace
}  // namespace forcelayer::pairs
