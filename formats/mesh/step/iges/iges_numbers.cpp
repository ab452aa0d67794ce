#include "formats/mesh/step/iges/iges_numbers.h"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <string>

namespace forcelayer::mesh {
namespace {

// Columns of a line: the end of its data, behind which parameters have a pointer into the
// directory; the letter of its section; its number.
constexpr std::size_t kDataOfGlobals = 72, kDataOfParameters = 64, kSection = 72, kLine = 73;
constexpr std::string_view kBlanks = " \t\r";

// These have numbers and pointers alone.
constexpr int kOfNumbers[] = {100, 102, 104, 106, 108, 110, 112, 114,
                              116, 118, 120, 122, 124, 126, 128, 140};

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

// As Fortran writes it: "1", "-.5", "2.E3", "1.D-3".
bool is_number(std::string_view text) {
  const auto skip_sign = [&] {
    if (!text.empty() && (text[0] == '+' || text[0] == '-')) text.remove_prefix(1);
  };
  const auto skip_digits = [&] {
    const std::size_t count = std::min(text.find_first_not_of("0123456789"), text.size());
    text.remove_prefix(count);
    return count;
  };
  skip_sign();
  std::size_t digits = skip_digits();
  if (!text.empty() && text[0] == '.') {
    text.remove_prefix(1);
    digits += skip_digits();
  }
  if (digits == 0) return false;
  if (text.empty()) return true;
  if (std::string_view("EeDd").find(text[0]) == std::string_view::npos) return false;
  text.remove_prefix(1);
  skip_sign();
  return skip_digits() > 0 && text.empty();
}

struct Delimiters {
  char parameter = ',', record = ';';
};

// The global section begins with both as texts, "1H,,1H;", or leaves them out.
Delimiters delimiters_of(std::string_view globals) {
  Delimiters found;
  if (globals.starts_with("1H") && globals.size() > 3) {
    found.parameter = globals[2];
    globals.remove_prefix(3);
  }
  globals.remove_prefix(std::min<std::size_t>(globals.size(), 1));
  if (globals.starts_with("1H") && globals.size() > 2) found.record = globals[2];
  return found;
}

// Whether the parameters of one entity, of these types, are numbers or empty.
bool has_only_numbers(std::string_view parameters, const Delimiters& delimiters) {
  const std::size_t end = std::min(parameters.find(delimiters.record), parameters.size());
  parameters = parameters.substr(0, end);
  const int type = whole_number(parameters);
  if (std::find(std::begin(kOfNumbers), std::end(kOfNumbers), type) == std::end(kOfNumbers)) {
    return true;
  }
  while (!parameters.empty()) {
    const std::size_t next = std::min(parameters.find(delimiters.parameter), parameters.size());
    const std::string_view value = trimmed(parameters.substr(0, next));
    if (!value.empty() && !is_number(value)) return false;
    parameters.remove_prefix(std::min(next + 1, parameters.size()));
  }
  return true;
}

std::string_view take_line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

}  // namespace

std::set<int> iges_entries_without_numbers(std::string_view text) {
  std::string globals;
  std::map<int, std::string> parameters;  // by entry
  while (!text.empty()) {
    const std::string_view line = take_line(text);
    if (line.size() < kLine) continue;
    if (line[kSection] == 'G') globals += line.substr(0, kDataOfGlobals);
    if (line[kSection] != 'P') continue;
    const int entry = whole_number(line.substr(kDataOfParameters, kSection - kDataOfParameters));
    parameters[entry] += line.substr(0, kDataOfParameters);
  }
  const Delimiters delimiters = delimiters_of(globals);
  std::set<int> entries;
  for (const auto& [entry, values] : parameters) {
    if (!has_only_numbers(values, delimiters)) entries.insert(entry);
  }
  return entries;
}

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
