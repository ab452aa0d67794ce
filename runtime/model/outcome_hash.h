// A hash of a step's outcome, by which replays are compared bit for bit.
#pragma once

#include <cstdint>

#include "runtime/coupling/state.h"

namespace forcelayer::model {

// FNV-1a over the bits of the wrench, the part's pose and its velocity, in that order.
std::uint64_t outcome_hash(const StepResult& result, const State& after) noexcept;

}  // namespace forcelayer::model
