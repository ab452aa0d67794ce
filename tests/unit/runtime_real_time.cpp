// Real-time priority for the threads that help the loop.
#include "runtime/machine/real_time.h"

#include <gtest/gtest.h>
#include <sched.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "runtime/query/query_workers.h"

namespace forcelayer::test {
namespace {

// Priorities of this process's threads that run under SCHED_FIFO (proc(5): fields 40 and 41).
std::vector<int> fifo_priorities() {
  std::vector<int> priorities;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    std::ifstream file(task.path() / "stat");
    std::string text((std::istreambuf_iterator<char>(file)), {});
    std::istringstream fields(text.substr(text.rfind(')') + 2));
    std::vector<std::string> from_third{std::istream_iterator<std::string>(fields), {}};
    if (from_third.at(41 - 3) == "1") priorities.push_back(std::stoi(from_third.at(40 - 3)));
  }
  return priorities;
}

bool fifo_is_granted() {
  bool granted = false;
  std::thread([&] { granted = machine::take_real_time_priority().empty(); }).join();
  return granted;
}

std::size_t cores() {
  cpu_set_t set;
  EXPECT_EQ(sched_getaffinity(0, sizeof set, &set), 0);
  return static_cast<std::size_t>(CPU_COUNT(&set));
}

void expect_work(query::QueryWorkers& workers) {
  std::atomic<int> done{0};
  const auto count = [](void* context, std::uint32_t) noexcept {
    ++*static_cast<std::atomic<int>*>(context);
  };
  workers.wake();
  for (int run = 1; run <= 100; ++run) {
    workers.run(count, &done, 50);
    EXPECT_EQ(done, 50 * run);
  }
  workers.rest();
}

TEST(RealTime, HelpersRunAStepBelowTheLoop) {
  if (cores() < 2) GTEST_SKIP() << "one core: helpers keep their priority";
  query::QueryWorkers workers(1);
  EXPECT_TRUE(fifo_priorities().empty());
  const auto warnings = workers.take_real_time_priority();
  if (fifo_is_granted()) {
    EXPECT_TRUE(warnings.empty()) << warnings.at(0);
    EXPECT_EQ(fifo_priorities(), std::vector<int>{79});
  } else {
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_NE(warnings[0].find("helper threads"), std::string::npos) << warnings[0];
    EXPECT_TRUE(fifo_priorities().empty());
  }
  expect_work(workers);
}

// Helpers that the loop spins for must not need its core.
TEST(RealTime, MoreThreadsThanCoresKeepTheirPriority) {
  query::QueryWorkers workers(static_cast<unsigned>(cores()));
  const auto warnings = workers.take_real_time_priority();
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("cores"), std::string::npos) << warnings[0];
  EXPECT_TRUE(fifo_priorities().empty());
  expect_work(workers);
}

}  // namespace
}  // namespace forcelayer::test
