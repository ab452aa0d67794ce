#include "formats/command/program.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sstream>

#include "formats/file/descriptor.h"
#include "formats/file/program_folder.h"

namespace forcelayer::command {
namespace {

Error refused(const std::string& name) {
  return {ErrorCode::kInternal, "", name, std::string("cannot be started: ") + strerror(errno), ""};
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

Result<ProgramEnd> run_program(const std::string& name, const std::vector<std::string>& arguments,
                               const std::string& input, ProgramOutput output,
                               const std::string& package) {
  const std::string program = program_path(name);
  if (program.empty()) {
    return Error{ErrorCode::kFileNotFound, "", name, "is not installed",
                 "it comes with the package " + package};
  }
  const Descriptor in = file_of(input);
  int ends[2] = {-1, -1};
  if (!in.valid() || pipe2(ends, O_CLOEXEC) != 0) return refused(name);
  const Descriptor out(ends[0]);
  Descriptor out_of_child(ends[1]);
  std::vector<char*> argv{const_cast<char*>(name.c_str())};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, in.number(), STDIN_FILENO);
  if (output == ProgramOutput::kTaken) {
    posix_spawn_file_actions_adddup2(&actions, out_of_child.number(), STDOUT_FILENO);
  }
  pid_t child = 0;
  errno = posix_spawn(&child, program.c_str(), &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (errno != 0) return refused(name);
  out_of_child = Descriptor();
  ProgramEnd end;
  end.output = all_of(out.number());  // ends with the child
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  end.status = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  return end;
}

}  // namespace forcelayer::command
