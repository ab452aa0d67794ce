// Which known names a wrong one was meant to be.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <string_view>
#include <utility>

namespace forcelayer::command {

// Least number of letters to insert, remove, change or swap with the next (optimal string
// alignment).
std::size_t spelling_distance(std::string_view a, std::string_view b);

// "A/B" for "A[1]/B[1]": a first sibling bears no number, but may be named by it.
std::string without_first_numbers(std::string_view name);

// "the nearest are: a/b, a/c": the paths that are spelled most like `name`, whole or by what stands
// behind their last "/".
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
