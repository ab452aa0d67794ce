#include "formats/file/confinement.h"

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/landlock.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
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

// Other programs, other processes, the system.
constexpr int kOfNoDriver[] = {
    SYS_execve,
    SYS_execveat,
    SYS_process_vm_readv,
    SYS_process_vm_writev,
    SYS_pidfd_getfd,
    SYS_kcmp,
    SYS_perf_event_open,
    SYS_bpf,
    SYS_userfaultfd,
    SYS_io_uring_setup,
    SYS_mount,
    SYS_umount2,
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
    SYS_pidfd_send_signal,
#if !defined(__SANITIZE_ADDRESS__)  // which looks for leaks in this way
    SYS_ptrace,
#endif
};
// Signals, and limits whose excess ends a process. Their first argument says which process.
constexpr int kOfAProcess[] = {
    SYS_kill, SYS_tkill, SYS_tgkill, SYS_rt_sigqueueinfo, SYS_rt_tgsigqueueinfo, SYS_prlimit64};
// By their second argument, the kernel signals another process on behalf of a file.
constexpr struct {
  int number;
  std::uint32_t command;
} kOwners[] = {{SYS_fcntl, F_SETOWN},
               {SYS_fcntl, 15},       // F_SETOWN_EX
               {SYS_ioctl, 0x8901},   // FIOSETOWN
               {SYS_ioctl, 0x8902}};  // SIOCSPGRP
// The network, names, modes, times and attributes.
constexpr int kOfNoReader[] = {
    SYS_socket,    SYS_connect,     SYS_bind,         SYS_listen,       SYS_unlinkat, SYS_renameat2,
    SYS_mkdirat,   SYS_mknodat,     SYS_linkat,       SYS_symlinkat,    SYS_fchmodat, SYS_fchownat,
    SYS_truncate,  SYS_utimensat,   SYS_setxattr,     SYS_fchmod,       SYS_fchown,   SYS_lsetxattr,
    SYS_fsetxattr, SYS_removexattr, SYS_lremovexattr, SYS_fremovexattr,
    452,  // fchmodat2
    463,  // setxattrat
    466,  // removexattrat
#if defined(__x86_64__)
    SYS_unlink,    SYS_rename,      SYS_mkdir,        SYS_rmdir,        SYS_mknod,    SYS_link,
    SYS_symlink,   SYS_chmod,       SYS_chown,        SYS_lchown,       SYS_renameat, SYS_utime,
    SYS_utimes,    SYS_futimesat,
#endif
};

class Filter {
 public:
  Filter() {
    load(offsetof(seccomp_data, arch));
    unless_equal(kMachine);
    load(offsetof(seccomp_data, nr));
#if defined(__x86_64__)
    constexpr std::uint32_t kX32 = 0x40000000;  // the same calls by other numbers
    jump(BPF_JGE, kX32, 0, 1);
    refuse();
#endif
  }

  void refuse_call(int number) {
    jump(BPF_JEQ, static_cast<std::uint32_t>(number), 0, 1);
    refuse();
  }
  // To other processes than this one and its group.
  void refuse_to_others(int number) {
    jump(BPF_JEQ, static_cast<std::uint32_t>(number), 0, 6);
    load(offsetof(seccomp_data, args));
    jump(BPF_JEQ, 0, 2, 0);
    jump(BPF_JEQ, static_cast<std::uint32_t>(::getpid()), 1, 0);
    refuse();
    load(offsetof(seccomp_data, nr));
    jump(BPF_JA, 0, 0, 0);
  }
  // With this second argument.
  void refuse_command(int number, std::uint32_t command) {
    jump(BPF_JEQ, static_cast<std::uint32_t>(number), 0, 4);
    load(offsetof(seccomp_data, args) + sizeof(std::uint64_t));
    jump(BPF_JEQ, command, 0, 1);
    refuse();
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
  void unless_equal(std::uint32_t value) {
    jump(BPF_JEQ, value, 1, 0);
    refuse();
  }
  void refuse() { put(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EPERM); }

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
  for (const int number : kOfNoDriver) filter.refuse_call(number);
  for (const int number : kOfAProcess) filter.refuse_to_others(number);
  for (const auto& owner : kOwners) filter.refuse_command(owner.number, owner.command);
  if (process == CallsOf::kReader) {
    for (const int number : kOfNoReader) filter.refuse_call(number);
  }
  return filter.install();
}

}  // namespace forcelayer
