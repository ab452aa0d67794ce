// The host's floating-point state: no bit of a result depends on it, and it is left as it was.
#include "runtime/machine/step_arithmetic.h"

#include <gtest/gtest.h>

#include <cfenv>
#include <cstring>
#include <functional>
#include <limits>
#include <thread>
#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

#include "forcelayer/forcelayer.h"
#include "runtime/model/outcome_hash.h"
#include "tests/support/motion_bench.h"
#include "tests/support/scratch_folder.h"

namespace forcelayer::test {
namespace {

constexpr double kS = 0.005;

struct HostState {
  const char* name;
  std::function<void()> set;
};

// Floating-point states of a program's own threads. feenableexcept() of FE_INEXACT would end every
// step at once.
std::vector<HostState> host_states() {
  std::vector<HostState> states = {
      {"upward", [] { std::fesetround(FE_UPWARD); }},
      {"downward", [] { std::fesetround(FE_DOWNWARD); }},
      {"towards zero", [] { std::fesetround(FE_TOWARDZERO); }},
      {"flags raised", [] { std::feraiseexcept(FE_ALL_EXCEPT); }},
  };
#if defined(__SSE2__)
  states.push_back({"traps", [] { _mm_setcsr(0); }});
  states.push_back({"flush to zero", [] { _mm_setcsr(0x9fc0); }});
#endif
  return states;
}

std::uint64_t control() {
#if defined(__SSE2__)
  return _mm_getcsr();
#else
  std::fenv_t all;
  std::fegetenv(&all);
  std::uint64_t word = 0;
  std::memcpy(&word, &all, std::min(sizeof all, sizeof word));
  return word;
#endif
}

// On a thread of its own, as a host has them.
void on_host_thread(const HostState& state, const std::function<void()>& body) {
  std::thread([&] {
    std::fenv_t clean;
    std::fegetenv(&clean);
    state.set();
    body();
    std::fesetenv(&clean);
  }).join();
}

// A press into a floor with a turn, both models, and what it came to.
std::uint64_t pressed(Model model, const HostState& state) {
  BenchOptions options;
  options.model = model;
  const auto floor = [](const glm::dvec3& p) { return p.z - 0.3 * kS; };
  MotionBench bench(shape_scene(kS, {-24, -24, -3}, {48, 48, 12}, floor),
                    sphere_part(4 * kS, 200, kS), {{0, 0, 12 * kS}, {1, 0, 0, 0}}, options);
  std::uint64_t hash = 0;
  std::uint32_t contacts = 0;
  for (int frame = 0; frame < 300; ++frame) {
    const Pose hand{{0.00011 * frame, 0.001, 12 * kS - 0.00017 * frame},
                    coupling::rotation_by({0.0013 * frame, 0, 0.0007 * frame})};
    const Pose last = bench.input.world_from_handle;
    bench.input.handle_velocity.linear_mps = (hand.position_m - last.position_m) / bench.dt_s;
    bench.input.world_from_handle = hand;
    StepResult result;
    const auto step = [&] {
      const std::uint64_t before = control();
      result = bench.simulation->step(bench.state, bench.input, bench.dt_s);
      EXPECT_EQ(control(), before) << state.name;
    };
    if (frame % 10 == 0) {
      on_host_thread(state, step);  // not all: threads cost more than steps
    } else {
      step();
    }
    contacts += result.report.contacts;
    hash = hash * 31 + model::outcome_hash(result, bench.state);
  }
  EXPECT_GT(contacts, 100u);
  return hash;
}

TEST(StepArithmetic, NoBitOfAStepDependsOnTheHostsThread) {
  for (const Model model : {Model::kPaper, Model::kDefault}) {
    const std::uint64_t usual = pressed(model, {"usual", [] {}});
    for (const HostState& state : host_states()) {
      EXPECT_EQ(pressed(model, state), usual) << state.name;
    }
  }
}

// All of a run through the C header, from the opening of the files on.
std::uint64_t through_c(const HostState& state, const ScratchFolder& folder) {
  std::uint64_t hash = 0;
  on_host_thread(state, [&] {
    char error[256] = "";
    forcelayer_options options;
    forcelayer_default_options(&options);
    options.stale_s = 1000;
    forcelayer_runtime* const runtime =
        forcelayer_open((folder / "floor.vox").c_str(), (folder / "ball.pshell").c_str(), &options,
                        error, sizeof error);
    ASSERT_NE(runtime, nullptr) << error;
    forcelayer_reading reading{};
    reading.device_from_handle[0] = reading.device_from_handle[1] = 0.1;  // below the part
    reading.device_from_handle[3] = 1;
    reading.fresh = reading.present = reading.calibrated = 1;
    const double start[7] = {0.1, 0.1, 0.06, 0.6, 0, 0.8, 0};
    ASSERT_EQ(forcelayer_start(runtime, start, nullptr, &reading, error, sizeof error), 0);
    double pushed_n = 0;
    for (int frame = 0; frame < 500; ++frame) {
      const std::uint64_t before = control();
      forcelayer_result result;
      std::memset(&result, 0, sizeof result);
      ASSERT_EQ(forcelayer_step(runtime, &reading, &result), 0);
      EXPECT_EQ(control(), before) << state.name;
      // Read by bits: the test's own sums are the host's.
      std::uint64_t words[sizeof result / 8];
      std::memcpy(words, &result, sizeof words);
      for (const std::uint64_t word : words) hash = hash * 31 + word;
      pushed_n = result.force_n[2] > pushed_n ? result.force_n[2] : pushed_n;
      const float z_m[] = {-0.03f, -0.01f, -0.032f, -0.02f, -0.025f};  // at rest between jumps
      reading.device_from_handle[2] = static_cast<double>(z_m[frame / 100]);
    }
    EXPECT_GT(pushed_n, 1) << state.name;
    forcelayer_close(runtime);
  });
  return hash;
}

TEST(StepArithmetic, NoBitOfARunThroughTheCHeaderDoes) {
  const ScratchFolder folder;
  save_voxmap(folder / "floor.vox", closed(offset_scene(kS, {0, 0, -2}, {48, 40, 8}, 2,
                                                        [](Voxel v) { return v[2] <= 0; })));
  save_pshell(folder / "ball.pshell", sphere_part(0.02, 400, kS));
  const std::uint64_t usual = through_c({"usual", [] {}}, folder);
  for (const HostState& state : host_states()) {
    if (std::string_view(state.name) == "traps") continue;  // the test's own conversions trap
    EXPECT_EQ(through_c(state, folder), usual) << state.name;
  }
}

}  // namespace
}  // namespace forcelayer::test
