// Which points of a shell lie next to each other.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "formats/pshell.h"

namespace forcelayer::query {

// Every pair of points within a distance once, found from the point that comes first in the shell.
// A point counts at most kMax of them.
class ShellNeighbors {
 public:
  static constexpr std::size_t kMax = 24;

  // Set-up only: compares all blocks of the shell.
  ShellNeighbors(const PshellView& shell, double distance_m);

  // The points after `point` that lie near it.
  std::span<const std::uint32_t> after(std::uint32_t point) const noexcept {
    const Range& range = ranges_[point];
    return {neighbors_.data() + range.first, range.count};
  }

 private:
  struct Range {
    std::uint32_t first = 0, count = 0;
  };
  std::vector<Range> ranges_;  // of every point
  std::vector<std::uint32_t> neighbors_;
};

}  // namespace forcelayer::query
