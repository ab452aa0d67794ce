// voxrun with a haptic device over a real kernel, as a user runs it: what the device's side got.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include "tests/hid_vm/uhid_device.h"
#include "tests/support/hid_descriptors.h"

namespace forcelayer::test {
namespace {

constexpr long long kMs = 1'000'000;

// A run of voxrun in the folder of make_runtime_files.
class Voxrun {
 public:
  explicit Voxrun(const std::string& arguments) {
    std::istringstream words("voxrun floor.vox ball.pshell " + arguments);
    std::vector<std::string> texts;
    for (std::string word; words >> word;) texts.push_back(word);
    std::vector<char*> argv;
    for (std::string& text : texts) argv.push_back(text.data());
    argv.push_back(nullptr);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    for (const int stream : {1, 2}) {
      posix_spawn_file_actions_addopen(&files, stream, stream == 1 ? "out.txt" : "err.txt",
                                       O_WRONLY | O_CREAT | O_TRUNC, 0600);
    }
    started_ = posix_spawn(&process_, "/bin/voxrun", &files, nullptr, argv.data(), environ) == 0;
    posix_spawn_file_actions_destroy(&files);
  }

  void signal(int number) const { kill(process_, number); }

  // Its exit status; what it said on stderr is in said().
  int wait() {
    int status = 0;
    if (!started_ || waitpid(process_, &status, 0) != process_) return -1;
    std::ifstream file("err.txt");
    said_.assign(std::istreambuf_iterator<char>(file), {});
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
  }
  const std::string& said() const { return said_; }

 private:
  pid_t process_ = -1;
  bool started_ = false;
  std::string said_;
};

// Rows of a trace, by column.
std::vector<std::map<std::string, double>> read_trace(const char* path) {
  std::vector<std::map<std::string, double>> rows;
  std::vector<std::string> names;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream cells(line);
    std::map<std::string, double> row;
    std::size_t column = 0;
    for (std::string cell; std::getline(cells, cell, ','); ++column) {
      if (rows.empty() && names.size() == column) names.push_back(cell);
      row[names.at(column)] = std::atof(cell.c_str());
    }
    rows.push_back(row);
  }
  if (!rows.empty()) rows.erase(rows.begin());  // the header
  return rows;
}

struct VoxrunVm : testing::Test {
  void SetUp() override {
    // Comes down on the slab, slides and leaves: the ball's lower end is in the force layer at 30
    // mm.
    unit.device.set_hand([](double t_s) {
      const double down = (1 - std::cos(4 * t_s)) / 2;
      return Pose{{0.1 + 0.01 * down * down, 0.1, 0.045 - 0.018 * down}, {1, 0, 0, 0}};
    });
    unit.plug();
    ASSERT_TRUE(unit.created());
  }
  template <typename Done>
  bool soon(Done done) {
    for (int i = 0; i < 20'000; ++i) {
      if (done()) return true;
      machine::sleep_until_ns(machine::monotonic_ns() + kMs);
    }
    return false;
  }
  bool felt() {
    return soon([&] { return !is_zero(unit.device.motors()); });
  }

  UhidHapticUnit unit;
};

TEST_F(VoxrunVm, TheDeviceFeelsTheWallThatTheReplayComputes) {
  Voxrun run("--device hid --duration 2s --record run.flr --trace run.csv");
  ASSERT_EQ(run.wait(), 0) << run.said();
  std::printf("voxrun said: %s\n", run.said().c_str());
  Voxrun replay("--replay run.flr --as-fast-as-possible --trace again.csv --quiet");
  ASSERT_EQ(replay.wait(), 0) << replay.said();

  const auto rows = read_trace("again.csv");
  ASSERT_EQ(rows.size(), 2000u);
  const char* const columns[6] = {"device_force_x_n",   "device_force_y_n",   "device_force_z_n",
                                  "device_torque_x_nm", "device_torque_y_nm", "device_torque_z_nm"};
  std::vector<bool> seen(rows.size());
  std::size_t differing = 0, faded = 0;
  std::int32_t largest_un = 0;
  for (const auto& taken : unit.device.log()) {
    const std::size_t frame = taken.frame - 1;  // frames count from 1 in the reports
    if (frame >= rows.size()) continue;         // the loop's last word: zero
    if (taken.flags != 1) {
      ++faded;
      continue;
    }
    bool same = true;
    for (int i = 0; i < 6; ++i) {
      const std::int32_t got = i < 3 ? taken.wrench.force_un[i] : taken.wrench.torque_unm[i - 3];
      same &= got == static_cast<std::int32_t>(std::nearbyint(rows[frame].at(columns[i]) * 1e6));
    }
    differing += !same;
    seen[frame] = true;
    largest_un = std::max(largest_un, taken.motors.force_un[2]);
  }
  const auto arrived = static_cast<std::size_t>(std::count(seen.begin(), seen.end(), true));
  std::printf(
      "voxrun --device hid: %zu of %zu frames' wrenches arrived, %zu differ from the replay, "
      "%zu faded; largest push %.3f N\n",
      arrived, rows.size(), differing, faded, largest_un * 1e-6);
  EXPECT_EQ(differing, 0u);
  EXPECT_GE(arrived, rows.size() * 99 / 100);
  EXPECT_GT(largest_un, 1'000'000);
  EXPECT_TRUE(is_zero(unit.device.motors()));
}

TEST_F(VoxrunVm, AStoppedHostIsSeenByTheDevicesWatchdog) {
  Voxrun run("--device hid --duration 60s");
  ASSERT_TRUE(felt());
  run.signal(SIGSTOP);
  ASSERT_TRUE(soon([&] { return unit.device.watchdog_holds(); }));
  EXPECT_TRUE(is_zero(unit.device.motors()));
  const std::size_t logged = unit.device.log().size();
  run.signal(SIGCONT);
  EXPECT_EQ(run.wait(), 5) << run.said();  // a trip ends the run, with its reason
  EXPECT_NE(run.said().find("zero"), std::string::npos) << run.said();
  std::printf("after SIGSTOP, voxrun said: %s", run.said().c_str());
  const auto log = unit.device.log();
  for (std::size_t i = logged; i < log.size(); ++i) EXPECT_TRUE(is_zero(log[i].motors)) << i;
}

TEST_F(VoxrunVm, AnUnpluggedDeviceEndsTheRunWithItsReason) {
  Voxrun run("--device hid --duration 60s");
  ASSERT_TRUE(felt());
  unit.unplug();
  EXPECT_EQ(run.wait(), 5) << run.said();
  std::printf("after unplugging, voxrun said: %s", run.said().c_str());
  EXPECT_TRUE(soon([&] { return unit.device.watchdog_holds(); }));
}

TEST_F(VoxrunVm, AnEndBySignalIsZeroAtOnceAKillByTheWatchdog) {
  Voxrun run("--device hid --duration 60s");
  ASSERT_TRUE(felt());
  run.signal(SIGTERM);
  EXPECT_EQ(run.wait(), 143) << run.said();
  const auto log = unit.device.log();
  ASSERT_FALSE(log.empty());
  EXPECT_TRUE(is_zero(log.back().motors));
  EXPECT_EQ(log.back().flags & 1, 0);  // its last word: motors off
  Voxrun killed("--device hid --duration 60s");
  ASSERT_TRUE(felt());
  killed.signal(SIGKILL);
  EXPECT_EQ(killed.wait(), 1009);
  EXPECT_TRUE(soon([&] { return unit.device.watchdog_holds(); }));
  EXPECT_TRUE(is_zero(unit.device.motors()));
}

TEST_F(VoxrunVm, AFrozenDeviceEndsTheRun) {
  Voxrun run("--device hid --duration 60s");
  ASSERT_TRUE(felt());
  unit.device.set_fault(VirtualHapticDevice::Fault::kRepeating);
  EXPECT_EQ(run.wait(), 5) << run.said();
  std::printf("frozen, voxrun said: %s", run.said().c_str());
  EXPECT_TRUE(is_zero(unit.device.motors()));
}

TEST_F(VoxrunVm, AWatchdogThatTripsIsSaidWithWhatToDo) {
  Voxrun run("--device hid --duration 60s");
  ASSERT_TRUE(felt());
  unit.device.set_fault(VirtualHapticDevice::Fault::kDeaf);
  EXPECT_EQ(run.wait(), 5) << run.said();
  std::printf("unheard, voxrun said: %s", run.said().c_str());
  EXPECT_NE(run.said().find("watchdog tripped"), std::string::npos) << run.said();
  EXPECT_NE(run.said().find("doctor"), std::string::npos) << run.said();
  EXPECT_TRUE(is_zero(unit.device.motors()));
}

// A cap that is pushed down: the part comes down on the slab and stays on it; nothing is felt, and
// that is said; a replay is the same.
TEST(VoxrunVmSpaceMouse, MovesThePartOntoTheWall) {
  std::mutex mutex;
  std::vector<std::vector<std::uint8_t>> written;
  UhidDevice cap({"SpaceMouse Pro", "", 0x256f, 0xc635}, combined_spacemouse(), [&](auto report) {
    const std::lock_guard lock(mutex);
    written.emplace_back(report.begin(), report.end());
  });
  ASSERT_TRUE(cap.created());
  std::atomic<bool> stop{false};
  std::thread hand([&] {
    const std::vector<std::uint8_t> down{1, 0, 0, 0, 0, 0x5e, 1, 0, 0, 0, 0, 0, 0};  // all the way
    for (; !stop; machine::sleep_until_ns(machine::monotonic_ns() + 10 * kMs)) cap.send(down);
  });
  Voxrun run(
      "--device spacemouse --world-from-device 0.1m,0.1m,0.1m --duration 1s --record cap.flr "
      "--trace cap.csv --json cap.json");
  const int status = run.wait();
  stop = true;
  hand.join();
  ASSERT_EQ(status, 0) << run.said();
  EXPECT_NE(run.said().find("no force will be felt"), std::string::npos) << run.said();
  const auto rows = read_trace("cap.csv");
  ASSERT_EQ(rows.size(), 1000u);
  std::printf("voxrun --device spacemouse: the cap went to z = %.1f mm, the part to %.1f mm\n",
              1e3 * rows.back().at("handle_z_m"), 1e3 * rows.back().at("part_z_m"));
  EXPECT_NEAR(rows.front().at("part_z_m"), 0.1, 1e-3);
  EXPECT_LT(rows.back().at("handle_z_m"), 0.025);  // at 0.1 m/s
  EXPECT_GT(rows.back().at("part_z_m"), 0.03);     // the ball's lower end: in the force layer
  EXPECT_GT(rows.back().at("force_z_n"), 1);
  std::ifstream file("cap.json");
  const std::string report(std::istreambuf_iterator<char>(file), {});
  EXPECT_NE(report.find("\"actuated_axes\": []"), std::string::npos) << report;

  Voxrun replay("--replay cap.flr --as-fast-as-possible --trace again.csv --quiet");
  ASSERT_EQ(replay.wait(), 0) << replay.said();
  const auto again = read_trace("again.csv");
  ASSERT_EQ(again.size(), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (const auto& [column, value] : rows[i]) {
      if (column == "step_ns") continue;
      ASSERT_EQ(again[i].at(column), value) << column << " of row " << i;
    }
  }
  const std::lock_guard lock(mutex);
  ASSERT_GE(written.size(), 2u);  // its LED: on, then off
  EXPECT_EQ(written.front(), (std::vector<std::uint8_t>{4, 1}));
  EXPECT_EQ(written.back(), (std::vector<std::uint8_t>{4, 0}));
}

TEST(VoxrunVmStart, SaysWhatIsMissing) {
  Voxrun none("--device hid --duration 1s");
  EXPECT_EQ(none.wait(), 5);
  EXPECT_NE(none.said().find("plugged in"), std::string::npos) << none.said();
  Voxrun wrong("--device hid:id=nonsense --duration 1s");
  EXPECT_EQ(wrong.wait(), 2);
}

}  // namespace
}  // namespace forcelayer::test
