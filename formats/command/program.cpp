#include "formats/command/program.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <regex>
#include <sstream>

#include "formats/command/command.h"
#include "formats/file/descriptor.h"
#include "formats/file/program_folder.h"

namespace forcelayer::command {
namespace {

std::atomic<pid_t> running = 0;  // the program that is waited for
static_assert(std::atomic<pid_t>::is_always_lock_free);

extern "C" void stop_program(int number) {
  if (!is_first_stop(number)) return;
  if (const pid_t program = running; program > 0) kill(program, SIGTERM);
}

Error refused(const std::string& name, int error) {
  return {ErrorCode::kInternal, "", name, std::string("cannot be started: ") + strerror(error), ""};
}

// Also where it stands there already, in a program that was started without that stream.
bool takes_place(int descriptor, int place) {
  return descriptor == place ? fcntl(place, F_SETFD, 0) == 0 : dup2(descriptor, place) >= 0;
}

constexpr std::array kStopSignals = {SIGINT, SIGTERM, SIGHUP};

sigset_t stop_signals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int number : kStopSignals) sigaddset(&set, number);
  return set;
}

// Becomes the program in a process just forked with the stop signals blocked: only calls that a
// signal handler may make. Writes errno to `failure` where it cannot.
[[noreturn]] void become(const char* program, char* const* argv, int in, int out, int failure,
                         pid_t parent, const sigset_t& signal_mask) {
  // A signal that comes before the program starts ends this process: the handler of its parent,
  // which it has until then, would only note it.
  for (const int number : kStopSignals) {
    struct sigaction current {};
    sigaction(number, nullptr, &current);
    if (current.sa_handler != SIG_IGN) signal(number, SIG_DFL);
  }
  sigprocmask(SIG_SETMASK, &signal_mask, nullptr);
  // It ends when its parent does, however that ends: nobody would read what it makes.
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(128 + SIGTERM);
  if ((in < 0 || takes_place(in, STDIN_FILENO)) && (out < 0 || takes_place(out, STDOUT_FILENO))) {
    execve(program, argv, environ);
  }
  const int error = errno;
  const bool said = ::write(failure, &error, sizeof error) == sizeof error;
  _exit(said ? 127 : 126);
}

// A file in memory that begins with the text.
Descriptor file_of(const std::string& text) {
  Descriptor file(memfd_create("input", MFD_CLOEXEC));
  if (!file.valid()) return file;
  errno = write_all(file.number(), std::as_bytes(std::span(text)));
  if (errno != 0) return Descriptor();
  lseek(file.number(), 0, SEEK_SET);
  return file;
}

std::string all_of(int descriptor) {
  std::string text;
  char bytes[65536];
  while (true) {
    const ssize_t read_bytes = read(descriptor, bytes, sizeof bytes);
    if (read_bytes < 0 && errno == EINTR) continue;
    if (read_bytes <= 0) return text;
    text.append(bytes, static_cast<std::size_t>(read_bytes));
  }
}

// Names the descriptor of a file in memory, which the programs that are started inherit: a line for
// each warning that was printed.
constexpr const char* kVariable = "FORCELAYER_WARNINGS";
constexpr const char* kFile = "forcelayer-warnings";

// The options of a program that takes the errors of those that it starts.
constexpr const char* kOptionsVariable = "FORCELAYER_OPTIONS";
bool takes_errors = false;

// -1 where the variable names no such file.
int shared_file() {
  const char* const number = std::getenv(kVariable);
  if (number == nullptr) return -1;
  std::array<char, 64> target{};
  const std::string link = std::string("/proc/self/fd/") + number;
  if (::readlink(link.c_str(), target.data(), target.size() - 1) < 0) return -1;
  return std::string(target.data()).starts_with(std::string("/memfd:") + kFile) ? std::atoi(number)
                                                                                : -1;
}

std::string content_of(int file) {
  std::string content;
  std::array<char, 4096> piece;
  ssize_t got = 0;
  while ((got = ::pread(file, piece.data(), piece.size(), static_cast<off_t>(content.size()))) >
         0) {
    content.append(piece.data(), static_cast<std::size_t>(got));
  }
  return content;
}

}  // namespace

std::string program_path(const std::string& name) {
  if (const auto folder = program_folder(); !folder.empty()) {
    const std::string beside = folder / name;
    if (access(beside.c_str(), X_OK) == 0) return beside;
  }
  const char* const path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    const std::string there = std::filesystem::path(folder.empty() ? "." : folder) / name;
    if (access(there.c_str(), X_OK) == 0) return there;
  }
  return "";
}

void stop_programs_on_signals() {
  for (const int number : kStopSignals) {
    struct sigaction current {};
    sigaction(number, nullptr, &current);
    if (current.sa_handler == SIG_IGN) continue;
    struct sigaction ours {};
    ours.sa_handler = stop_program;
    ours.sa_flags = SA_RESTART;
    sigaction(number, &ours, nullptr);
  }
}

void share_warnings() {
  const int file = ::memfd_create(kFile, 0);
  if (file < 0 || ::fcntl(file, F_SETFL, O_APPEND) != 0) return;
  ::setenv(kVariable, std::to_string(file).c_str(), 1);
}

bool is_new_warning(const std::string& text) {
  const int file = shared_file();
  if (file < 0) return true;
  const std::string line = text + "\n";
  if (("\n" + content_of(file)).find("\n" + line) != std::string::npos) return false;
  // Where it cannot be noted, it is printed again.
  [[maybe_unused]] const ssize_t noted = ::write(file, line.data(), line.size());
  return true;
}

void take_errors(const std::vector<std::string>& options) {
  takes_errors = true;
  std::string words;
  for (const std::string& option : options) words += option + " ";
  ::setenv(kOptionsVariable, words.c_str(), 1);
}

bool leaves_errors() { return !takes_errors && std::getenv(kOptionsVariable) != nullptr; }

std::string with_known_options(const std::string& text) {
  const char* const words = std::getenv(kOptionsVariable);
  if (words == nullptr) return text;
  const std::string known = std::string(" ") + words;
  static const std::regex kOption("--[a-z][a-z-]*");
  const auto is_known = [&](const std::string& part) {
    return std::all_of(std::sregex_iterator(part.begin(), part.end(), kOption), {},
                       [&](const std::smatch& option) {
                         return known.find(" " + option.str() + " ") != std::string::npos;
                       });
  };
  std::string kept;
  static const std::regex kBetween("; |, or ");
  std::string separator;
  for (std::size_t from = 0; from <= text.size();) {
    std::smatch next;
    const bool is_last = !std::regex_search(text.begin() + static_cast<std::ptrdiff_t>(from),
                                            text.end(), next, kBetween);
    const std::size_t length =
        is_last ? text.size() - from : static_cast<std::size_t>(next.position());
    const std::string part = text.substr(from, length);
    if (is_known(part)) kept += (kept.empty() ? "" : separator) + part;
    if (is_last) break;
    separator = next.str();
    from += length + separator.size();
  }
  return kept;
}

Result<ProgramEnd> run_program(const std::string& name, const std::vector<std::string>& arguments,
                               const std::optional<std::string>& input, ProgramOutput output,
                               const std::string& package) {
  const std::string program = program_path(name);
  if (program.empty()) {
    return Error{ErrorCode::kFileNotFound, "", name, "is not installed",
                 "install the package " + package};
  }
  if (stop_signal() != 0) return ProgramEnd{128 + stop_signal(), ""};
  const Descriptor in = input ? file_of(*input) : Descriptor();
  if (input && !in.valid()) return refused(name, errno);
  int ends[2] = {-1, -1}, failure_ends[2] = {-1, -1};
  if (pipe2(ends, O_CLOEXEC) != 0) return refused(name, errno);
  const Descriptor out(ends[0]);
  Descriptor out_of_child(ends[1]);
  if (pipe2(failure_ends, O_CLOEXEC) != 0) return refused(name, errno);
  const Descriptor failure(failure_ends[0]);
  Descriptor failure_of_child(failure_ends[1]);  // closed by a program that starts
  std::vector<char*> argv{const_cast<char*>(name.c_str())};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  const sigset_t blocked = stop_signals();  // until the handler knows the child
  sigset_t signal_mask;
  sigprocmask(SIG_BLOCK, &blocked, &signal_mask);
  const pid_t parent = getpid(), child = fork();
  if (child == 0) {
    become(program.c_str(), argv.data(), in.number(),
           output == ProgramOutput::kTaken ? out_of_child.number() : -1, failure_of_child.number(),
           parent, signal_mask);
  }
  const int fork_error = errno;
  running = child;
  sigprocmask(SIG_SETMASK, &signal_mask, nullptr);
  if (child < 0) return refused(name, fork_error);
  if (stop_signal() != 0) kill(child, SIGTERM);  // that came before they were blocked
  out_of_child = Descriptor();
  failure_of_child = Descriptor();
  const std::string failed = all_of(failure.number());
  ProgramEnd end;
  end.output = all_of(out.number());  // ends with the child
  int status = 0;
  // Until it is reaped, its number belongs to no other process.
  siginfo_t ended{};
  while (waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOWAIT) < 0 && errno == EINTR) {
  }
  running = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (failed.size() == sizeof(int)) {
    int error = 0;
    std::memcpy(&error, failed.data(), sizeof error);
    return refused(name, error);
  }
  end.status = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  return end;
}

}  // namespace forcelayer::command
