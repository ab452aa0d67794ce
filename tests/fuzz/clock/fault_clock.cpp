// fault_clock [--frames N] [--seed N] [--model default|paper]: a loop at 1 kHz, as voxrun builds
// it, with a plugin in a process of its own, while at random the plugin's readings fail, it hangs,
// is stopped, crashes, or writes over the shared memory; the loop's process is stopped; all cores
// are busy; whoever takes the frames stalls; the baked files are moved, linked, written to,
// touched, or cut, which must change nothing. Frames are judged in the loop (frame_judge.h), motors
// in the plugin (clock_plugin.c): from what was injected, without a look at the gate. One line of
// JSON at the end; status 1 where a promise was broken, which stderr says.
#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <charconv>
#include <chrono>
#include <cstring>
#include <ctime>
#include <fstream>
#include <random>
#include <thread>
#include <utility>

#include "forcelayer/run.h"
#include "runtime/devices/plugin/plugin_device.h"
#include "runtime/loop/loop.h"
#include "tests/fuzz/clock/frame_judge.h"
#include "tests/support/places.h"
#include "tests/support/point_part.h"
#include "tests/support/voxel_scene.h"

namespace forcelayer::test {
namespace {

constexpr double kS = 0.005;

void sleep_ms(long ms) { std::this_thread::sleep_for(std::chrono::milliseconds(ms)); }

VoxelScene slab() {
  return closed(offset_scene(kS, {0, 0, -2}, {48, 48, 8}, 2, [](Voxel v) { return v[2] <= 0; }));
}

// Stops processes for a time. A process of its own, since it stops this one too.
class Stopper {
 public:
  Stopper() {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
    process_ = fork();
    if (process_ == 0) {
      close(ends[1]);
      serve(ends[0]);
    }
    close(ends[0]);
    to_ = ends[1];
  }
  ~Stopper() {
    close(to_);
    waitpid(process_, nullptr, 0);
  }
  Stopper(const Stopper&) = delete;
  Stopper& operator=(const Stopper&) = delete;

  void stop(pid_t process, long ms) const {
    const long order[] = {process, ms};
    if (write(to_, order, sizeof order) != sizeof order) throw std::runtime_error("no stopper");
  }

 private:
  [[noreturn]] static void serve(int from) {
    long order[2];
    while (read(from, order, sizeof order) == sizeof order) {
      const auto process = static_cast<pid_t>(order[0]);
      if (process <= 0 || kill(process, SIGSTOP) != 0) continue;
      usleep(static_cast<useconds_t>(order[1] * 1000));
      kill(process, SIGCONT);
    }
    _exit(0);
  }

  pid_t process_ = 0;
  int to_ = -1;
};

// The truth, in a file that the plugin maps too.
class SharedTruth {
 public:
  explicit SharedTruth(const std::filesystem::path& path) {
    const int file = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (file < 0 || ftruncate(file, sizeof(truth)) != 0) throw std::runtime_error("no truth");
    mapped_ = static_cast<truth*>(
        mmap(nullptr, sizeof(truth), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0));
    close(file);
    if (mapped_ == MAP_FAILED) throw std::runtime_error("no truth");
  }
  ~SharedTruth() { munmap(mapped_, sizeof *mapped_); }
  SharedTruth(const SharedTruth&) = delete;
  SharedTruth& operator=(const SharedTruth&) = delete;
  truth& operator*() const { return *mapped_; }

 private:
  truth* mapped_;
};

struct Sums {
  FrameJudge::Counts frames;
  std::uint64_t orders = 0, stops = 0, busy = 0, stalls = 0, harmless = 0, changed = 0, ended = 0,
                trips = 0, dropped = 0, motor_writes = 0, motor_forces = 0;
};

// One run: some seconds of faults that pass, then one that does not.
class Episode {
 public:
  Episode(Model model, std::uint64_t seed, const Stopper& stopper, Sums& sums)
      : random_(seed), stopper_(stopper), sums_(sums), shared_(folder_ / "truth") {
    save_voxmap(folder_ / "scene.vox", slab());
    save_pshell(folder_ / "part.pshell", sphere_part(0.02, 120, kS));
    devices::PluginOptions options;
    options.library = command_path("clock_plugin.so");
    options.host = command_path("voxrun-plugin");
    options.arguments = "truth=" + (folder_ / "truth").string() +
                        " seed=" + std::to_string(seed % 1'000'000'007) +
                        " velocity=" + std::to_string(seed % 2);
    device_ = std::make_unique<devices::PluginDevice>(std::move(options));
    must(device_->start());
    RunRequest request = default_run_request(folder_ / "scene.vox", folder_ / "part.pshell");
    request.model = model;
    request.device = device_->capabilities();
    request.without_guarantee = true;
    auto run = open_run(request);
    if (!run) must(run.error());
    run_.emplace(std::move(*run));
    limits_.max_force_n = request.device.max_force_n;
    limits_.max_torque_nm = request.device.max_torque_nm;
  }

  // True where all promises held.
  bool play(std::uint64_t frames) {
    loop::DeviceInput input(*device_, {});
    const Voxmap map = make_voxmap(slab());
    const Pshell shell = make_pshell(sphere_part(0.02, 120, kS));
    FrameJudge judge(input, *shared_, limits_, map, shell.view());
    const model::Simulation& simulation = run_->simulation();
    const Pose hand{{0.1, 0.1, 0.05}, {1, 0, 0, 0}};
    loop::Servo servo(run_->simulation(), judge, simulation.registered(hand, hand), limits_);
    servo.set_clutch_buttons(1);
    machine::SpscRing<Frame> ring(256);
    std::atomic<int> stop{0};
    loop::LoopOptions options;
    options.stop = &stop;
    loop::LoopStatistics statistics;
    std::atomic<bool> ended{false};
    std::thread loop([&] {
      run_->make_real_time();
      loop::run_loop(servo, options, &ring, statistics);
      ended.store(true);
    });
    std::thread taker([&] { take_frames(ring, ended); });
    std::thread storm([&] { rage(judge, servo, frames, ended); });
    storm.join();
    stop.store(1);
    loop.join();
    taker.join();
    device_->stop();
    return settle(judge, servo, statistics);
  }

 private:
  static void must(const Status& status) {
    if (status) return;
    std::fprintf(stderr, "%s\n", to_line(status.error()).c_str());
    std::exit(2);
  }
  std::uint64_t below(std::uint64_t n) { return random_() % n; }

  // The reader of the frames, who stalls when told to.
  void take_frames(machine::SpscRing<Frame>& ring, const std::atomic<bool>& ended) {
    Frame frame;
    while (!ended.load()) {
      sleep_ms(1 + stall_ms_.exchange(0));
      while (ring.pop(frame)) {
        // Where the hand has the part, for the plugin's choice of places. Some frames old.
        const glm::dvec3 at = glm::conjugate(frame.input.world_from_handle.orientation) *
                              (frame.result.report.world_from_center.position_m -
                               frame.input.world_from_handle.position_m);
        if (frame.input.valid == kInputValid && glm::length(at) < 0.5) {
          for (int axis = 0; axis < 3; ++axis) (*shared_).grip_m[axis] = at[axis];
        }
      }
    }
  }

  void rage(FrameJudge& judge, loop::Servo& servo, std::uint64_t frames,
            const std::atomic<bool>& ended) {
    while (!ended.load() && judge.frames() < frames && (*shared_).broken == 0) {
      constexpr long kCalmsMs[] = {1, 5, 30, 100, 400, 1000};
      sleep_ms(kCalmsMs[below(6)]);
      if (judge.output_state() == OutputState::kTripped && below(3) != 0) {
        servo.set_clutch(true);
        sleep_ms(80);
        servo.set_clutch(false);
        sleep_ms(300);
        continue;
      }
      pass_by();
    }
    if (!ended.load()) finish(judge, ended);
  }

  // A fault that passes.
  void pass_by() {
    constexpr std::uint32_t kRows[] = {1, 3, 6, 50, 250};
    constexpr long kStopsMs[] = {1, 3, 7, 20, 100};
    switch (below(10)) {
      case 0:
        ++sums_.stops;
        return stopper_.stop(getpid(), kStopsMs[below(5)]);
      case 1:
        ++sums_.stops;
        return stopper_.stop((*shared_).process, kStopsMs[below(5)]);
      case 2:
        return keep_cores_busy(kStopsMs[below(5)]);
      case 3:
        ++sums_.stalls;
        return stall_ms_.store(1000);
      case 4:
        return do_no_harm();
      default:
        ++sums_.orders;
        return order(FAULT_NAN + static_cast<std::uint32_t>(below(FAULT_FOR_GOOD - FAULT_NAN)),
                     kRows[below(5)]);
    }
  }

  void order(std::uint32_t fault, std::uint32_t readings) {
    store((*shared_).order_readings, readings);
    store((*shared_).order, fault);
  }

  // Before the loop's thread, where this process may.
  void keep_cores_busy(long ms) {
    ++sums_.busy;
    const auto until = std::chrono::steady_clock::now() + std::chrono::milliseconds(ms);
    std::vector<std::thread> busy;
    for (unsigned core = 0; core < std::thread::hardware_concurrency(); ++core) {
      busy.emplace_back([until] {
        sched_param first{};
        first.sched_priority = 98;
        (void)sched_setscheduler(0, SCHED_FIFO, &first);
        while (std::chrono::steady_clock::now() < until) {
        }
      });
    }
    for (std::thread& thread : busy) thread.join();
  }

  std::filesystem::path& file() { return files_[below(2)]; }

  // To the names of a file, to its rights, and to what is in it.
  void do_no_harm() {
    std::filesystem::path& path = file();
    if (below(2) == 0) return change(path);
    const std::uint64_t n = ++sums_.harmless;
    const std::filesystem::path other = folder_ / ("name" + std::to_string(n));
    switch (below(3)) {
      case 0:
        return std::filesystem::create_hard_link(path, other);
      case 1:
        std::filesystem::rename(path, other);
        path = other;
        return;
      default:
        chmod(path.c_str(), 0600 | static_cast<mode_t>(n % 0100));
    }
  }

  // The content of a file, or its times.
  void change(const std::filesystem::path& path) {
    ++sums_.changed;
    const auto bytes = std::filesystem::file_size(path);
    const auto written = std::filesystem::last_write_time(path);
    std::string noise(1 + below(bytes), 0);
    for (char& byte : noise) byte = static_cast<char>(below(256));
    std::fstream stream(path, std::ios::in | std::ios::out | std::ios::binary);
    switch (below(4)) {
      case 0:
        std::filesystem::resize_file(path, below(2) ? 0 : below(bytes + 1));
        return;
      case 1:
        stream.write(noise.data(), static_cast<std::streamsize>(noise.size()));
        return;
      case 2:  // and its times set back
        stream.write(noise.data(), static_cast<std::streamsize>(noise.size()));
        stream.close();
        std::filesystem::last_write_time(path, written);
        return;
      default:
        std::filesystem::last_write_time(path, written + std::chrono::seconds(1));
    }
  }

  // A fault that does not pass, and some frames after it.
  void finish(FrameJudge& judge, const std::atomic<bool>& ended) {
    const std::uint64_t begin = judge.frames();
    ++sums_.ended;
    order(FAULT_FOR_GOOD + static_cast<std::uint32_t>(below(FAULT_KINDS - FAULT_FOR_GOOD)), 1);
    for (int ms = 0; ms < 5000 && !ended.load() && judge.frames() <= begin + 200; ++ms) sleep_ms(1);
  }

  bool settle(const FrameJudge& judge, const loop::Servo& servo,
              const loop::LoopStatistics& statistics) {
    const truth& shared = *shared_;
    const FrameJudge::Counts& counts = judge.counts();
    const int broken = counts.broken + static_cast<int>(shared.broken);
    if (broken > 0) std::fprintf(stderr, "%s %s\n", judge.what(), shared.what);
    sums_.frames.frames += counts.frames;
    sums_.frames.refused += counts.refused;
    sums_.frames.late += counts.late;
    sums_.frames.touching += counts.touching;
    sums_.frames.with_force += counts.with_force;
    sums_.frames.broken += broken;
    sums_.trips += servo.output().trips();
    sums_.dropped += statistics.dropped_frames;
    sums_.motor_writes += shared.motor_writes;
    sums_.motor_forces += shared.motor_forces;
    return broken == 0;
  }

  std::mt19937_64 random_;
  const Stopper& stopper_;
  Sums& sums_;
  ScratchFolder folder_;
  std::filesystem::path files_[2] = {folder_ / "scene.vox", folder_ / "part.pshell"};
  SharedTruth shared_;
  std::unique_ptr<devices::PluginDevice> device_;
  std::optional<Run> run_;
  loop::OutputLimits limits_;
  std::atomic<long> stall_ms_{0};
};

std::uint64_t number(const char* text) {
  std::uint64_t value = 0;
  std::from_chars(text, text + std::strlen(text), value);
  return value;
}

void print(const char* model, std::uint64_t seed, const Sums& s, std::time_t seconds) {
  const std::pair<const char*, std::uint64_t> figures[] = {
      {"seed", seed},
      {"frames", s.frames.frames},
      {"refused", s.frames.refused},
      {"late", s.frames.late},
      {"touching", s.frames.touching},
      {"with_force", s.frames.with_force},
      {"trips", s.trips},
      {"dropped", s.dropped},
      {"motor_writes", s.motor_writes},
      {"motor_forces", s.motor_forces},
      {"plugin_faults", s.orders},
      {"stops", s.stops},
      {"busy", s.busy},
      {"stalls", s.stalls},
      {"harmless", s.harmless},
      {"files_changed", s.changed},
      {"plugins_ended", s.ended},
      {"seconds", static_cast<std::uint64_t>(seconds)},
      {"broken", static_cast<std::uint64_t>(s.frames.broken)}};
  std::printf("{\"model\": \"%s\"", model);
  for (const auto& [name, value] : figures) {
    std::printf(", \"%s\": %llu", name, static_cast<unsigned long long>(value));
  }
  std::printf("}\n");
}

int run(int argc, char** argv) {
  std::uint64_t frames = 8000, seed = 1;
  const char* model = "default";
  for (int i = 1; i + 1 < argc; i += 2) {
    if (std::strcmp(argv[i], "--frames") == 0) frames = number(argv[i + 1]);
    if (std::strcmp(argv[i], "--seed") == 0) seed = number(argv[i + 1]);
    if (std::strcmp(argv[i], "--model") == 0) model = argv[i + 1];
  }
  constexpr std::uint64_t kEpisode = 8000;
  const bool paper = std::strcmp(model, "paper") == 0;
  const Stopper stopper;
  const std::time_t begin = std::time(nullptr);
  Sums sums;
  for (std::uint64_t n = 0; sums.frames.frames < frames && sums.frames.broken == 0; ++n) {
    Episode episode(paper ? Model::kPaper : Model::kDefault, seed * 1'000'003 + n, stopper, sums);
    episode.play(std::min(kEpisode, frames - sums.frames.frames));
  }
  print(model, seed, sums, std::time(nullptr) - begin);
  return sums.frames.broken > 0 ? 1 : 0;
}

}  // namespace
}  // namespace forcelayer::test

int main(int argc, char** argv) { return forcelayer::test::run(argc, argv); }
