// Rights that a process gives up for good, before it runs code or reads files of strangers. System
// calls of Linux alone: Landlock (files) and seccomp (system calls). A kernel without one of them
// leaves the process with that much more.
#pragma once

#include <span>
#include <string>

namespace forcelayer {

// The kernel's means of confinement.
int landlock_version() noexcept;  // 0: none
bool filters_system_calls() noexcept;

// From now on files are written, made, renamed and removed only below `writable`, and, with
// `readable`, read only below these two. Paths that do not exist are left out. False where the
// kernel cannot.
bool confine_files(std::span<const std::string> writable, std::span<const std::string> readable);
bool confine_files(std::span<const std::string> writable);  // and read everywhere

enum class CallsOf {
  kDriver,  // no other programs; no look into other processes and no signal to them; nothing that
            // changes the system: mounts, modules, name spaces, keys
  kReader,  // nor the network, nor names and modes of files
};
// System calls that such a process has no use for fail with EPERM. Call it before threads begin.
// False where the kernel cannot.
bool confine_system_calls(CallsOf process);

}  // namespace forcelayer
