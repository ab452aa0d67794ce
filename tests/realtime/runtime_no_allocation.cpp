// The step takes no memory: operator new is trapped around many steps of both models.
#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

#include "runtime/derive_parameters.h"
#include "runtime/servo.h"
#include "tests/support/random_scenes.h"

namespace {

thread_local bool trap_armed = false;
thread_local std::uint64_t trapped = 0;

void* take(std::size_t size) {
  if (trap_armed) ++trapped;
  void* memory = std::malloc(size);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

void* operator new(std::size_t size) { return take(size); }
void* operator new[](std::size_t size) { return take(size); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }

namespace forcelayer::test {
namespace {

// A hand that presses, slides, turns, jumps and sends nonsense.
class TryingInput final : public InputSource {
 public:
  explicit TryingInput(std::uint64_t seed) : random_(seed) {}
  bool next(double time_s, double, StepInput& input) noexcept override {
    input.valid = random_() % 100 != 0;
    input.world_from_handle.position_m = {0.08 + 0.02 * std::sin(time_s), 0.08,
                                          0.035 + 0.02 * std::sin(7 * time_s)};
    input.world_from_handle.orientation =
        glm::angleAxis(std::sin(3 * time_s), glm::dvec3(0.6, 0.8, 0));
    if (random_() % 500 == 0) input.world_from_handle.orientation = random_orientation(random_);
    if (random_() % 500 == 0) input.world_from_handle.position_m.x = 1 / 0.0;
    return true;
  }
  void output(const Frame&) noexcept override {}
  void silence() noexcept override {}
  const DevicePlacement& placement() const override { return placement_; }

 private:
  Random random_;
  DevicePlacement placement_;
};

std::uint64_t allocations(Model model, int frames, std::uint64_t& touching) {
  Voxmap voxmap = make_voxmap(
      offset_scene(0.005, {0, 0, -2}, {32, 32, 8}, 2, [](Voxel v) { return v[2] <= 0; }));
  Pshell shell = make_pshell(sphere_part(0.02, 200, 0.005));
  ParameterRequest request;
  request.model = model;
  request.force = usual_force(model, voxmap);
  DeviceCapabilities device;
  device.max_force_n = 15;
  device.max_torque_nm = 0.1;
  const auto derived = derive_parameters(request, voxmap, shell, device);
  auto simulation = Simulation::create(std::move(voxmap), std::move(shell), derived->values);
  TryingInput input(1);
  const Pose start{{0.08, 0.08, 0.05}, {1, 0, 0, 0}};
  Servo servo(**simulation, input, (*simulation)->registered(start, start), {});
  Frame frame;
  trapped = 0;
  trap_armed = true;
  for (int i = 0; i < frames; ++i) {
    servo.tick(frame);
    touching += frame.result.report.surface > 0;
  }
  trap_armed = false;
  return trapped;
}

TEST(StepMemory, TheTrapWorks) {
  trapped = 0;
  trap_armed = true;
  const auto number = std::make_unique<std::vector<int>>(100);
  trap_armed = false;
  EXPECT_GE(trapped, 2u);
}

TEST(StepMemory, NoStepOfThePaperModelAllocates) {
  std::uint64_t touching = 0;
  EXPECT_EQ(allocations(Model::kPaper, 100'000, touching), 0u);
  EXPECT_GT(touching, 10'000u);
}

TEST(StepMemory, NoStepOfTheDefaultModelAllocates) {
  std::uint64_t touching = 0;
  EXPECT_EQ(allocations(Model::kDefault, 20'000, touching), 0u);
  EXPECT_GT(touching, 2'000u);
}

}  // namespace
}  // namespace forcelayer::test
