#include "formats/command/spelling/spelling.h"

#include <algorithm>
#include <charconv>
#include <iterator>
#include <numeric>

namespace forcelayer::command {

std::size_t spelling_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before, last(b.size() + 1), row(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        row[j] = std::min(row[j], before[j - 2] + 1);
      }
    }
    before = std::exchange(last, row);
  }
  return last.back();
}

std::string without_first_numbers(std::string_view name) {
  constexpr std::string_view kFirst = "[1]";
  std::string text;
  for (std::size_t start = 0; start <= name.size();) {
    const std::size_t end = std::min(name.find('/', start), name.size());
    std::string_view label = name.substr(start, end - start);
    if (label.size() > kFirst.size() && label.ends_with(kFirst)) {
      label.remove_suffix(kFirst.size());
    }
    text.append(label);
    if (end < name.size()) text += '/';
    start = end + 1;
  }
  return text;
}

std::string unescaped(std::string_view text) {
  constexpr std::size_t kBytes = 4;  // of "\\x09"
  std::string bytes;
  while (!text.empty()) {
    unsigned code = 0;
    const char* const digits = text.data() + 2;
    const bool is_escape = text.size() >= kBytes && text.starts_with("\\x") &&
                           std::from_chars(digits, digits + 2, code, 16).ptr == digits + 2;
    bytes += is_escape ? static_cast<char>(code) : text.front();
    text.remove_prefix(is_escape ? kBytes : 1);
  }
  return bytes;
}

std::vector<std::string> meanings_of(const std::string& typed) {
  std::vector<std::string> meanings;
  for (const std::string& name : {typed, unescaped(typed)}) {
    for (std::string meaning : {name, without_first_numbers(name)}) {
      if (std::find(meanings.begin(), meanings.end(), meaning) == meanings.end()) {
        meanings.push_back(std::move(meaning));
      }
    }
  }
  return meanings;
}

void NearestNames::add(const std::string& path) {
  constexpr std::size_t kListed = 5;
  const std::string_view label = std::string_view(path).substr(path.rfind('/') + 1);
  nearest_.emplace(std::min(spelling_distance(name_, path), spelling_distance(name_, label)), path);
  if (nearest_.size() > kListed) nearest_.erase(std::prev(nearest_.end()));
}

std::string NearestNames::text(const std::string& more) const {
  std::string text;
  for (const auto& [distance, path] : nearest_) {
    text += (text.empty() ? "the nearest names are: " : ", ") + path;
  }
  return text + (text.empty() || more.empty() ? "" : "; ") + more;
}

}  // namespace forcelayer::command
