#include "formats/file/confinement.h"

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/landlock.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "formats/file/descriptor.h"

namespace forcelayer {
namespace {

// ---- Landlock, whose newer rights Debian 12's headers do not name

constexpr std::uint64_t kTruncate = 1u << 14;  // from version 3 on
constexpr std::uint64_t kRefer = 1u << 13;     // from version 2 on
constexpr std::uint64_t kReading = LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR;
constexpr std::uint64_t kOfFiles = LANDLOCK_ACCESS_FS_EXECUTE | LANDLOCK_ACCESS_FS_WRITE_FILE |
                                   LANDLOCK_ACCESS_FS_READ_FILE | kTruncate;

std::uint64_t writing(int version) {
  return LANDLOCK_ACCESS_FS_WRITE_FILE | LANDLOCK_ACCESS_FS_REMOVE_DIR |
         LANDLOCK_ACCESS_FS_REMOVE_FILE | LANDLOCK_ACCESS_FS_MAKE_CHAR |
         LANDLOCK_ACCESS_FS_MAKE_DIR | LANDLOCK_ACCESS_FS_MAKE_REG | LANDLOCK_ACCESS_FS_MAKE_SOCK |
         LANDLOCK_ACCESS_FS_MAKE_FIFO | LANDLOCK_ACCESS_FS_MAKE_BLOCK |
         LANDLOCK_ACCESS_FS_MAKE_SYM | (version >= 2 ? kRefer : 0) | (version >= 3 ? kTruncate : 0);
}

void allow_below(int rules, const std::string& path, std::uint64_t access) {
  const Descriptor place(::open(path.c_str(), O_PATH | O_CLOEXEC));
  struct stat facts {};
  if (place.number() < 0 || ::fstat(place.number(), &facts) != 0) return;
  if (!S_ISDIR(facts.st_mode)) access &= kOfFiles;
  const landlock_path_beneath_attr beneath{access, place.number()};
  ::syscall(SYS_landlock_add_rule, rules, LANDLOCK_RULE_PATH_BENEATH, &beneath, 0);
}

bool confine(std::span<const std::string> writable, const std::span<const std::string>* readable) {
  const int version = landlock_version();
  if (version == 0) return false;
  const std::uint64_t reading = readable == nullptr ? 0 : kReading;
  landlock_ruleset_attr handled{};
  handled.handled_access_fs = writing(version) | reading;
  const Descriptor rules(static_cast<int>(
      ::syscall(SYS_landlock_create_ruleset, &handled, sizeof handled.handled_access_fs, 0)));
  if (rules.number() < 0) return false;
  for (const std::string& path : writable) {
    allow_below(rules.number(), path, handled.handled_access_fs);
  }
  if (readable != nullptr) {
    for (const std::string& path : *readable) allow_below(rules.number(), path, reading);
  }
  ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  return ::syscall(SYS_landlock_restrict_self, rules.number(), 0) == 0;
}

// ---- seccomp

#if defined(__x86_64__)
constexpr std::uint32_t kMachine = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr std::uint32_t kMachine = AUDIT_ARCH_AARCH64;
#else
constexpr std::uint32_t kMachine = 0;  // no filter
#endif

// Other programs, other processes, the system. And modes, owners, times and attributes of files,
// and the length of one that is not open: Landlock has no say in them.
constexpr int kRefused[] = {
    SYS_execve,
    SYS_execveat,
    SYS_process_vm_readv,
    SYS_process_vm_writev,
    SYS_pidfd_getfd,
    SYS_pidfd_send_signal,
    440,  // process_madvise
    448,  // process_mrelease
    SYS_migrate_pages,
    SYS_move_pages,
    SYS_ioprio_set,
    SYS_kcmp,
    SYS_perf_event_open,
    SYS_bpf,
    SYS_userfaultfd,
    SYS_io_uring_setup,
    SYS_mount,
    SYS_umount2,
    SYS_open_tree,
    SYS_move_mount,
    SYS_fsopen,
    SYS_fspick,
    442,  // mount_setattr
    SYS_pivot_root,
    SYS_chroot,
    SYS_setns,
    SYS_unshare,
    SYS_init_module,
    SYS_finit_module,
    SYS_delete_module,
    SYS_kexec_load,
    SYS_reboot,
    SYS_swapon,
    SYS_swapoff,
    SYS_add_key,
    SYS_request_key,
    SYS_keyctl,
    SYS_settimeofday,
    SYS_clock_settime,
    SYS_clock_adjtime,
    SYS_adjtimex,
    SYS_vhangup,
    SYS_open_by_handle_at,
#if !defined(__SANITIZE_ADDRESS__)  // which looks for leaks in this way
    SYS_ptrace,
#endif
    SYS_fchmodat,
    SYS_fchownat,
    SYS_fchmod,
    SYS_fchown,
    SYS_truncate,
    SYS_utimensat,
    SYS_setxattr,
    SYS_lsetxattr,
    SYS_fsetxattr,
    SYS_removexattr,
    SYS_lremovexattr,
    SYS_fremovexattr,
    452,  // fchmodat2
    463,  // setxattrat
    466,  // removexattrat
    469,  // file_setattr
#if defined(__x86_64__)
    SYS_chmod,
    SYS_chown,
    SYS_lchown,
    SYS_utime,
    SYS_utimes,
    SYS_futimesat,
#endif
};
// The network and names of files.
constexpr int kRefusedToReaders[] = {
    SYS_socket,    SYS_connect, SYS_bind,     SYS_listen, SYS_unlinkat,
    SYS_renameat2, SYS_mkdirat, SYS_mknodat,  SYS_linkat,
#if defined(__x86_64__)
    SYS_unlink,    SYS_rename,  SYS_mkdir,    SYS_rmdir,  SYS_mknod,
    SYS_link,      SYS_symlink, SYS_renameat,
#endif
    SYS_symlinkat,
};
// Their arguments cannot be looked into: a caller does without, as on an older kernel.
constexpr int kUnknown[] = {SYS_clone3, SYS_openat2};

constexpr std::uint32_t kAny = ~0u;

// Calls that one of their arguments decides on.
struct Rule {
  int number;
  int argument;
  std::uint32_t mask;
  std::uint32_t value;
};
constexpr std::uint32_t kNamespaces = 0x7e020000;  // CLONE_NEW*
constexpr Rule kRefusedWith[] = {
    // The kernel signals another process on behalf of a file.
    {SYS_fcntl, 1, kAny, F_SETOWN},
    {SYS_fcntl, 1, kAny, 15},      // F_SETOWN_EX
    {SYS_ioctl, 1, kAny, 0x8901},  // FIOSETOWN
    {SYS_ioctl, 1, kAny, 0x8902},  // SIOCSPGRP
    // Input for a terminal, and whom it signals.
    {SYS_ioctl, 1, kAny, 0x5412},  // TIOCSTI
    {SYS_ioctl, 1, kAny, 0x541c},  // TIOCLINUX
    {SYS_ioctl, 1, kAny, 0x540e},  // TIOCSCTTY
    {SYS_ioctl, 1, kAny, 0x5410},  // TIOCSPGRP
    // A file that is opened for reading is cut: Landlock before its version 3 lets that pass.
    {SYS_openat, 2, O_TRUNC | O_ACCMODE, O_TRUNC | O_RDONLY},
    {SYS_openat, 2, O_TRUNC | O_ACCMODE, O_TRUNC | O_ACCMODE},
#if defined(__x86_64__)
    {SYS_open, 1, O_TRUNC | O_ACCMODE, O_TRUNC | O_RDONLY},
    {SYS_open, 1, O_TRUNC | O_ACCMODE, O_TRUNC | O_ACCMODE},
#endif
    // Programs that start others on request, such as the user's service manager.
    {SYS_socket, 0, kAny, AF_UNIX},
    // Groups and users, whose processes are others.
    {SYS_setpriority, 0, kAny, PRIO_PGRP},
    {SYS_setpriority, 0, kAny, PRIO_USER},
};
// The argument names a process, and it must be this one. 0 is this one as well, but in a signal its
// whole group, in which others may be.
struct OwnRule {
  int number;
  int argument;
  bool zero;
};
constexpr OwnRule kOwn[] = {
    {SYS_kill, 0, false},
    {SYS_tkill, 0, false},
    {SYS_tgkill, 0, false},
    {SYS_rt_sigqueueinfo, 0, false},
    {SYS_rt_tgsigqueueinfo, 0, false},
    {SYS_prlimit64, 0, true},
    {SYS_sched_setscheduler, 0, true},
    {SYS_sched_setparam, 0, true},
    {SYS_sched_setattr, 0, true},
    {SYS_sched_setaffinity, 0, true},
    {SYS_setpriority, 1, true},
    {SYS_setpgid, 0, true},
};

class Filter {
 public:
  Filter() {
    load(offsetof(seccomp_data, arch));
    jump(BPF_JEQ, kMachine, 1, 0);
    refuse_now(EPERM);
    load(offsetof(seccomp_data, nr));
#if defined(__x86_64__)
    constexpr std::uint32_t kX32 = 0x40000000;  // the same calls by other numbers
    jump(BPF_JGE, kX32, 0, 1);
    refuse_now(EPERM);
#endif
  }

  void refuse(int number, int error = EPERM) {
    jump(BPF_JEQ, static_cast<std::uint32_t>(number), 0, 1);
    refuse_now(error);
  }
  void refuse_with(const Rule& rule) {
    jump(BPF_JEQ, static_cast<std::uint32_t>(rule.number), 0, 5);
    load_argument(rule.argument);
    put(BPF_ALU | BPF_AND | BPF_K, rule.mask);
    jump(BPF_JEQ, rule.value, 0, 1);
    refuse_now(EPERM);
    load(offsetof(seccomp_data, nr));
  }
  // With any of these bits in its first argument.
  void refuse_flags(int number, std::uint32_t flags) {
    jump(BPF_JEQ, static_cast<std::uint32_t>(number), 0, 4);
    load_argument(0);
    jump(BPF_JSET, flags, 0, 1);
    refuse_now(EPERM);
    load(offsetof(seccomp_data, nr));
  }
  void refuse_to_others(const OwnRule& rule) {
    const auto self = static_cast<std::uint32_t>(::getpid());
    jump(BPF_JEQ, static_cast<std::uint32_t>(rule.number), 0, 5);
    load_argument(rule.argument);
    jump(BPF_JEQ, rule.zero ? 0 : self, 2, 0);
    jump(BPF_JEQ, self, 1, 0);
    refuse_now(EPERM);
    load(offsetof(seccomp_data, nr));
  }
  bool install() {
    put(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
    const sock_fprog program{static_cast<unsigned short>(code_.size()), code_.data()};
    ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
    return ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program, 0, 0) == 0;
  }

 private:
  void put(int code, std::uint32_t k, int yes = 0, int no = 0) {
    code_.push_back({static_cast<std::uint16_t>(code), static_cast<std::uint8_t>(yes),
                     static_cast<std::uint8_t>(no), k});
  }
  void load(std::size_t offset) {
    put(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(offset));
  }
  void jump(int how, std::uint32_t than, int yes, int no) {
    put(BPF_JMP | how | BPF_K, than, yes, no);
  }
  void load_argument(int number) {  // its lower half: the kernel reads no more of these
    load(offsetof(seccomp_data, args) + static_cast<std::size_t>(number) * sizeof(std::uint64_t));
  }
  void refuse_now(int error) {
    put(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | static_cast<std::uint32_t>(error));
  }

  std::vector<sock_filter> code_;
};

}  // namespace

int landlock_version() noexcept {
  const long version = ::syscall(SYS_landlock_create_ruleset, nullptr, 0, 1u);
  return version > 0 ? static_cast<int>(version) : 0;
}

bool filters_system_calls() noexcept {
  const std::uint32_t action = SECCOMP_RET_ERRNO;
  return kMachine != 0 && ::syscall(SYS_seccomp, SECCOMP_GET_ACTION_AVAIL, 0, &action) == 0;
}

bool confine_files(std::span<const std::string> writable, std::span<const std::string> readable) {
  return confine(writable, &readable);
}

bool confine_files(std::span<const std::string> writable) { return confine(writable, nullptr); }

bool confine_system_calls(CallsOf process) {
  if (kMachine == 0) return false;
  Filter filter;
  for (const int number : kRefused) filter.refuse(number);
  for (const int number : kUnknown) filter.refuse(number, ENOSYS);
  for (const Rule& rule : kRefusedWith) filter.refuse_with(rule);
  for (const OwnRule& rule : kOwn) filter.refuse_to_others(rule);
  filter.refuse_flags(SYS_clone, kNamespaces);
  if (process == CallsOf::kReader) {
    for (const int number : kRefusedToReaders) filter.refuse(number);
  }
  return filter.install();
}

}  // namespace forcelayer
