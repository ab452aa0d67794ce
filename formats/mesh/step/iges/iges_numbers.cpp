#include "formats/mesh/step/iges/iges_numbers.h"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <string>

namespace forcelayer::mesh {
namespace {

// Columns of a line: the letter of its section, its number.
constexpr std::size_t kSection = 72, kLine = 73;
constexpr std::string_view kBlanks = " \t\r";

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

int whole_number(std::string_view text) {
  text = trimmed(text);
  int number = 0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

std::string_view take_line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

}  // namespace

std::map<int, int> iges_matrix_entries(std::string_view text) {
  constexpr std::size_t kMatrix = 48, kField = 8;
  std::map<int, int> matrices;
  bool is_first = true;  // of the two lines of an entry
  while (!text.empty()) {
    const std::string_view line = take_line(text);
    if (line.size() < kLine || line[kSection] != 'D') continue;
    const int matrix = whole_number(line.substr(kMatrix, kField));
    if (is_first && matrix != 0) matrices[whole_number(line.substr(kLine))] = matrix;
    is_first = !is_first;
  }
  return matrices;
}

}  // namespace forcelayer::mesh
