#include "runtime/devices/plugin/plugin_device.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "forcelayer/ranges.h"
#include "formats/file/program_folder.h"
#include "runtime/machine/real_time.h"

namespace forcelayer::devices {
namespace {

constexpr long long kPollNs = 2'000'000;
constexpr long long kCloseNs = 2'000'000'000;
constexpr long long kUnopenedNs = 200'000'000;  // for a process that is still in open()
constexpr const char* kSeeManual = "see runtime/devices/plugin/plugin.md";
constexpr int kLinkDescriptor = 3;  // of the shared memory in the process

Error failed(const PluginOptions& options, std::string_view what) {
  return {ErrorCode::kDeviceFailed, options.library.string(), "", what, ""};
}

std::string end_text(int status) {
  if (WIFSIGNALED(status)) {
    return std::string("the process was ended by signal ") + std::to_string(WTERMSIG(status)) +
           " (" + strsignal(WTERMSIG(status)) + ")";
  }
  return "the process ended with status " + std::to_string(WEXITSTATUS(status));
}

// Whether a plugin's process could have said this in order.
bool is_state(PluginState state) {
  return state == PluginState::kStarting || state == PluginState::kOpen ||
         state == PluginState::kFailed || state == PluginState::kLost ||
         state == PluginState::kClosed;
}

std::string text_of(const char* characters, std::size_t room) {
  return {characters, strnlen(characters, room)};
}

// Variables of the environment that a plugin's process gets: those by which programs find their
// files and speak their language, those of SDKs named in plugin.md, those of sanitizers, and what
// is meant for a plugin by its name.
bool is_passed(std::string_view variable) {
  constexpr std::string_view kNames[] = {"PATH=",
                                         "HOME=",
                                         "USER=",
                                         "LOGNAME=",
                                         "LANG=",
                                         "TZ=",
                                         "TMPDIR=",
                                         "XDG_RUNTIME_DIR=",
                                         "LD_LIBRARY_PATH=",
                                         "GTDD_HOME=",
                                         "ASAN_OPTIONS=",
                                         "LSAN_OPTIONS=",
                                         "TSAN_OPTIONS=",
                                         "UBSAN_OPTIONS="};
  for (const std::string_view name : kNames) {
    if (variable.starts_with(name)) return true;
  }
  return variable.starts_with("LC_") || variable.starts_with("FORCELAYER_PLUGIN_");
}

std::vector<char*> passed_environment() {
  std::vector<char*> passed;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    if (is_passed(*variable)) passed.push_back(*variable);
  }
  passed.push_back(nullptr);
  return passed;
}

// The first flaw of a handshake; null where it has none.
const char* flaw(const forcelayer_plugin_info& info) {
  if (info.abi != FORCELAYER_PLUGIN_ABI) return "was built for another version of the interface";
  if (info.si_units != FORCELAYER_PLUGIN_SI_UNITS) return "does not declare SI units";
  if (info.right_handed != FORCELAYER_PLUGIN_RIGHT_HANDED) {
    return "does not declare right-handed coordinate axes";
  }
  if (info.sensed_axes == 0 || ((info.sensed_axes | info.actuated_axes) & ~kAllAxes) != 0) {
    return "senses no axis, or declares more than the six axes";
  }
  // A slower one would hold a force for longer than the longest stale limit.
  const double min_hz = info.actuated_axes == 0 ? 1 : kMinMotorsHz;
  if (!(info.rate_hz >= min_hz && info.rate_hz <= 100'000)) {
    return "must declare a rate of 1 to 100000 Hz, and at least 50 Hz with motors";
  }
  if ((info.actuated_axes & 7u) != 0 && info.max_force_n == 0) return "declares no maximum force";
  if ((info.actuated_axes & 56u) != 0 && info.max_torque_nm == 0)
    return "declares no maximum torque";
  return nullptr;
}

DeviceCapabilities capabilities_of(const forcelayer_plugin_info& info) {
  DeviceCapabilities c;
  c.name = text_of(info.name, sizeof info.name);
  if (c.name.empty()) c.name = "plugin";
  c.sensed_axes = info.sensed_axes;
  c.actuated_axes = info.actuated_axes;
  c.max_force_n = info.max_force_n;
  c.max_torque_nm = info.max_torque_nm;
  c.max_stiffness_n_per_m = info.max_stiffness_n_per_m;
  c.max_stiffness_nm_per_rad = info.max_stiffness_nm_per_rad;
  c.damping_ns_per_m = info.damping_ns_per_m;
  c.damping_nms_per_rad = info.damping_nms_per_rad;
  c.delay_s = info.delay_s;
  c.workspace_radius_m = info.workspace_radius_m;
  c.rate_hz = info.rate_hz;
  c.senses_velocity = info.senses_velocity != 0;
  c.watchdog_s = info.watchdog_s;
  c.hardware = true;
  return c;
}

}  // namespace

PluginDevice::PluginDevice(PluginOptions options) : options_(std::move(options)) {
  if (options_.host.empty()) options_.host = program_folder() / "voxrun-plugin";
}

PluginDevice::~PluginDevice() {
  stop();
  if (link_ != nullptr) munmap(link_, sizeof *link_);
}

Status PluginDevice::launch() {
  // Sealed: were it cut short, the loop's next look at it would end the loop.
  constexpr int kSeals = F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL;
  const int memory = memfd_create("forcelayer-plugin", MFD_CLOEXEC | MFD_ALLOW_SEALING);
  if (memory < 0 || ftruncate(memory, sizeof(PluginLink)) != 0 ||
      fcntl(memory, F_ADD_SEALS, kSeals) != 0) {
    if (memory >= 0) close(memory);
    return failed(options_, "no memory could be shared with the plugin's process");
  }
  void* const mapped =
      mmap(nullptr, sizeof(PluginLink), PROT_READ | PROT_WRITE, MAP_SHARED, memory, 0);
  if (mapped == MAP_FAILED) {
    close(memory);
    return failed(options_, "no memory could be shared with the plugin's process");
  }
  link_ = new (mapped) PluginLink;
  link_->stale_s = options_.stale_s;

  // In a session of its own: Ctrl-C and Ctrl-Z are for the loop, which then says what to do, and
  // the plugin cannot join the loop's process group.
  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, memory, kLinkDescriptor);
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID);
  std::string host = options_.host.string(), library = options_.library.string(),
              parent = std::to_string(getpid()), rights = options_.trusted ? "trusted" : "confined";
  char* const arguments[] = {host.data(),   library.data(), options_.arguments.data(),
                             parent.data(), rights.data(),  nullptr};
  std::vector<char*> environment = passed_environment();
  const int failure =
      posix_spawn(&process_, host.c_str(), &files, &attributes, arguments, environment.data());
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  close(memory);
  if (failure != 0) {
    process_ = -1;
    return failed(options_,
                  "the plugin's process cannot be started: " + std::string(std::strerror(failure)));
  }
  try {
    waiter_ = std::thread([this] { wait_for_end(); });
  } catch (const std::system_error& none) {
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
    process_ = -1;
    return failed(options_, "the thread that waits for the plugin's process cannot be started: " +
                                none.code().message());
  }
  return {};
}

void PluginDevice::wait_for_end() noexcept {
  int status = 0;
  while (waitpid(process_, &status, 0) < 0 && errno == EINTR) {
  }
  exit_status_ = status;
  ended_.store(true, std::memory_order_release);
}

Status PluginDevice::shake_hands() {
  const long long until_ns =
      machine::monotonic_ns() + static_cast<long long>(options_.open_s * 1e9);
  while (link_->state.load(std::memory_order_acquire) == PluginState::kStarting) {
    if (ended_.load(std::memory_order_acquire)) {
      return failed(options_, end_text(exit_status_) + " before the device was open");
    }
    if (options_.stop != nullptr && *options_.stop != 0) {
      return failed(options_, "had not yet opened its device when the run was stopped");
    }
    if (machine::monotonic_ns() > until_ns)
      return failed(options_, "did not open its device in time");
    machine::sleep_until_ns(machine::monotonic_ns() + kPollNs);
  }
  if (link_->state.load(std::memory_order_acquire) == PluginState::kFailed) {
    return failed(options_, text_of(link_->error.data(), link_->error.size()));
  }
  const forcelayer_plugin_info info = link_->info;  // checked and used as it is now
  if (const char* what = flaw(info)) {
    return Error{ErrorCode::kDeviceRefused, options_.library.string(), "handshake", what,
                 kSeeManual};
  }
  const DeviceCapabilities declared = capabilities_of(info);
  if (Status rated = check_ratings(declared); !rated) {
    const Error& error = rated.error();
    return Error{
        ErrorCode::kDeviceRefused, options_.library.string(), "handshake",
        "declares a rating that no hand-held device has: " + error.where + " " + error.what,
        kSeeManual};
  }
  capabilities_ = declared;
  return {};
}

Status PluginDevice::start() {
  std::error_code failure;
  for (auto* path : {&options_.library, &options_.host}) {
    if (std::filesystem::is_regular_file(*path, failure)) {
      // A name without a slash would be looked for in the system's folders of libraries.
      *path = std::filesystem::canonical(*path, failure);
      continue;
    }
    return Error{ErrorCode::kDeviceNotFound, path->string(), "", "no such file",
                 path == &options_.host
                     ? "install voxrun-plugin in the same folder as voxrun"
                     : "give the plugin's library with --device plugin:library=FILE"};
  }
  if (Status launched = launch(); !launched) return launched;
  if (Status agreed = shake_hands(); !agreed) {
    stop();
    return agreed;
  }
  return {};
}

DeviceSample PluginDevice::read(double) noexcept {
  DeviceSample sample;
  const bool fresh = link_ != nullptr && readings_.take(link_->readings, last_);
  if (link_ != nullptr && (!link_->whole() || readings_.broken() || !is_state(link_->state))) {
    overwritten_ = true;
  }
  sample.present = link_ != nullptr && !overwritten_ && !ended_.load(std::memory_order_relaxed) &&
                   link_->state.load(std::memory_order_relaxed) == PluginState::kOpen;
  const forcelayer_plugin_reading& r = last_.reading;
  const double* q = r.orientation_wxyz;
  sample.device_from_handle = {{r.position_m[0], r.position_m[1], r.position_m[2]},
                               glm::dquat(q[0], q[1], q[2], q[3])};
  sample.velocity = {{r.linear_mps[0], r.linear_mps[1], r.linear_mps[2]},
                     {r.angular_radps[0], r.angular_radps[1], r.angular_radps[2]}};
  sample.buttons = r.buttons;
  sample.fresh = fresh;
  sample.calibrated = (r.status & FORCELAYER_PLUGIN_CALIBRATED) != 0 || last_.sequence == 0;
  sample.output_held = last_.output_held != 0 || (r.status & FORCELAYER_PLUGIN_MOTORS_OFF) != 0;
  sample.output_falls = last_.output_falls;
  sample.sequence = last_.sequence;
  return sample;
}

void PluginDevice::write(const Wrench& device_wrench) noexcept {
  if (link_ == nullptr) return;
  PluginCommand command{};
  for (int axis = 0; axis < 3; ++axis) {
    command.wrench.force_n[axis] = device_wrench.force_n[axis];
    command.wrench.torque_nm[axis] = device_wrench.torque_nm[axis];
  }
  command.written_ns = machine::monotonic_ns();
  commands_.put(link_->commands, command);
}

void PluginDevice::stop() noexcept {
  if (process_ < 0) return;
  write({});
  link_->stop.store(1, std::memory_order_release);
  const bool opened = link_->state.load(std::memory_order_acquire) != PluginState::kStarting;
  const long long until_ns = machine::monotonic_ns() + (opened ? kCloseNs : kUnopenedNs);
  while (!ended_.load(std::memory_order_acquire) && machine::monotonic_ns() < until_ns) {
    machine::sleep_until_ns(machine::monotonic_ns() + kPollNs);
  }
  if (!ended_.load(std::memory_order_acquire)) {
    killed_ = true;
    kill(process_, SIGKILL);
  }
  waiter_.join();
  process_ = -1;
}

// The end of the process is the error, unless stop() asked for it.
DeviceTrouble PluginDevice::trouble() const {
  if (link_ == nullptr) return {};
  if (overwritten_) {
    return {"the plugin damaged the memory that it shares with the loop",
            "check the plugin and its SDK, because one of them writes outside its own memory"};
  }
  if (killed_) {
    return {"the plugin hung and was killed",
            "check the plugin and its SDK, because one of their functions does not return"};
  }
  if (link_->state.load() == PluginState::kLost) {
    return {"the plugin lost its device", "check plug and power"};
  }
  const bool crashed = ended_.load() && link_->state.load() != PluginState::kClosed;
  if (!crashed) return {};
  return {"the plugin crashed: " + end_text(exit_status_), "check the plugin and its SDK"};
}

}  // namespace forcelayer::devices
