#include "formats/mesh/sandbox/sandbox.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <limits>
#include <mutex>
#include <system_error>

#include "formats/command/progress_line.h"
#include "formats/file/confinement.h"
#include "formats/mesh/reader.h"
#include "formats/mesh/sandbox/assembly_stream.h"
#include "formats/mesh/up_axis.h"

namespace forcelayer::mesh {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kChildOption = "--read-mesh-for-sandbox";
constexpr int kResultDescriptor = 3, kProgressDescriptor = 4;
constexpr int kNotStarted = 127;
constexpr int kToldAfterS = 20;  // without a word from the child

// Sanitizers reserve terabytes of addresses, so a limit on addresses would stop them.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kLimitsMemory = false;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
constexpr bool kLimitsMemory = false;
#else
constexpr bool kLimitsMemory = true;
#endif
#else
constexpr bool kLimitsMemory = true;
#endif

bool main_is_ready = false;

std::string exact_text(double number) {
  char digits[64];
  return {digits, std::to_chars(digits, digits + sizeof digits, number).ptr};
}

void limit(__rlimit_resource_t resource, std::uint64_t amount) {
  const rlimit both{amount, amount};
  ::setrlimit(resource, &both);
}

// Between fork and exec, in a child of a process with threads: system calls and nothing else.
[[noreturn]] void become_reader(int result, int progress, pid_t parent, const SandboxLimits& limits,
                                char* const* arguments) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(kNotStarted);  // it died before the line above
  const int null = ::open("/dev/null", O_RDWR);
  for (int number = 0; number < 3; ++number) ::dup2(null, number);
  // Out of the way of each other; copies are not closed by exec.
  const int own_result = ::fcntl(result, F_DUPFD, kProgressDescriptor + 1),
            own_progress = ::fcntl(progress, F_DUPFD, kProgressDescriptor + 1);
  ::dup2(own_result, kResultDescriptor);
  ::dup2(own_progress, kProgressDescriptor);
  ::close_range(kProgressDescriptor + 1, ~0u, 0);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_FSIZE, 0);
  if (kLimitsMemory) limit(RLIMIT_AS, limits.memory_bytes);
  ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  ::execv("/proc/self/exe", arguments);
  ::_exit(kNotStarted);
}

Error no_child(const std::string& path, int number) {
  return {ErrorCode::kInternal, path, "",
          "the sandbox for this file cannot be started: " + std::generic_category().message(number),
          ""};
}

std::string in_gib(std::uint64_t bytes) {
  char text[40];
  std::snprintf(text, sizeof text, "%.3g GiB", static_cast<double>(bytes) * 0x1p-30);
  return text;
}

Error too_much_memory(const std::string& path, const SandboxLimits& limits) {
  return {ErrorCode::kMeshUnreadable, path, "",
          "reading this file takes more memory than the sandbox's limit of " +
              in_gib(limits.memory_bytes),
          "raise --sandbox=memory= if you trust the file"};
}

Error too_late(const std::string& path, const SandboxLimits& limits) {
  return {ErrorCode::kMeshUnreadable, path, "",
          "reading this file takes longer than the sandbox's limit of " +
              exact_text(limits.time_s) + " s",
          "raise --sandbox=time= if you trust the file"};
}

std::string deflection_text(const std::string& path, const ReadOptions& options) {
  if (!may_crash_its_reader(path) || !(options.deflection_m > 0)) return "";
  return ": the deflection is " + exact_text(1e3 * options.deflection_m) +
         " mm (a hundredth of a voxel); larger voxels make reading faster";
}

constexpr double kMinuteS = 60, kGigabyte = 1e9;

// The forecast of a large file that OpenCASCADE parses, by its size: time and memory of a byte are
// those of an assembly of plain solids, without what tessellation takes.
void tell_if_large(const std::string& path) {
  constexpr double kSecondsPerByte = 0.32e-6, kBytesPerByte = 10;
  std::error_code failure;
  const auto size = static_cast<double>(std::filesystem::file_size(path, failure));
  const double seconds = kSecondsPerByte * size, bytes = kBytesPerByte * size;
  if (failure || !may_crash_its_reader(path)) return;
  if (seconds <= kMinuteS && bytes <= kGigabyte) return;
  char text[120];
  std::snprintf(
      text, sizeof text,
      ": parsing its %.3g MB takes about %.2g minutes and %.2g GB of memory; Ctrl-C stops it",
      1e-6 * size, seconds / kMinuteS, bytes / kGigabyte);
  command::tell_waiting(path + text);
}

// The forecast of surfaces that take long. Time and memory of a triangle are those of a free-form
// surface of one face, which needs the most.
void tell_if_expensive(const ReadingProgress& forecast, const std::string& path,
                       const ReadOptions& options) {
  constexpr double kSecondsPerTriangle = 1.1e-5, kBytesPerTriangle = 2000;
  const double seconds = kSecondsPerTriangle * forecast.expected_triangles,
               bytes = kBytesPerTriangle * forecast.expected_triangles;
  if (seconds <= kMinuteS && bytes <= kGigabyte) return;
  char text[120];
  std::snprintf(text, sizeof text,
                " becomes about %.2g million triangles, which take about %.2g minutes and up to "
                "%.2g GB of memory",
                1e-6 * forecast.expected_triangles, seconds / kMinuteS, bytes / kGigabyte);
  command::tell_waiting(path + text + deflection_text(path, options) + "; Ctrl-C stops it");
}

// Milliseconds to wait for, for poll().
int wait_until(Clock::time_point end) {
  using std::chrono::milliseconds;
  constexpr milliseconds kLongest = std::chrono::hours(1);
  const auto left = std::chrono::duration_cast<milliseconds>(end - Clock::now());
  return static_cast<int>(std::clamp(left, milliseconds(0), kLongest).count());
}

// Hands on the progress of the child until it begins to send its result, or the deadline is past.
// How long OpenCASCADE takes is not known well beforehand, so a long wait is announced.
void follow_progress(int result, int progress, const std::string& path, const ReadOptions& options,
                     Clock::time_point deadline) {
  const auto slow = Clock::now() + std::chrono::seconds(kToldAfterS);
  bool is_told = deadline <= slow, is_open = true;
  while (Clock::now() < deadline) {
    pollfd ends[2] = {{result, POLLIN, 0}, {is_open ? progress : -1, POLLIN, 0}};
    const int ready = ::poll(ends, 2, wait_until(is_told ? deadline : slow));
    if (ready < 0 && errno != EINTR) return;
    if (ready == 0 && !is_told && Clock::now() >= slow) {
      is_told = true;
      command::tell_waiting(path + " is still being read after " + std::to_string(kToldAfterS) +
                            " s" + deflection_text(path, options) +
                            "; Ctrl-C stops it, and --sandbox=time=5min sets a limit");
    }
    if (ready <= 0) continue;
    if (ends[0].revents != 0) return;
    ReadingProgress told;
    is_open = ::read(progress, &told, sizeof told) == sizeof told;
    if (!is_open || !(told.fraction_done >= 0 && told.fraction_done <= 1)) continue;
    if (told.fraction_done == 0) tell_if_expensive(told, path, options);
    if (options.progress) options.progress(told);
  }
}

// The error for a child that ended with this status and sent no mesh.
Error no_mesh(const std::string& path, int status) {
  std::string what = "the reader of this file sent a damaged mesh";
  if (WIFSIGNALED(status)) {
    what = std::string("the reader of this file crashed (") + ::strsignal(WTERMSIG(status)) + ")";
  } else if (WIFEXITED(status) && WEXITSTATUS(status) == kNotStarted) {
    return {ErrorCode::kInternal, path, "", "the sandbox for this file did not start",
            "raise the limit --sandbox=memory="};
  } else if (WIFEXITED(status) && WEXITSTATUS(status) != 0) {
    what = "the reader of this file ended with status " + std::to_string(WEXITSTATUS(status));
  }
  return {ErrorCode::kMeshUnreadable, path, "", what,
          "export the mesh again, or use another format"};
}

// The reader's process reads below the folders of the file, as it is named and as it lies, and what
// belongs to the system; it writes nothing. Where the kernel cannot see to that, what the reader
// itself refuses remains (confined_path.h).
void give_up_rights(const std::string& path, bool allow_outside) {
  namespace fs = std::filesystem;
  std::error_code failure;
  std::vector<std::string> readable = {"/usr", "/lib",       "/lib64", "/etc",
                                       "/sys", "/proc/self", "/dev"};
  const fs::path named = fs::absolute(path, failure);
  readable.push_back(named.parent_path().string());
  readable.push_back(fs::weakly_canonical(named, failure).parent_path().string());
  if (allow_outside) readable = {"/"};
  confine_files({}, readable);
  confine_system_calls(CallsOf::kReader);
}

}  // namespace

std::optional<int> run_as_sandbox(int argc, char** argv) {
  main_is_ready = true;
  if (argc < 8 || std::strcmp(argv[1], kChildOption) != 0) return std::nullopt;
  ReadOptions options;
  const auto read_number = [](const char* text, auto& number) {
    std::from_chars(text, text + std::strlen(text), number);
  };
  read_number(argv[3], options.deflection_m);
  options.allow_outside = std::strcmp(argv[4], "allow-outside") == 0;
  read_number(argv[5], options.missing_faces);
  options.up = up_named(argv[6]);
  int nodes = 0;
  read_number(argv[7], nodes);
  char** const first = argv + 8;
  if (nodes < 0 || nodes > argc - 8) return 1;
  options.nodes.assign(first, first + nodes);
  options.without.assign(first + nodes, argv + argc);
  options.progress = [](const ReadingProgress& progress) {
    // Less than a pipe holds at once; where nobody listens the reading goes on.
    if (::write(kProgressDescriptor, &progress, sizeof progress) < 0) return;
  };
  load_reader_of(argv[2]);
  give_up_rights(argv[2], options.allow_outside);
  return send_assembly(kResultDescriptor, read_assembly(argv[2], options)) ? 0 : 1;
}

Result<Assembly> read_in_sandbox(const std::string& path, const ReadOptions& options,
                                 const SandboxLimits& limits) {
  if (!main_is_ready) {
    return Error{ErrorCode::kInternal, path, "", "this program has no sandbox", ""};
  }
  int pipe[2], progress[2];
  if (::pipe2(pipe, O_CLOEXEC) != 0) return no_child(path, errno);
  if (::pipe2(progress, O_CLOEXEC) != 0) {
    const int number = errno;
    ::close(pipe[0]);
    ::close(pipe[1]);
    return no_child(path, number);
  }
  std::vector<std::string> words = {"sandbox",
                                    kChildOption,
                                    path,
                                    exact_text(options.deflection_m),
                                    options.allow_outside ? "allow-outside" : "stay-inside",
                                    std::to_string(options.missing_faces),
                                    name_of(options.up),
                                    std::to_string(options.nodes.size())};
  words.insert(words.end(), options.nodes.begin(), options.nodes.end());
  words.insert(words.end(), options.without.begin(), options.without.end());
  std::vector<char*> arguments;  // made before fork: a child of threads may not take memory
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  tell_if_large(path);
  const pid_t parent = ::getpid();
  const pid_t child = ::fork();
  if (child == 0) become_reader(pipe[1], progress[1], parent, limits, arguments.data());
  const int fork_error = errno;
  ::close(pipe[1]);
  ::close(progress[1]);
  if (child < 0) {
    ::close(pipe[0]);
    ::close(progress[0]);
    return no_child(path, fork_error);
  }
  const auto deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                           std::chrono::duration<double>(limits.time_s));
  follow_progress(pipe[0], progress[0], path, options, deadline);
  ReceivedAssembly received = receive_assembly(pipe[0], limits.memory_bytes, deadline);
  ::close(pipe[0]);
  ::close(progress[0]);
  ::kill(child, SIGKILL);  // no effect on a child that has ended
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (received.assembly && !*received.assembly &&
      received.assembly->error().code == ErrorCode::kOutOfMemory) {
    return too_much_memory(path, limits);
  }
  if (received.assembly) return std::move(*received.assembly);
  if (received.broken == BrokenStream::kTooLate) return too_late(path, limits);
  if (received.broken == BrokenStream::kTooLong) return too_much_memory(path, limits);
  return no_mesh(path, received.broken == BrokenStream::kEnded ? status : 0);
}

Result<Assembly> read_guarded(const std::string& path, const ReadOptions& options) {
  if (!may_crash_its_reader(path) || !main_is_ready) return read_assembly(path, options);
  constexpr double kCenturyS = 3e9;
  const SandboxLimits none{std::numeric_limits<std::uint64_t>::max(), kCenturyS};
  Result<Assembly> assembly = read_in_sandbox(path, options, none);
  if (assembly || assembly.error().code != ErrorCode::kInternal) return assembly;
  static std::mutex one_at_a_time;  // OpenCASCADE's readers share what they keep
  const std::lock_guard lock(one_at_a_time);
  return read_assembly(path, options);
}

}  // namespace forcelayer::mesh
