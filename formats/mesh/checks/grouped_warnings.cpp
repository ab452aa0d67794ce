#include "formats/mesh/checks/grouped_warnings.h"

#include <algorithm>

namespace forcelayer::mesh {

void GroupedWarnings::add(const std::string& place, const std::string& text) {
  auto group = std::find_if(groups_.begin(), groups_.end(),
                            [&](const Group& known) { return known.text == text; });
  if (group == groups_.end()) group = groups_.insert(groups_.end(), Group{text, {}});
  if (std::find(group->places.begin(), group->places.end(), place) == group->places.end()) {
    group->places.push_back(place);
  }
}

std::vector<std::string> GroupedWarnings::lines() const {
  std::vector<std::string> lines;
  for (const auto& [text, places] : groups_) {
    std::string line = places.front();
    if (places.size() > 1) {
      line += " and " + std::to_string(places.size() - 1) + " other " +
              (places.size() == 2 ? kind_.substr(0, kind_.size() - 1) : kind_);
    }
    lines.push_back(line + ": " + text);
  }
  return lines;
}

}  // namespace forcelayer::mesh
