// The rules of an assembly: which distance each pair of its parts must keep.
//
// A file of rules is a table with the columns part, object and clearance. The first row that names
// both parts of a pair, in either order, decides about that pair. A row names a part by its name or
// the end of its name, as in FILE#NODE; `*` and `?` stand for letters other than "/", and
// "{Cover,Bolt*}" is a list of names. The name of a node means all parts below it, too. Comments,
// behind "#", stand before the header.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/mesh/scene.h"
#include "formats/result.h"
#include "workbench/pairs/rules/requirement.h"

namespace forcelayer::pairs {

struct Rule {
  std::string part, object;
  Requirement requirement;
  std::size_t line = 0;  // of the file
};

// Reads a file of rules. Errors: kFileNotFound, kReadFailed; kUsage with the line of a wrong row.
Result<std::vector<Rule>> read_rules(const std::string& path);

// A part's name: the path of its node, and the same as `voxelize --list` prints it, where the first
// of several siblings with one name has a number, too.
struct PartName {
  std::string path, listed;
};

// [objects] Their names.
std::vector<PartName> part_names(const mesh::Scene& scene);

// Whether a name in a rule means this part.
bool means(const std::string& name, const PartName& part);

// An error where a label of a name has no number and no wildcard and means the first of several
// siblings alone: its writer may know all of them by one name. Errors: kUsage, with the line of
// `path`.
Status check_siblings(std::span<const Rule> rules, std::span<const PartName> parts,
                      const std::string& path);

// The rule of each pair of some parts. Parts that the same rows name are of one class, so that the
// table is small.
class RuleTable {
 public:
  RuleTable(std::span<const Rule> rules, std::span<const PartName> parts);

  // The number of the first rule that names both parts; the count of rules where none does.
  std::size_t first_rule(std::size_t part, std::size_t other) const {
    return first_[class_of_[part] * classes_ + class_of_[other]];
  }

  // Warnings, a line each, about rows that decide about no pair.
  std::vector<std::string> warnings(const std::string& path) const;

 private:
  std::string warning_of(std::size_t rule) const;

  std::span<const Rule> rules_;
  std::span<const PartName> parts_;
  std::size_t classes_ = 0;
  std::vector<std::uint32_t> class_of_;  // [parts]
  std::vector<std::size_t> first_;       // [classes][classes]
  std::vector<bool> decides_;            // [rules] about a pair
};

// The requirements for a part that moves among the objects of a scene.
struct PartRules {
  std::vector<Requirement> of_object;  // [objects]
  std::vector<std::string> warnings;   // those of RuleTable
};
// Reads the rules at `path`. `part`: one body, or several that move as one, of which the strictest
// requirement counts: a larger clearance before a smaller one, that before touch, and ignore last.
// `otherwise` counts where no rule names a pair. Errors: those of read_rules() and
// check_siblings().
Result<PartRules> read_part_rules(const std::string& path, std::span<const PartName> part,
                                  std::span<const PartName> objects, const Requirement& otherwise);

}  // namespace forcelayer::pairs
