#include "workbench/exact/watch.h"

#include <utility>

namespace forcelayer::exact {
namespace {

// A step takes 0.1 to 50 us, and reading the clock much less than so many steps.
constexpr unsigned kSteps = 16;

thread_local Watch* watch = nullptr;
thread_local unsigned steps = 0;

}  // namespace

Watch::Watch(std::function<bool()> may_go_on)
    : may_go_on_(std::move(may_go_on)), outer_(std::exchange(watch, this)) {
  steps = 0;
}

Watch::~Watch() { watch = outer_; }

void keep_going() {
  if (watch == nullptr || ++steps < kSteps) return;
  if (!watch->may_go_on()) throw Stopped{};  // the next step asks again
  steps = 0;
}

}  // namespace forcelayer::exact
