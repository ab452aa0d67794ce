// How a step computes, whatever the thread that calls it computes with.
#pragma once

#include <cstdint>

namespace forcelayer {

// In this thread, to the end of the scope: results round to nearest, denormals count as zero (they
// cost hundreds of cycles each), no operation traps. The host's own setting, its sticky flags too,
// is back afterwards.
class StepArithmetic {
 public:
  StepArithmetic() noexcept;
  StepArithmetic(const StepArithmetic&) = delete;
  StepArithmetic& operator=(const StepArithmetic&) = delete;
  ~StepArithmetic();

 private:
  std::uint64_t host_;
};

}  // namespace forcelayer
