// Work in steps that are the same on every machine: basic blocks that ran, of all that is compiled
// with FORCELAYER_COUNT_WORK. In a build without it, none.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "tests/fuzz/fuzz_target.h"

namespace forcelayer::fuzz {

std::uint64_t work();

// The bound on a reader's work: so many steps for any input, and so many more for each byte.
struct WorkBound {
  std::uint64_t first, each;
};

// Runs a reader on an input of `size` bytes and aborts where it works more than in proportion.
template <typename Reader>
auto within(const WorkBound& bound, std::size_t size, const Reader& reader) {
  const std::uint64_t begin = work();
  auto read = reader();
  require(work() - begin <= bound.first + bound.each * size, "work in proportion to the input");
  return read;
}

}  // namespace forcelayer::fuzz
