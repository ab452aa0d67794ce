// Which known names a wrong one was meant to be.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace forcelayer::command {

// Least number of letters to insert, remove, change or swap with the next (optimal string
// alignment).
std::size_t spelling_distance(std::string_view a, std::string_view b);

// "A/B" for "A[1]/B[1]": a first sibling bears no number, but may be named by it.
std::string without_first_numbers(std::string_view name);

// The bytes that escaped() wrote as "\\x09".
std::string unescaped(std::string_view text);

// The names that a typed name may mean, the likeliest first: itself, without the numbers of first
// siblings, and both of the name that escaped() shows so. Each once.
std::vector<std::string> meanings_of(const std::string& typed);

// "the nearest names are: a/b, a/c": the paths that are spelled most like `name`, whole or by what
// stands behind their last "/".
class NearestNames {
 public:
  explicit NearestNames(std::string name) : name_(std::move(name)) {}

  void add(const std::string& path);
  // With `more` behind it; that alone where none was added.
  std::string text(const std::string& more = "") const;

 private:
  std::string name_;
  std::set<std::pair<std::size_t, std::string>> nearest_;
};

}  // namespace forcelayer::command
