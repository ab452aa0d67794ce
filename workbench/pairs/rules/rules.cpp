#include "workbench/pairs/rules/rules.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "formats/command/spelling/spelling.h"
#include "formats/mesh/node_names.h"
#include "formats/path/path_columns.h"

namespace forcelayer::pairs {
namespace {

constexpr const char* kMend =
    "the first line names the columns part,object,clearance, and each row has a cell for each";
constexpr std::array<std::string_view, 3> kColumns = {"part", "object", "clearance"};
constexpr std::size_t kMaxLine = 65536;  // bytes

std::vector<std::string_view> cells_of(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  while (line.data() != nullptr) cells.push_back(take_cell(line, separator));
  return cells;
}

// The separator of a header: spreadsheets write semicolons or tabs in some countries.
char separator_of(std::string_view header) {
  for (const char separator : {';', '\t'}) {
    if (header.find(separator) != std::string_view::npos) return separator;
  }
  return ',';
}

bool is_blank(std::string_view line) {
  return line.find_first_not_of(" \t,;") == std::string_view::npos;
}

bool is_comment(std::string_view line) {
  const std::size_t first = line.find_first_not_of(" \t,;");
  return first != std::string_view::npos && line[first] == '#';
}

// Reads a file of rules line by line.
class RuleReader {
 public:
  // The mistake of a line; empty: it has none.
  std::string read(std::string_view line, std::size_t number) {
    // Comments stand before the header alone: behind it a part may be called "#10 screw".
    if (is_blank(line) || (!has_header() && is_comment(line))) return "";
    return !has_header() ? read_header(line) : read_row(line, number);
  }

  bool has_header() const { return !cell_of_.empty(); }
  const std::string& mend() const { return mend_; }  // of the mistake
  std::vector<Rule> take() { return std::move(rules_); }

 private:
  std::string read_header(std::string_view line) {
    separator_ = separator_of(line);
    const auto cells = cells_of(line, separator_);
    count_ = cells.size();
    for (const std::string_view column : kColumns) {
      const auto at = std::find(cells.begin(), cells.end(), column);
      if (at == cells.end()) return "the column " + std::string(column) + " is missing";
      cell_of_.push_back(static_cast<std::size_t>(at - cells.begin()));
    }
    return "";
  }

  std::string read_row(std::string_view line, std::size_t number) {
    const auto cells = cells_of(line, separator_);
    if (cells.size() != count_) {
      return "has " + std::to_string(cells.size()) + " cells, but the header has " +
             std::to_string(count_);
    }
    Rule rule;
    rule.part = cells[cell_of_[0]], rule.object = cells[cell_of_[1]], rule.line = number;
    for (const auto& [name, column] :
         {std::pair(&rule.part, kColumns[0]), std::pair(&rule.object, kColumns[1])}) {
      if (name->empty()) return "the " + std::string(column) + " is empty; * means every part";
    }
    const auto requirement = parse_requirement(std::string(cells[cell_of_[2]]));
    if (!requirement) {
      mend_ = requirement.error().mend;
      return "the clearance " + requirement.error().what;
    }
    rule.requirement = *requirement;
    rules_.push_back(std::move(rule));
    return "";
  }

  std::string mend_ = kMend;
  char separator_ = ',';
  std::size_t count_ = 0;             // of cells in a line
  std::vector<std::size_t> cell_of_;  // [kColumns]
  std::vector<Rule> rules_;
};

using Labels = std::vector<std::string>;

Labels labels_of(const std::string& path) {
  Labels labels;
  for (std::size_t start = 0; start <= path.size();) {
    const std::size_t end = std::min(path.find('/', start), path.size());
    labels.push_back(path.substr(start, end - start));
    start = end + 1;
  }
  return labels;
}

std::string joined(const Labels& labels) {
  std::string path = labels.front();
  for (std::size_t n = 1; n < labels.size(); ++n) path += "/" + labels[n];
  return path;
}

bool has_wildcard(const std::string& name) { return name.find_first_of("*?") != std::string::npos; }

// The names that a name in a rule may mean: those of a list, as typed and as a listing shows them.
std::vector<std::string> names_of(const std::string& name) {
  std::vector<std::string> names = mesh::names_in(name);
  for (std::size_t n = 0, count = names.size(); n < count; ++n) {
    const std::string shown = command::unescaped(names[n]);
    if (shown != names[n]) names.push_back(shown);
  }
  return names;
}

// How a name, which is no list, may mean a part: it fits the path of the part's node, or of a node
// above it, label by label, as the path or a listing writes each.
class Meaning {
 public:
  Meaning(const std::string& name, const PartName& part)
      : named_(labels_of(name)), labels_(labels_of(part.path)), listed_(labels_of(part.listed)) {
    listed_.resize(labels_.size());  // a listing only adds numbers to labels
  }

  bool fits() const {
    for (std::size_t end = named_.size(); end <= labels_.size(); ++end) {
      if (fits_to(end)) return true;
    }
    return false;
  }

  // Where the name fits because the first of several siblings may be written without its number:
  // the name with `ending` behind each label that is such a one. None where a number or a wildcard
  // at each label says which siblings it means.
  std::optional<std::string> with_ending(const char* ending) const {
    for (std::size_t end = named_.size(); end <= labels_.size(); ++end) {
      if (!fits_to(end)) continue;
      Labels ended = named_;
      for (std::size_t n = 0; n < named_.size(); ++n) {
        const std::size_t at = end - named_.size() + n;
        const bool is_first = labels_[at] != listed_[at] && named_[n] == labels_[at];
        if (is_first && !has_wildcard(named_[n])) ended[n] += ending;
      }
      if (ended != named_) return joined(ended);
    }
    return std::nullopt;
  }

 private:
  // Whether the labels of the name are the last of the first `end` labels.
  bool fits_to(std::size_t end) const {
    for (std::size_t n = 0; n < named_.size(); ++n) {
      const std::size_t at = end - named_.size() + n;
      if (!label_fits(named_[n], at)) return false;
    }
    return true;
  }
  // Beside a wildcard "[1]" stands as written: "*[1]" means first siblings, and not every part.
  bool label_fits(const std::string& name, std::size_t at) const {
    if (mesh::fits_name(labels_[at], name) || mesh::fits_name(listed_[at], name)) return true;
    return labels_[at] == command::without_first_numbers(name);
  }

  Labels named_, labels_, listed_;
};

// The names of an assembly's nodes in a listing, by their paths.
using ListedNames = std::map<std::string, std::string>;

ListedNames listed_names(const mesh::Assembly& assembly) {
  const std::vector<std::string> numbered = mesh::numbered_paths(assembly.nodes);
  ListedNames names;
  for (std::size_t n = 0; n < numbered.size(); ++n) names[assembly.nodes[n].path] = numbered[n];
  return names;
}

// An object of a manifest has the manifest's name before the path of its node.
std::string listed_name(const std::string& path, const ListedNames& names) {
  for (std::size_t start = 0;;) {
    const auto found = names.find(path.substr(start));
    if (found != names.end()) return path.substr(0, start) + found->second;
    const std::size_t slash = path.find('/', start);
    if (slash == std::string::npos) return path;
    start = slash + 1;
  }
}

bool means_one(const std::string& name, const PartName& part) { return Meaning(name, part).fits(); }

}  // namespace

Result<std::vector<Rule>> read_rules(const std::string& path) {
  std::error_code failure;
  if (!std::filesystem::exists(path, failure) || std::filesystem::is_directory(path, failure)) {
    return Error{ErrorCode::kFileNotFound, path, "", "no such file", kMend};
  }
  const Error unreadable{ErrorCode::kReadFailed, path, "", "cannot be read", ""};
  std::ifstream file(path, std::ios::binary);
  if (!file.is_open()) return unreadable;
  RuleReader reader;
  std::string line;
  std::size_t number = 0;
  const auto wrong = [&](const std::string& what, const std::string& mend) {
    return Error{ErrorCode::kUsage, path, "line " + std::to_string(number), what, mend};
  };
  while (std::getline(file, line)) {
    ++number;
    std::string_view text = line;
    if (number == 1 && text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
    if (text.ends_with('\r')) text.remove_suffix(1);
    if (text.size() > kMaxLine || text.find('\0') != std::string_view::npos) {
      return wrong("is not text", kMend);
    }
    const std::string mistake = reader.read(text, number);
    if (!mistake.empty()) return wrong(mistake, reader.mend());
  }
  if (file.bad()) return unreadable;
  ++number;
  if (!reader.has_header()) return wrong("the header is missing", kMend);
  std::vector<Rule> rules = reader.take();
  if (rules.empty()) return wrong("the file has no rules", kMend);
  return rules;
}

std::vector<PartName> part_names(const mesh::Scene& scene) {
  std::vector<ListedNames> listed;
  for (const mesh::Assembly& one : scene.assemblies) listed.push_back(listed_names(one));
  std::vector<PartName> names;
  for (const mesh::MeshObject& object : scene.objects) {
    names.push_back({object.name, listed_name(object.name, listed[object.assembly])});
  }
  return names;
}

bool means(const std::string& name, const PartName& part) {
  if (means_one(name, part)) return true;
  const std::vector<std::string> names = names_of(name);
  return std::any_of(names.begin(), names.end(),
                     [&](const std::string& one) { return means_one(one, part); });
}

Status check_siblings(std::span<const Rule> rules, std::span<const PartName> parts,
                      const std::string& path) {
  const auto check_name = [&](const std::string& name, std::size_t line) -> Status {
    for (const PartName& part : parts) {
      const Meaning meaning(name, part);
      const auto first = meaning.with_ending("[1]");
      if (!first) continue;
      return Error{
          ErrorCode::kUsage, path, "line " + std::to_string(line),
          "several siblings have the name '" + name + "', such as " + part.listed,
          "write " + *first + " for only the first, or " + *meaning.with_ending("*") + " for all"};
    }
    return {};
  };
  for (const Rule& rule : rules) {
    for (const std::string* const list : {&rule.part, &rule.object}) {
      for (const std::string& name : names_of(*list)) {
        if (Status s = check_name(name, rule.line); !s) return s;
      }
    }
  }
  return {};
}

RuleTable::RuleTable(std::span<const Rule> rules, std::span<const PartName> parts)
    : rules_(rules), parts_(parts), decides_(rules.size()) {
  // The rows that name a part: in the first column, and in the second.
  std::map<std::vector<bool>, std::uint32_t> classes;
  std::vector<std::vector<bool>> rows_of;  // [classes]
  std::vector<std::size_t> size_of;        // [classes]
  for (const PartName& part : parts) {
    std::vector<bool> rows;
    for (const Rule& rule : rules) {
      rows.push_back(means(rule.part, part));
      rows.push_back(means(rule.object, part));
    }
    const auto [at, is_new] =
        classes.try_emplace(std::move(rows), static_cast<std::uint32_t>(classes.size()));
    if (is_new) rows_of.push_back(at->first), size_of.push_back(0);
    ++size_of[at->second];
    class_of_.push_back(at->second);
  }
  classes_ = classes.size();
  first_.resize(classes_ * classes_);
  for (std::size_t a = 0; a < classes_; ++a) {
    for (std::size_t b = a; b < classes_; ++b) {
      std::size_t first = 0;
      const auto matches = [&](std::size_t rule) {
        return (rows_of[a][2 * rule] && rows_of[b][2 * rule + 1]) ||
               (rows_of[b][2 * rule] && rows_of[a][2 * rule + 1]);
      };
      while (first < rules.size() && !matches(first)) ++first;
      first_[a * classes_ + b] = first_[b * classes_ + a] = first;
      const bool is_of_a_pair = a != b || size_of[a] > 1;
      if (is_of_a_pair && first < rules.size()) decides_[first] = true;
    }
  }
}

std::vector<std::string> RuleTable::warnings(const std::string& path) const {
  std::vector<std::string> warnings;
  for (std::size_t rule = 0; rule < rules_.size(); ++rule) {
    const std::string warning = warning_of(rule);
    if (warning.empty()) continue;
    warnings.push_back(path + ": line " + std::to_string(rules_[rule].line) + ": " + warning);
  }
  return warnings;
}

std::string RuleTable::warning_of(std::size_t rule) const {
  std::array<std::vector<std::size_t>, 2> meant;  // the parts that each column names
  std::size_t column = 0;
  for (const std::string* const list : {&rules_[rule].part, &rules_[rule].object}) {
    for (std::size_t n = 0; n < parts_.size(); ++n) {
      if (means(*list, parts_[n])) meant[column].push_back(n);
    }
    const bool is_borne = std::any_of(parts_.begin(), parts_.end(),
                                      [&](const PartName& part) { return means_one(*list, part); });
    for (const std::string& name : mesh::names_in(*list, is_borne)) {
      const auto is_meant = [&](const PartName& part) { return means(name, part); };
      if (std::any_of(parts_.begin(), parts_.end(), is_meant)) continue;
      command::NearestNames nearest(name);
      for (const PartName& part : parts_) nearest.add(part.listed);
      return "no part has the name '" + name + "'; " + nearest.text();
    }
    ++column;
  }
  if (decides_[rule]) return "";
  if (meant[0].size() == 1 && meant[0] == meant[1]) {
    return "the row decides about no pair, because both names mean only one part, " +
           parts_[meant[0].front()].listed;
  }
  return "the row decides about no pair, because earlier rows name all pairs that it names";
}

Result<PartRules> read_part_rules(const std::string& path, std::span<const PartName> part,
                                  std::span<const PartName> objects, const Requirement& otherwise) {
  const auto rules = read_rules(path);
  if (!rules) return rules.error();
  std::vector<PartName> names(objects.begin(), objects.end());
  names.insert(names.end(), part.begin(), part.end());
  if (Status s = check_siblings(*rules, names, path); !s) return s.error();
  const RuleTable table(*rules, names);
  const auto strictness = [](const Requirement& requirement) {
    return requirement.kind == Requirement::Kind::kIgnore ? -1 : requirement.clearance_m;
  };
  PartRules read;
  for (std::size_t object = 0; object < objects.size(); ++object) {
    Requirement strictest{Requirement::Kind::kIgnore, 0};
    for (std::size_t body = objects.size(); body < names.size(); ++body) {
      const std::size_t rule = table.first_rule(body, object);
      const Requirement& own = rule < rules->size() ? (*rules)[rule].requirement : otherwise;
      if (strictness(own) > strictness(strictest)) strictest = own;
    }
    read.of_object.push_back(strictest);
  }
  read.warnings = table.warnings(path);
  return read;
}

}  // namespace forcelayer::pairs
