// Rights that a process gives up for good, before it runs code or reads files of strangers: by
// Landlock (files) and seccomp (system calls), which are Linux's. On a kernel without one of them
// the process keeps the rights that this one would take.
#pragma once

#include <span>
#include <string>

namespace forcelayer {

// The kernel's means of confinement.
int landlock_version() noexcept;  // 0: none
bool filters_system_calls() noexcept;

// From now on the process writes, makes, renames and removes files only below `writable`. With
// `readable` it reads files only below `writable` and `readable`. Paths that do not exist are left
// out. False where the kernel cannot.
bool confine_files(std::span<const std::string> writable, std::span<const std::string> readable);
bool confine_files(std::span<const std::string> writable);  // and read everywhere

enum class CallsOf {
  kDriver,  // no other programs, nor sockets to those of this machine (AF_UNIX); no look into other
            // processes, no signal to them, no limit or priority for them; nothing that changes
            // modes, owners, times and attributes of files, or the system: mounts, modules, name
            // spaces, keys
  kReader,  // nor the network, nor names of files
};
// System calls that such a process does not need fail with EPERM from now on. Call it before
// threads begin. False where the kernel cannot.
bool confine_system_calls(CallsOf process);

}  // namespace forcelayer
