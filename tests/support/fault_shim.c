/* Faults on request, by LD_PRELOAD:
 *
 *   in the child of --sandbox, on opening a file named
 *     crash.*     the reader meets a null pointer
 *     abort.*     the reader aborts
 *     quit.*      the reader calls exit
 *     hang.*      the reader waits for ever
 *     mute.*      the reader closes its pipe, then waits for ever
 *     nonsense.*  the reader sends noise in place of a mesh
 *     nosy.*      the reader tries what it does not need, and exits with 32 + what it was allowed
 *   in any process, once a file is open and its size is asked, one named
 *     cut.*       is cut to nothing
 *     changed.*   is written to
 *   FAULT_WRITE_ERRNO=N   writing to regular files fails with errno N ...
 *   FAULT_WRITE_AFTER=B   ... after B bytes
 *   FAULT_CLOCK_JUMPS=1   the wall clock jumps a year ahead or back at every look
 *   FAULT_LOCK_MS=N       locking memory takes voxrun itself N milliseconds
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <sys/xattr.h>
#include <time.h>
#include <unistd.h>

static int in_sandbox(void) {
  char line[4096] = "";
  const int file = (int)syscall(SYS_openat, AT_FDCWD, "/proc/self/cmdline", O_RDONLY);
  const ssize_t size = read(file, line, sizeof line - 1);
  close(file);
  return size > 0 && strcmp(line + strlen(line) + 1, "--read-mesh-for-sandbox") == 0;
}

static int named(const char* path, const char* stem) {
  const char* const slash = strrchr(path, '/');
  const char* const name = slash ? slash + 1 : path;
  const size_t length = strlen(stem);
  return strncmp(name, stem, length) == 0 && name[length] == '.';
}

static void wait_for_ever(void) {
  while (1) pause();
}

/* 1: to read secret.txt beside the file's folder; 2: to write into it; 4: to start a program; 8:
 * the network; 16: to signal its parent; 64: to change the file's mode, times or attributes; 128:
 * to see its parent's limits. */
static int allowed_of(const char* path) {
  char other[4096];
  const char* const slash = strrchr(path, '/');
  const int folder = slash ? (int)(slash - path) : 0;
  int allowed = 0;
  snprintf(other, sizeof other, "%.*s/../secret.txt", folder, path);
  allowed |= syscall(SYS_openat, AT_FDCWD, other, O_RDONLY) >= 0 ? 1 : 0;
  snprintf(other, sizeof other, "%.*s/made.txt", folder, path);
  allowed |= syscall(SYS_openat, AT_FDCWD, other, O_WRONLY | O_CREAT, 0600) >= 0 ? 2 : 0;
  allowed |= socket(AF_INET, SOCK_DGRAM, 0) >= 0 ? 8 : 0;
  allowed |= kill(getppid(), 0) == 0 ? 16 : 0;
  allowed |= syscall(452 /* fchmodat2 */, AT_FDCWD, path, 0640, 0) == 0 ? 64 : 0;
  allowed |= chmod(path, 0640) == 0 ? 64 : 0;
  allowed |= setxattr(path, "user.x", "", 0, 0) == 0 ? 64 : 0;
  allowed |= lsetxattr(path, "user.x", "", 0, 0) == 0 ? 64 : 0;
#if defined(__x86_64__)
  allowed |= syscall(SYS_utime, path, NULL) == 0 ? 64 : 0;
  allowed |= syscall(SYS_utimes, path, NULL) == 0 ? 64 : 0;
  allowed |= syscall(SYS_futimesat, AT_FDCWD, path, NULL) == 0 ? 64 : 0;
#endif
  struct rlimit limit;
  allowed |= prlimit(getppid(), RLIMIT_CPU, NULL, &limit) == 0 ? 128 : 0;
  const pid_t child = fork();
  if (child == 0) {
    execl("/bin/true", "true", (char*)NULL);
    _exit(1);
  }
  int status = 1;
  allowed |= child > 0 && waitpid(child, &status, 0) == child && status == 0 ? 4 : 0;
  return allowed;
}

static void fail_as_named(const char* path) {
  if (named(path, "nosy") && in_sandbox()) _exit(32 + allowed_of(path));
  if (!named(path, "crash") && !named(path, "abort") && !named(path, "quit") &&
      !named(path, "hang") && !named(path, "mute") && !named(path, "nonsense")) {
    return;
  }
  if (!in_sandbox()) return;
  signal(SIGSEGV, SIG_DFL); /* a sanitizer would end the process in its own way */
  signal(SIGABRT, SIG_DFL);
  if (named(path, "crash")) raise(SIGSEGV);
  if (named(path, "abort")) abort();
  if (named(path, "quit")) _exit(9);
  if (named(path, "mute")) close(3);
  if (named(path, "nonsense")) {
    unsigned state = 1;
    for (int i = 0; i < 100000; ++i) {
      state = state * 1664525u + 1013904223u;
      if (write(3, &state, sizeof state) < 0) break;
    }
    _exit(0);
  }
  wait_for_ever();
}

static int opened(const char* path, int flags, mode_t mode) {
  fail_as_named(path);
  return (int)syscall(SYS_openat, AT_FDCWD, path, flags, mode);
}

int open(const char* path, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(more, mode_t) : 0;
  va_end(more);
  return opened(path, flags, mode);
}

int open64(const char* path, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(more, mode_t) : 0;
  va_end(more);
  return opened(path, flags, mode);
}

static void change(const char* path) {
  if (named(path, "cut") && truncate(path, 0) != 0) abort();
  if (named(path, "changed")) {
    const int writing = (int)syscall(SYS_openat, AT_FDCWD, path, O_WRONLY);
    if (pwrite(writing, "S", 1, 0) < 0) futimens(writing, NULL); /* a sandbox may write nothing */
    close(writing);
  }
}

/* A reader in a sandbox can change no file. A process that began before it gave up its rights can.
 */
static int asked = -1, answered = -1;
__attribute__((constructor)) static void begin_helper(void) {
  int question[2], answer[2];
  if (!in_sandbox() || pipe(question) != 0 || pipe(answer) != 0) return;
  asked = question[1];
  answered = answer[0];
  if (fork() == 0) {
    char path[4096];
    ssize_t length;
    close(3); /* the reader's result */
    close(asked);
    close(answered);
    while ((length = read(question[0], path, sizeof path - 1)) > 0) {
      path[length] = 0;
      change(path);
      if (syscall(SYS_write, answer[1], "", 1) != 1) break;
    }
    _exit(0);
  }
  close(question[0]);
  close(answer[1]);
}

int fstat(int file, struct stat* status) {
  int (*const real)(int, struct stat*) = (int (*)(int, struct stat*))dlsym(RTLD_NEXT, "fstat");
  const int result = real(file, status);
  char link[64], path[4096] = "";
  snprintf(link, sizeof link, "/proc/self/fd/%d", file);
  if (result != 0 || readlink(link, path, sizeof path - 1) < 0) return result;
  if (!named(path, "cut") && !named(path, "changed")) return result;
  char done;
  if (asked < 0) {
    change(path);
  } else if (syscall(SYS_write, asked, path, strlen(path)) < 0 || read(answered, &done, 1) != 1) {
    abort();
  }
  return result;
}

ssize_t write(int file, const void* bytes, size_t count) {
  static atomic_llong written;
  const char* const wanted = getenv("FAULT_WRITE_ERRNO");
  struct stat status;
  if (wanted != NULL && syscall(SYS_fstat, file, &status) == 0 && S_ISREG(status.st_mode)) {
    const char* const after = getenv("FAULT_WRITE_AFTER");
    if (atomic_fetch_add(&written, (long long)count) + (long long)count >
        (after ? atoll(after) : 0)) {
      errno = atoi(wanted);
      return -1;
    }
  }
  return syscall(SYS_write, file, bytes, count);
}

static time_t jump_s(void) {
  static atomic_int calls;
  const time_t year_s = 365 * 24 * 3600;
  if (getenv("FAULT_CLOCK_JUMPS") == NULL) return 0;
  return atomic_fetch_add(&calls, 1) % 2 ? year_s : -year_s;
}

int clock_gettime(clockid_t clock, struct timespec* now) {
  const int result = (int)syscall(SYS_clock_gettime, clock, now);
  if (result == 0 && clock == CLOCK_REALTIME) now->tv_sec += jump_s();
  return result;
}

time_t time(time_t* out) {
  struct timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  if (out != NULL) *out = now.tv_sec;
  return now.tv_sec;
}

int mlockall(int flags) {
  const char* const delay_ms = getenv("FAULT_LOCK_MS");
  int (*const next)(int) = (int (*)(int))dlsym(RTLD_NEXT, "mlockall");
  if (delay_ms != NULL && strcmp(program_invocation_short_name, "voxrun") == 0) {
    usleep((useconds_t)atoi(delay_ms) * 1000);
  }
  return next(flags);
}
