// Warnings of many files or nodes: equal ones share one line.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace forcelayer::mesh {

class GroupedWarnings {
 public:
  // `kind`: the plural of what `place` is, "files" or "nodes".
  explicit GroupedWarnings(std::string kind) : kind_(std::move(kind)) {}

  // A second warning of the same text and place is left out.
  void add(const std::string& place, const std::string& text);

  // "a.stl: TEXT", or "a.stl and 65 other files: TEXT", in the order of their first places.
  std::vector<std::string> lines() const;

 private:
  struct Group {
    std::string text;
    std::vector<std::string> places;
  };
  std::string kind_;
  std::vector<Group> groups_;
};

}  // namespace forcelayer::mesh
