// The step takes no memory and no lock and makes no system call: operator new, malloc and its kin,
// the locks of the C library, and every system call of the stepping thread are trapped around 10^5
// steps of both models.
#include <dlfcn.h>
#include <gtest/gtest.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <pthread.h>
#include <semaphore.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <new>
#include <shared_mutex>
#include <stdexcept>
#include <utility>

#include "forcelayer/run.h"
#include "runtime/loop/servo.h"
#include "tests/support/distance_scene.h"
#include "tests/support/motion_bench.h"
#include "tests/support/random_scenes.h"
#include "tests/support/sanitized.h"  // malloc is a sanitizer's, and system calls are too

namespace {

thread_local bool trap_armed = false;
thread_local std::uint64_t trapped = 0;
thread_local std::uint64_t locks_trapped = 0;

void note_allocation() {
  if (trap_armed) ++trapped;
}

void* take(std::size_t size) {
  note_allocation();
  const bool armed = std::exchange(trap_armed, false);  // counted once, not in malloc again
  void* memory = std::malloc(size);
  trap_armed = armed;
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

void* operator new(std::size_t size) { return take(size); }
void* operator new[](std::size_t size) { return take(size); }
// Not inlined: next to a call of `new` gcc would take free() for a mismatch.
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete[](void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }

#if !FORCELAYER_TEST_SANITIZED
// The C library's own, under the names that it leaves for this.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) {
  note_allocation();
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  note_allocation();
  return __libc_calloc(count, size);
}
void* realloc(void* memory, std::size_t size) {
  note_allocation();
  return __libc_realloc(memory, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  note_allocation();
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  note_allocation();
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
  note_allocation();
  *memory = __libc_memalign(alignment, size);
  return *memory == nullptr ? ENOMEM : 0;
}

// Locks, by the names that std::mutex and its kin call them; a waiting atomic calls the system.
#define FORCELAYER_TRAP_LOCK(name, type)                              \
  int name(type* lock) {                                              \
    static const auto next = (int (*)(type*))dlsym(RTLD_NEXT, #name); \
    if (trap_armed) ++locks_trapped;                                  \
    return next(lock);                                                \
  }
FORCELAYER_TRAP_LOCK(pthread_mutex_lock, pthread_mutex_t)
FORCELAYER_TRAP_LOCK(pthread_mutex_trylock, pthread_mutex_t)
FORCELAYER_TRAP_LOCK(pthread_rwlock_rdlock, pthread_rwlock_t)
FORCELAYER_TRAP_LOCK(pthread_rwlock_tryrdlock, pthread_rwlock_t)
FORCELAYER_TRAP_LOCK(pthread_rwlock_wrlock, pthread_rwlock_t)
FORCELAYER_TRAP_LOCK(pthread_rwlock_trywrlock, pthread_rwlock_t)
FORCELAYER_TRAP_LOCK(sem_wait, sem_t)
FORCELAYER_TRAP_LOCK(sem_trywait, sem_t)
#undef FORCELAYER_TRAP_LOCK
}  // extern "C"
#endif

namespace forcelayer::test {
namespace {

constexpr int kSteps = FORCELAYER_TEST_SANITIZED ? 10'000 : 100'000;

// A hand that presses, slides, turns, jumps and sends nonsense.
class TryingInput final : public loop::InputSource {
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

// A ball above a floor, driven by TryingInput.
class Stepping {
 public:
  Stepping(Model model, std::size_t points, unsigned threads) : input_(1) {
    Voxmap voxmap = make_voxmap(
        offset_scene(0.005, {0, 0, -2}, {32, 32, 8}, 2, [](Voxel v) { return v[2] <= 0; }));
    Pshell shell = make_pshell(sphere_part(0.02, points, 0.005));
    RunRequest request;
    request.model = model;
    request.threads = threads;
    auto run = open_run(std::move(voxmap), std::move(shell), request);
    if (!run) throw std::runtime_error(to_line(run.error()));
    simulation_ = run->release_simulation();
    const Pose start{{0.08, 0.08, 0.05}, {1, 0, 0, 0}};
    servo_ = std::make_unique<loop::Servo>(
        *simulation_, input_, simulation_->registered(start, start), loop::OutputLimits{});
  }

  model::Simulation& simulation() { return *simulation_; }

  // Returns the frames that touched.
  int run(int steps) noexcept {
    int touching = 0;
    for (int i = 0; i < steps; ++i) {
      servo_->tick(frame_);
      touching += frame_.result.report.surface > 0;
    }
    return touching;
  }

 private:
  TryingInput input_;
  std::unique_ptr<model::Simulation> simulation_;
  std::unique_ptr<loop::Servo> servo_;
  Frame frame_;
};

TEST(StepMemory, TheTrapWorks) {
  trapped = 0;
  trap_armed = true;
  const auto number = std::make_unique<std::vector<int>>(100);
  trap_armed = false;
  EXPECT_EQ(trapped, 2u);
  if (FORCELAYER_TEST_SANITIZED) return;
  trap_armed = true;
  void* volatile memory = std::malloc(8);
  trap_armed = false;
  std::free(memory);
  EXPECT_EQ(trapped, 3u);
}

TEST(StepLocks, TheTrapWorks) {
  if (FORCELAYER_TEST_SANITIZED) GTEST_SKIP() << "a sanitizer takes locks of its own";
  std::mutex one;
  std::shared_mutex other;
  locks_trapped = 0;
  trap_armed = true;
  one.lock(), one.unlock();
  const bool taken = one.try_lock();
  other.lock_shared();
  trap_armed = false;
  EXPECT_TRUE(taken);
  one.unlock(), other.unlock_shared();
  EXPECT_EQ(locks_trapped, 3u);
}

// Enough points for helpers to have something to do.
std::size_t points_for(unsigned threads) { return threads > 1 ? 40'000 : 200; }

void expect_no_allocation_or_lock(Model model, unsigned threads, int steps) {
  Stepping stepping(model, points_for(threads), threads);
  stepping.simulation().wake_helpers();
  trapped = locks_trapped = 0;
  trap_armed = true;
  const int touching = stepping.run(steps);
  trap_armed = false;
  stepping.simulation().rest_helpers();
  EXPECT_EQ(trapped, 0u);
  EXPECT_EQ(locks_trapped, 0u);
  EXPECT_GT(touching, steps / (threads > 1 ? 50 : 10));
}

TEST(StepMemory, NoStepOfThePaperModelAllocatesOrLocks) {
  expect_no_allocation_or_lock(Model::kPaper, 1, kSteps);
}
TEST(StepMemory, NoStepOfTheDefaultModelAllocatesOrLocks) {
  expect_no_allocation_or_lock(Model::kDefault, 1, kSteps);
}
TEST(StepMemory, NoStepWithHelpersAllocatesOrLocks) {
  expect_no_allocation_or_lock(Model::kDefault, 2, 500);
}

// A block in a corner of three walls, with its edges in those of the corner.
TEST(StepMemory, NoStepInASeatAllocatesOrLocks) {
  const VoxelScene scene = distance_scene(
      0.005, {-12, -12, -8}, {24, 24, 24},
      [](const glm::dvec3& p) {
        return std::min({p.x + 0.015, p.y + 0.012, p.z});
      },
      2, DistanceDefinition(2));
  const Pose at{{0.0003, 0.0003, 0.0101}, {1, 0, 0, 0}};
  MotionBench bench(scene, box_part({0.015, 0.012, 0.01}, 0.004, 0.005), at);
  PartStart start;
  start.world_from_part = at;
  const auto begun = bench.simulation->begin(start, at);
  ASSERT_TRUE(begun) << to_line(begun.error());
  ASSERT_EQ(bench.simulation->seat().size(), 1u);
  bench.state = *begun;
  Random random(1);
  trapped = locks_trapped = 0;
  int seated = 0;
  for (int frame = 0; frame < kSteps / 20; ++frame) {
    Pose hand = at;
    hand.position_m += 0.004 * random_direction(random);
    trap_armed = true;
    const StepResult result = bench.step_to(hand);
    trap_armed = false;
    seated += result.report.surface > 0;
  }
  EXPECT_EQ(trapped, 0u);
  EXPECT_EQ(locks_trapped, 0u);
  EXPECT_GT(seated, kSteps / 40);
}

// The message of the child below to the test.
struct CallReport {
  int refused = 0;  // errno, where the filter cannot be set
  int touching = 0;
  int calls = 0;
  int first_call = -1;
};

volatile sig_atomic_t calls_trapped = 0, first_call_trapped = -1;

void note_call(int, siginfo_t* info, void*) {
  if (calls_trapped == 0) first_call_trapped = info->si_syscall;
  calls_trapped = calls_trapped + 1;
}

// From here on every system call of this thread but those that end it raises SIGSYS instead. False
// where the system has no filters.
bool trap_system_calls() {
  struct sigaction action {};
  action.sa_sigaction = note_call;
  action.sa_flags = SA_SIGINFO;
  sigaction(SIGSYS, &action, nullptr);
  sock_filter program[] = {
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_write, 2, 0),  // the report
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_rt_sigreturn, 1, 0),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_exit_group, 0, 1),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRAP),
  };
  const sock_fprog filter{sizeof program / sizeof *program, program};
  return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
         prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter) == 0;
}

// Runs `steps` steps in a child under the filter; with `provoke`, one system call among them.
CallReport steps_under_filter(Model model, unsigned threads, int steps, bool provoke) {
  int ends[2] = {};
  if (pipe(ends) != 0) throw std::runtime_error("pipe");
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("fork");
  if (child == 0) {
    CallReport report;
    Stepping stepping(model, points_for(threads), threads);
    stepping.simulation().wake_helpers();
    if (trap_system_calls()) {
      report.touching = stepping.run(steps);
      if (provoke) getppid();
    } else {
      report.refused = errno;
    }
    report.calls = calls_trapped;
    report.first_call = first_call_trapped;
    const bool written = write(ends[1], &report, sizeof report) == sizeof report;
    _exit(written ? 0 : 1);
  }
  close(ends[1]);
  CallReport report;
  const bool whole = read(ends[0], &report, sizeof report) == sizeof report;
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  if (!whole || status != 0) throw std::runtime_error("the child ended early");
  return report;
}

void expect_no_system_call(Model model, unsigned threads, int steps) {
  if (FORCELAYER_TEST_SANITIZED) GTEST_SKIP() << "a sanitizer makes system calls of its own";
  const CallReport report = steps_under_filter(model, threads, steps, false);
  if (report.refused != 0) GTEST_SKIP() << "no seccomp here: " << std::strerror(report.refused);
  EXPECT_EQ(report.calls, 0) << "the first was number " << report.first_call;
  EXPECT_GT(report.touching, steps / 50);
}

TEST(StepSystemCalls, TheTrapWorks) {
  if (FORCELAYER_TEST_SANITIZED) GTEST_SKIP() << "a sanitizer makes system calls of its own";
  const CallReport report = steps_under_filter(kDefaultModel, 1, 10, true);
  if (report.refused != 0) GTEST_SKIP() << "no seccomp here: " << std::strerror(report.refused);
  EXPECT_EQ(report.calls, 1);
  EXPECT_EQ(report.first_call, SYS_getppid);
}

TEST(StepSystemCalls, NoStepOfThePaperModelCallsTheSystem) {
  expect_no_system_call(Model::kPaper, 1, 100'000);
}
TEST(StepSystemCalls, NoStepOfTheDefaultModelCallsTheSystem) {
  expect_no_system_call(Model::kDefault, 1, 100'000);
}
TEST(StepSystemCalls, NoStepOfThePaperModelWithHelpersCallsTheSystem) {
  expect_no_system_call(Model::kPaper, 2, 500);
}
TEST(StepSystemCalls, NoStepOfTheDefaultModelWithHelpersCallsTheSystem) {
  expect_no_system_call(Model::kDefault, 2, 500);
}

}  // namespace
}  // namespace forcelayer::test
