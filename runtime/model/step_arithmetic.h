// Floating-point arithmetic of a step, whatever the calling thread has set.
#pragma once

#include <cstdint>

namespace forcelayer {

// To the end of the scope, in this thread: results round to nearest, denormals count as zero (each
// costs hundreds of cycles), no operation traps. The destructor restores the thread's own setting,
// sticky flags included.
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
