// The floating-point mode of a step, independent of the calling thread's mode.
#pragma once

#include <cstdint>

namespace forcelayer::machine {

// Sets this thread's mode until the end of the scope: results round to nearest, denormals count as
// zero (each costs hundreds of cycles), no operation traps. Then restores the thread's own mode,
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

}  // namespace forcelayer::machine
