#include "formats/mesh/node_names.h"

#include <algorithm>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <unordered_set>

#include "formats/command/spelling/spelling.h"
#include "formats/mesh/reader.h"

namespace forcelayer::mesh {
namespace {

constexpr const char* kWildcards = "*?";

bool has_wildcard(std::string_view name) {
  return name.find_first_of(kWildcards) != std::string_view::npos;
}

// Whether `text` is `pattern`, whose `*` and `?` stand for letters other than "/".
bool matches(std::string_view text, std::string_view pattern) {
  std::size_t t = 0, p = 0;
  std::size_t star = std::string_view::npos, star_text = 0;  // the last `*`, and the text it took
  while (t < text.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      star_text = t;
    } else if (p < pattern.size() &&
               (pattern[p] == text[t] || (pattern[p] == '?' && text[t] != '/'))) {
      ++p;
      ++t;
    } else if (star != std::string_view::npos && text[star_text] != '/') {
      p = star + 1;
      t = ++star_text;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', p) == std::string_view::npos;
}

// Whether `path`, or what follows one of its slashes, passes `test`.
template <typename Test>
bool any_end(std::string_view path, const Test& test) {
  for (std::size_t start = 0;; ++start) {
    if (test(path.substr(start))) return true;
    start = path.find('/', start);
    if (start == std::string_view::npos) return false;
  }
}

bool ends_like(const std::string& path, const std::string& pattern) {
  return any_end(path, [&](std::string_view end) { return matches(end, pattern); });
}

// The node of this path, else all whose paths end so. Where labels hold slashes several nodes may
// have one path.
std::vector<std::size_t> bearers_as_written(const std::string& name,
                                            std::span<const AssemblyNode> nodes) {
  std::vector<std::size_t> found, ending_so;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (nodes[i].path == name) found.push_back(i);
    if (bears_name(nodes[i].path, name)) ending_so.push_back(i);
  }
  return found.empty() ? ending_so : found;
}

// Those, else those of the name without the numbers of first siblings.
std::vector<std::size_t> bearers_of(const std::string& name, std::span<const AssemblyNode> nodes) {
  std::vector<std::size_t> found = bearers_as_written(name, nodes);
  if (!found.empty()) return found;
  const std::string unnumbered = command::without_first_numbers(name);
  return unnumbered == name ? found : bearers_as_written(unnumbered, nodes);
}

std::vector<std::string_view> labels_of(std::string_view path) {
  std::vector<std::string_view> labels;
  for (std::size_t start = 0; start <= path.size();) {
    const std::size_t end = std::min(path.find('/', start), path.size());
    labels.push_back(path.substr(start, end - start));
    start = end + 1;
  }
  return labels;
}

// A pattern without the numbers of first siblings. Beside a wildcard "[1]" stands as written.
std::string pattern_without_first_numbers(const std::string& name) {
  std::string text;
  for (const std::string_view label : labels_of(name)) {
    if (!text.empty()) text += '/';
    text += has_wildcard(label) ? std::string(label) : command::without_first_numbers(label);
  }
  return text;
}

// Those, else all that fit the wildcards.
std::vector<std::size_t> nodes_of(const std::string& name, std::span<const AssemblyNode> nodes) {
  std::vector<std::size_t> found = bearers_of(name, nodes);
  if (!found.empty() || !has_wildcard(name)) return found;
  for (const std::string& pattern : {name, pattern_without_first_numbers(name)}) {
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (ends_like(nodes[i].path, pattern)) found.push_back(i);
    }
    if (!found.empty()) return found;
  }
  return found;
}

void mark_sub_tree(std::size_t first, std::span<const AssemblyNode> nodes,
                   std::vector<bool>& is_in) {
  std::size_t i = first;
  do {
    is_in[i++] = true;
  } while (i < nodes.size() && nodes[i].depth > nodes[first].depth);
}

std::string listed(const std::vector<std::size_t>& found, std::span<const AssemblyNode> nodes) {
  constexpr std::size_t kListed = 8;
  const std::vector<std::string> names = numbered_paths(nodes);
  std::string list;
  for (std::size_t i = 0; i < std::min(found.size(), kListed); ++i) {
    list += (i == 0 ? "" : ", ") + names[found[i]];
  }
  return found.size() > kListed ? list + ", ..." : list;
}

Error several(const std::string& where, const std::vector<std::size_t>& found,
              std::span<const AssemblyNode> nodes) {
  const std::string& path = nodes[found.front()].path;
  const bool is_one_path =
      std::all_of(found.begin(), found.end(), [&](std::size_t i) { return nodes[i].path == path; });
  return {ErrorCode::kSceneInvalid, "", where, "several nodes have this name",
          is_one_path ? "all have the path " + path +
                            ", because one node's own name contains a slash: rename that node"
                      : "use one of: " + listed(found, nodes)};
}

// Whether `label` is `first` with a number behind it: of a later sibling that is called alike.
bool is_later(std::string_view label, std::string_view first) {
  if (label.size() < first.size() + 3 || !label.starts_with(first)) return false;
  label.remove_prefix(first.size());
  if (label.front() != '[' || label.back() != ']') return false;
  label = label.substr(1, label.size() - 2);
  return label.find_first_not_of("0123456789") == std::string_view::npos;
}

// Whether a number or a wildcard says which siblings, by label of a name that fits `path`.
std::vector<bool> settled_labels(const std::string& path, const std::string& name) {
  const bool as_written = bears_name(path, name);
  std::vector<bool> is_settled;
  for (const std::string_view label : labels_of(name)) {
    is_settled.push_back(!as_written &&
                         (has_wildcard(label) || command::without_first_numbers(label) != label));
  }
  return is_settled;
}

// A name that a node bears, or fits by its wildcards. Other nodes may be meant too where that one,
// or one that it is below, is the first of siblings that are called alike.
class OneOfSeveral {
 public:
  // Both texts must outlive this.
  OneOfSeveral(const std::string& name, const std::string& path)
      : labels_(labels_of(path)),
        named_(labels_of(name)),
        is_settled_(settled_labels(path, name)),
        has_others_(named_.size()) {}

  bool may_mean(const std::string& path) {
    const auto labels = labels_of(path);
    if (labels.size() != labels_.size()) return false;
    const std::size_t above = labels.size() - named_.size();
    std::vector<std::size_t> later;
    for (std::size_t i = 0; i < labels.size(); ++i) {
      if (labels[i] == labels_[i]) continue;
      if (i < above || is_settled_[i - above] || !is_later(labels[i], labels_[i])) return false;
      later.push_back(i - above);
    }
    for (const std::size_t i : later) has_others_[i] = true;
    return !later.empty();
  }

  // After may_mean() has been asked of all nodes.
  std::string mend() const {
    return "write " + with_ending("[1]") + " for only the first node, or " + with_ending("*") +
           " for all nodes that match this pattern";
  }

 private:
  std::string with_ending(const char* ending) const {
    std::string text;
    for (std::size_t i = 0; i < named_.size(); ++i) {
      text += (i == 0 ? "" : "/") + std::string(named_[i]) + (has_others_[i] ? ending : "");
    }
    return text;
  }

  std::vector<std::string_view> labels_, named_;  // of the node's path; of the name
  std::vector<bool> is_settled_, has_others_;     // [named_] by a number or a wildcard
};

// A label without the numbers of siblings that are called alike.
std::string_view without_numbers(std::string_view label) {
  for (std::size_t begin; (begin = label.rfind('[')) != std::string_view::npos;) {
    if (!is_later(label, label.substr(0, begin))) break;
    label = label.substr(0, begin);
  }
  return label;
}

// A path without these numbers at the labels that a name leaves open, the last of them: the same
// for all nodes that it may mean beside each other.
std::string common_path(std::string_view path, const std::vector<bool>& is_settled) {
  const auto labels = labels_of(path);
  std::string text;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const std::size_t behind = labels.size() - i;  // this label and those below it
    const bool is_open = behind <= is_settled.size() && !is_settled[is_settled.size() - behind];
    text.append(is_open ? without_numbers(labels[i]) : labels[i]) += '/';
  }
  return text;
}

// Refuses a name where another node than those that it fits may be meant too that is not `settled`,
// by another name. In time that grows as the number of nodes, whatever a wildcard fits.
template <typename Settled>
Status check_is_alone(const std::string& where, const std::string& name,
                      std::span<const AssemblyNode> nodes, const Settled& settled) {
  const std::vector<std::size_t> named = nodes_of(name, nodes);
  if (named.empty()) return {};
  const std::vector<bool> is_settled = settled_labels(nodes[named.front()].path, name);
  std::unordered_map<std::string, std::vector<std::size_t>> called_alike;
  for (const std::size_t i : named) {
    called_alike[common_path(nodes[i].path, is_settled)].push_back(i);
  }
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (settled(i)) continue;
    const auto alike = called_alike.find(common_path(nodes[i].path, is_settled));
    if (alike == called_alike.end()) continue;
    for (const std::size_t first : alike->second) {
      OneOfSeveral one(name, nodes[first].path);
      if (!one.may_mean(nodes[i].path)) continue;
      std::vector<std::size_t> found{first};
      for (std::size_t other = 0; other < nodes.size(); ++other) {
        if (one.may_mean(nodes[other].path) && !settled(other)) found.push_back(other);
      }
      return Error{ErrorCode::kSceneInvalid, "", where,
                   "several siblings have this name: " + listed(found, nodes), one.mend()};
    }
  }
  return {};
}

// A name, or what it shows in a listing where only that is the name of a node.
std::string as_called(std::string name, std::span<const AssemblyNode> nodes) {
  std::string shown = command::unescaped(name);
  if (shown == name || !nodes_of(name, nodes).empty() || nodes_of(shown, nodes).empty()) {
    return name;
  }
  return shown;
}

// The names that `list` stands for among these nodes.
std::vector<std::string> names_among(const std::string& list, std::span<const AssemblyNode> nodes) {
  const bool is_borne =
      !bearers_of(list, nodes).empty() || !bearers_of(command::unescaped(list), nodes).empty();
  std::vector<std::string> names = names_in(list, is_borne);
  for (std::string& name : names) name = as_called(std::move(name), nodes);
  return names;
}

bool is_ambiguous(const std::string& name, const std::vector<std::size_t>& found) {
  return found.size() > 1 && !has_wildcard(name);
}

}  // namespace

std::string NodeTreeLimit::add(const AssemblyNode& node) {
  if (node.depth > kDeepestNode) {
    return "is nested deeper than " + std::to_string(kDeepestNode) + " levels";
  }
  const std::uint64_t bytes = kOfNode + node.path.size();
  if (bytes > left_) return kTooMuch;
  left_ -= bytes;
  return "";
}

AssemblyNode name_node(const std::string& name, const AssemblyNode* parent, UsedLabels& used) {
  std::string label = name;
  // All numbers up to the highest are taken: labels are never given back.
  std::uint64_t* highest = nullptr;
  for (auto place = used.try_emplace(label, 1); !place.second; place = used.try_emplace(label, 1)) {
    if (highest == nullptr) highest = &place.first->second;
    label = name + "[" + std::to_string(++*highest) + "]";
  }
  if (parent == nullptr) return {label, label, 0};
  return {label, parent->path + "/" + label, parent->depth + 1};
}

std::vector<std::string> numbered_paths(std::span<const AssemblyNode> nodes) {
  std::unordered_set<std::string_view> paths;
  for (const AssemblyNode& node : nodes) paths.insert(node.path);
  std::vector<std::string> numbered, above;  // above: of the nodes that this one is below
  for (const AssemblyNode& node : nodes) {
    above.resize(node.depth);
    std::string path = (above.empty() ? "" : above.back() + "/") + node.label;
    if (paths.contains(node.path + "[2]")) path += "[1]";
    above.push_back(path);
    numbered.push_back(std::move(path));
  }
  return numbered;
}

bool bears_name(const std::string& path, const std::string& name) {
  return any_end(path, [&](std::string_view end) { return end == name; });
}

bool fits_name(const std::string& path, const std::string& name) {
  return bears_name(path, name) || ends_like(path, name);
}

std::vector<std::string> names_in(const std::string& name, bool is_borne) {
  if (is_borne || name.size() < 2 || name.front() != '{' || name.back() != '}') return {name};
  std::vector<std::string> names;
  for (std::size_t start = 1; start < name.size();) {
    const std::size_t end = std::min(name.find(',', start), name.size() - 1);
    if (end > start) names.push_back(name.substr(start, end - start));
    start = end + 1;
  }
  return names.empty() ? std::vector<std::string>{name} : names;
}

Result<std::vector<bool>> choose_nodes(std::span<const std::string> names,
                                       std::span<const AssemblyNode> nodes) {
  std::vector<bool> is_in(nodes.size(), names.empty());
  for (const std::string& list : names) {
    for (const std::string& name : names_among(list, nodes)) {
      const std::vector<std::size_t> found = nodes_of(name, nodes);
      if (is_ambiguous(name, found)) return several("#" + name, found, nodes);
      if (found.empty()) {
        command::NearestNames nearest(name);
        for (const AssemblyNode& node : nodes) nearest.add(node.path);
        return Error{ErrorCode::kSceneInvalid, "", "#" + name, "no node has this name",
                     nearest.text()};
      }
      for (const std::size_t node : found) mark_sub_tree(node, nodes, is_in);
    }
  }
  return is_in;
}

NodesToRead nodes_to_read(const SourceFile& file, std::span<const AssemblyNode> nodes) {
  const auto fail = [&](const Error& error) {
    fail_read(file, error.code, error.where, error.what, error.mend);
  };
  auto chosen = choose_nodes(file.options.nodes, nodes);
  if (!chosen) fail(chosen.error());
  NodesToRead to_read{std::move(*chosen), std::vector<bool>(nodes.size()), {}, {}};
  for (const std::string& list : file.options.without) {
    for (const std::string& name : names_among(list, nodes)) {
      const std::vector<std::size_t> found = nodes_of(name, nodes);
      if (is_ambiguous(name, found)) fail(several("--without " + name, found, nodes));
      (found.empty() ? to_read.unknown : to_read.left_out).push_back(name);
      for (const std::size_t node : found) mark_sub_tree(node, nodes, to_read.is_left_out);
    }
  }
  const auto check = [&](const char* what, const std::vector<std::string>& lists,
                         const auto& settled) {
    for (const std::string& list : lists) {
      for (const std::string& name : names_among(list, nodes)) {
        const Status alone = check_is_alone(what + name, name, nodes, settled);
        if (!alone) fail(alone.error());
      }
    }
  };
  const auto is_left_out = [&](std::size_t i) { return bool(to_read.is_left_out[i]); };
  check("#", file.options.nodes,
        [&](std::size_t i) { return to_read.is_read[i] || is_left_out(i); });
  check("--without ", file.options.without,
        [&](std::size_t i) { return !to_read.is_read[i] || is_left_out(i); });
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (to_read.is_left_out[i]) to_read.is_read[i] = false;
  }
  return to_read;
}

void set_instances(std::span<const std::size_t> nodes_of_instances, std::span<AssemblyNode> nodes) {
  const auto first_from = [&](std::size_t node) {
    return static_cast<std::uint32_t>(
        std::lower_bound(nodes_of_instances.begin(), nodes_of_instances.end(), node) -
        nodes_of_instances.begin());
  };
  std::vector<std::size_t> open;  // nodes whose sub-trees go on
  const auto close_down_to = [&](std::size_t depth, std::size_t end) {
    for (; open.size() > depth; open.pop_back()) {
      AssemblyNode& node = nodes[open.back()];
      node.instance_count = first_from(end) - node.first_instance;
    }
  };
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    close_down_to(nodes[i].depth, i);
    nodes[i].first_instance = first_from(i);
    open.push_back(i);
  }
  close_down_to(0, nodes.size());
}

Status check_left_out(std::span<const std::string> without, std::span<const Assembly> assemblies,
                      const std::set<std::string>& parts,
                      std::span<const std::string> other_parts) {
  const auto is_known = [&](const std::string& name) {
    const auto left_out_of = [&](const Assembly& assembly) {
      return std::find(assembly.left_out.begin(), assembly.left_out.end(), name) !=
             assembly.left_out.end();
    };
    return parts.contains(name) || std::any_of(assemblies.begin(), assemblies.end(), left_out_of);
  };
  for (const std::string& list : without) {
    for (const std::string& name :
         names_in(list, is_known(list) || is_known(command::unescaped(list)))) {
      if (is_known(name) || is_known(command::unescaped(name))) continue;
      command::NearestNames nearest(name);
      bool any = !other_parts.empty();
      for (const Assembly& assembly : assemblies) {
        for (const AssemblyNode& node : assembly.nodes) nearest.add(node.path);
        any |= !assembly.nodes.empty();
      }
      for (const std::string& part : other_parts) nearest.add(part);
      const std::string mend =
          any ? nearest.text()
              : "a file of this format has only one part: in a scene manifest, "
                "list one file for each part";
      return Error{ErrorCode::kSceneInvalid, "", "--without",
                   "no file has a node called " + in_quotes(name), mend};
    }
  }
  return {};
}

}  // namespace forcelayer::mesh
