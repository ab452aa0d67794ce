/* A device plugin that fails on request, and the device behind it: a process of its own with a
 * watchdog of 20 ms, which writes down what its motors do, as an oscilloscope would.
 *
 * Arguments, separated by spaces: log=FILE (required), fault=KIND, at=SECONDS, when=FILE, and for
 * the handshake no-si, left-handed, no-watchdog, late-watchdog, old-abi, huge-force, slow-motors;
 * silent (no reading ever), no-pose (a quaternion of zeros), open-hangs (for 100 s),
 * open-mute (fails without a text), no-axes, seventh-axis. KIND: unplug,
 * freeze, blip (three readings missing), nan, absurd (millimeters from then on), mm (from the
 * start), uncalibrated, crash, hang, spin (never sleeps); wild (0xff over the memory that is shared
 * with the loop), wild-index (over the words that say where a value is), wild-force (over forces),
 * shrink (tries to cut that memory short), button (no fault: button 1 is pressed from then on).
 * FORCELAYER_PLUGIN_MODE=push in the environment: push mode. facts=FILE: what the process may do,
 * written when the device is opened. file=FILE: it also tries there what no plugin may do to a
 * file of the user, to the loop or to the system.
 *
 * The hand comes down 30 mm in 0.3 s (way=SECONDS) and goes up again, until it feels the motors
 * push; it then stays there. So a loop that begins late finds it out of contact, too. With `below`
 * it is 30 mm down from the start and stays. The fault comes `at` seconds after it stays, and not
 * before the file `when` exists.
 *
 * The log is FILE.part while it grows, FILE when the device ended: lines of
 * "t_s,motor_force_z_n,fault,stays" with t_s of CLOCK_MONOTONIC, one a millisecond; fault is 1 from
 * when the fault was injected, stays from when the hand does. */
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/mount.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <sys/xattr.h>
#include <time.h>
#include <unistd.h>

#include "forcelayer/plugin.h"
#include "tests/support/wild_write.h"

struct wire { /* between driver and device */
  volatile double force_z_n;
  volatile unsigned long written;
  volatile int fault, stays, closed;
};

struct driver {
  struct wire* wire;
  char fault[32], when[400];
  double fault_at_s, begin_s, way_s;
  double stays_s, stays_at; /* since when and how far down, 0: the hand goes on */
  long missing;
  int silent, no_pose;
};

static const double kWayM = 0.03; /* of the hand, down or up */
static const double kPushN = 0.5; /* of the motors, that is a contact */

static double now_s(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void sleep_ms(long ms) {
  const struct timespec t = {ms / 1000, ms % 1000 * 1000000};
  nanosleep(&t, NULL);
}

/* The device: motors, and a watchdog that knows nothing of the driver but its writes. */
static void be_the_device(struct wire* wire, const char* path) {
  char unfinished[512];
  snprintf(unfinished, sizeof unfinished, "%s.part", path);
  FILE* log = fopen(unfinished, "w");
  if (log == NULL) _exit(1);
  setvbuf(log, NULL, _IOLBF, 0);
  const pid_t driver = getppid();
  unsigned long seen = 0;
  double heard_s = 0, end_s = 0;
  for (;;) {
    const double t_s = now_s();
    if (wire->written != seen) {
      seen = wire->written;
      heard_s = t_s;
    }
    const double motor_n = t_s - heard_s < 0.02 ? wire->force_z_n : 0;
    fprintf(log, "%.6f,%.9g,%d,%d\n", t_s, motor_n, wire->fault, wire->stays);
    if (end_s == 0 && (wire->closed || getppid() != driver)) end_s = t_s + 0.8;
    if (end_s != 0 && t_s > end_s) break;
    sleep_ms(1);
  }
  fclose(log);
  rename(unfinished, path);
  _exit(0);
}

static const char* value_of(const char* arguments, const char* name, char* value, size_t bytes) {
  const char* at = strstr(arguments, name);
  value[0] = 0;
  if (at == NULL) return value;
  at += strlen(name);
  const size_t length = strcspn(at, " ");
  snprintf(value, bytes, "%.*s", (int)length, at);
  return value;
}

static void stay(struct driver* d, double t_s, double way) {
  d->stays_s = t_s;
  d->stays_at = way;
  d->wire->stays = 1;
}

/* Rights of this process: write beside the library (`home` is a file there), start a program. */
static void write_rights(FILE* facts, const char* home) {
  const int file = home[0] == 0 ? -1 : open(home, O_WRONLY | O_CREAT, 0600);
  if (file >= 0) fputs("may write\n", facts);
  const pid_t child = fork();
  if (child == 0) {
    execl("/bin/true", "true", (char*)NULL);
    _exit(99);
  }
  int status = 0;
  waitpid(child, &status, 0);
  if (status == 0) fputs("may start programs\n", facts);
  struct rlimit limit;
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) fputs("may not see its own limits\n", facts);
  if (kill(getpid(), 0) != 0) fputs("may not signal itself\n", facts);
  close(file);
}

static void note(FILE* facts, const char* kind, const char* call, long result) {
  const int number = errno;
  const int refused = result == -1 && (number == EPERM || number == EACCES);
  if (!refused) fprintf(facts, "%s %s: %s\n", kind, call, result == -1 ? strerror(number) : "done");
}
#define SYSTEM(call) (errno = 0, note(facts, "call", #call, (long)(call)))
#define ON_FILE(call) (errno = 0, note(facts, "file", #call, (long)(call)))

/* All of this must be refused to a confined plugin: by the filter of system calls (EPERM even where
 * the call makes no sense), or by the rights to files. Only calls that pass are written down. */
static void try_the_loop(FILE* facts) {
  const pid_t loop = getppid();
  struct sched_param ordinary = {0};
  struct rlimit limit;
  cpu_set_t cores;
  CPU_ZERO(&cores);
  CPU_SET(0, &cores);
  char byte;
  struct iovec mine = {&byte, 1}, theirs = {(void*)note, 1};
  int ends[2];
  if (pipe(ends) != 0) return;
  struct f_owner_ex owner = {F_OWNER_PID, loop};
  SYSTEM(kill(loop, 0));
  SYSTEM(kill(0, 0));
  SYSTEM(kill(-1, 0));
  SYSTEM(kill(-getpgid(loop), 0));
  SYSTEM(syscall(SYS_tkill, loop, 0));
  SYSTEM(syscall(SYS_tgkill, loop, loop, 0));
  SYSTEM(syscall(SYS_rt_sigqueueinfo, loop, 0, NULL));
  SYSTEM(syscall(SYS_rt_tgsigqueueinfo, loop, loop, 0, NULL));
  SYSTEM(syscall(SYS_pidfd_send_signal, syscall(SYS_pidfd_open, loop, 0), 0, NULL, 0));
  SYSTEM(fcntl(ends[0], F_SETOWN, loop));
  SYSTEM(fcntl(ends[0], F_SETOWN_EX, &owner));
  SYSTEM(ioctl(ends[0], FIOSETOWN, &loop));
  SYSTEM(ioctl(ends[0], SIOCSPGRP, &loop));
  SYSTEM(setpgid(0, getpgid(loop)));
  SYSTEM(setpgid(loop, loop));
  SYSTEM(ioctl(0, TIOCSTI, "x"));
  SYSTEM(ioctl(0, TIOCSCTTY, 1));
  SYSTEM(ioctl(0, TIOCSPGRP, &loop));
  SYSTEM(sched_setscheduler(loop, SCHED_IDLE, &ordinary));
  SYSTEM(sched_setparam(loop, &ordinary));
  SYSTEM(syscall(SYS_sched_setattr, loop, NULL, 0));
  SYSTEM(sched_setaffinity(loop, sizeof cores, &cores));
  SYSTEM(setpriority(PRIO_PROCESS, (id_t)loop, 19));
  SYSTEM(setpriority(PRIO_PGRP, 0, 19));
  SYSTEM(setpriority(PRIO_USER, 0, 19));
  SYSTEM(syscall(SYS_ioprio_set, 1, loop, 3 << 13));
  SYSTEM(prlimit(loop, RLIMIT_CPU, NULL, &limit));
  SYSTEM(process_vm_readv(loop, &mine, 1, &theirs, 1, 0));
  SYSTEM(process_vm_writev(loop, &mine, 1, &theirs, 1, 0));
#if !defined(__SANITIZE_ADDRESS__) /* which looks for leaks in this way */
  SYSTEM(ptrace(PTRACE_SEIZE, loop, NULL, NULL));
#endif
  SYSTEM(syscall(SYS_kcmp, loop, loop, 0, 0, 0));
  SYSTEM(syscall(SYS_pidfd_getfd, syscall(SYS_pidfd_open, loop, 0), 0, 0));
  SYSTEM(syscall(SYS_move_pages, loop, 0, NULL, NULL, NULL, 0));
  SYSTEM(socket(AF_UNIX, SOCK_STREAM, 0));
  close(ends[0]);
  close(ends[1]);
}

static void try_the_system(FILE* facts) {
  SYSTEM(syscall(SYS_bpf, 0, NULL, 0));
  SYSTEM(syscall(SYS_perf_event_open, NULL, 0, -1, -1, 0));
  SYSTEM(syscall(SYS_userfaultfd, 0));
  SYSTEM(syscall(SYS_io_uring_setup, 1, NULL));
  SYSTEM(syscall(SYS_keyctl, 0, 0, 0, 0, 0));
  SYSTEM(syscall(SYS_add_key, NULL, NULL, NULL, 0, 0));
  SYSTEM(mount("none", "/tmp", "tmpfs", 0, NULL));
  SYSTEM(unshare(CLONE_NEWUSER));
  SYSTEM(syscall(SYS_clone, CLONE_NEWUSER | SIGCHLD, NULL, NULL, NULL, 0));
  SYSTEM(setns(0, 0));
  SYSTEM(chroot("/"));
}

static void try_file(FILE* facts, const char* file) {
  char other[512];
  snprintf(other, sizeof other, "%s.other", file);
  const struct timeval times[2] = {{1, 0}, {1, 0}};
  ON_FILE(chmod(file, 0777));
  ON_FILE(fchmodat(AT_FDCWD, file, 0777, 0));
  ON_FILE(chown(file, getuid(), getgid()));
  ON_FILE(lchown(file, getuid(), getgid()));
  ON_FILE(utimes(file, times));
  ON_FILE(utimensat(AT_FDCWD, file, NULL, 0));
  ON_FILE(setxattr(file, "user.x", "x", 1, 0));
  ON_FILE(lsetxattr(file, "user.x", "x", 1, 0));
  ON_FILE(removexattr(file, "user.x"));
  ON_FILE(truncate(file, 0));
  ON_FILE(open(file, O_RDONLY | O_TRUNC));
  ON_FILE(open(file, O_ACCMODE | O_TRUNC));
  ON_FILE(open(file, O_WRONLY));
  const int reads = open(file, O_RDONLY);
  ON_FILE(fchmod(reads, 0777));
  ON_FILE(fchown(reads, getuid(), getgid()));
  ON_FILE(fsetxattr(reads, "user.x", "x", 1, 0));
  ON_FILE(link(file, other));
  ON_FILE(symlink(file, other));
  ON_FILE(mkdir(other, 0700));
  ON_FILE(rename(file, other));
  ON_FILE(unlink(file));
  snprintf(other, sizeof other, "/proc/%d/oom_score_adj", (int)getppid());
  ON_FILE(open(other, O_WRONLY));
  snprintf(other, sizeof other, "/proc/%d/mem", (int)getppid());
  ON_FILE(open(other, O_RDONLY));
  ON_FILE(open("/sys/fs/cgroup/cgroup.procs", O_WRONLY));
  close(reads);
}

/* Descriptors, rights and environment of this process, a line each. */
static void write_facts(const char* path, const char* home, const char* file) {
  char line[4096];
  FILE* facts = fopen(path, "w");
  FILE* status = fopen("/proc/self/status", "r");
  if (facts == NULL || status == NULL) return;
  while (fgets(line, sizeof line, status) != NULL) {
    if (strncmp(line, "NoNewPrivs", 10) == 0) fputs(line, facts);
  }
  for (int number = 0; number < 256; ++number) {
    if (number == fileno(facts) || number == fileno(status)) continue;
    if (fcntl(number, F_GETFD) >= 0) fprintf(facts, "fd %d\n", number);
  }
  for (char** variable = environ; *variable != NULL; ++variable) {
    fprintf(facts, "env %.*s\n", (int)strcspn(*variable, "="), *variable);
  }
  write_rights(facts, home);
  if (file[0] != 0) {
    try_the_loop(facts);
    try_the_system(facts);
    try_file(facts, file);
  }
  fclose(status);
  fclose(facts);
}

static int open_device(const char* arguments, forcelayer_plugin_info* info, void** out, char* error,
                       size_t error_bytes) {
  static struct driver driver;
  char path[400], at[32], way[32];
  value_of(arguments, "log=", path, sizeof path);
  value_of(arguments, "fault=", driver.fault, sizeof driver.fault);
  driver.fault_at_s = atof(value_of(arguments, "at=", at, sizeof at));
  value_of(arguments, "when=", driver.when, sizeof driver.when);
  driver.way_s = atof(value_of(arguments, "way=", way, sizeof way));
  if (!(driver.way_s > 0)) driver.way_s = 0.3;
  char facts[400];
  value_of(arguments, "facts=", facts, sizeof facts);
  char home[400];
  value_of(arguments, "home=", home, sizeof home);
  char file[400];
  value_of(arguments, "file=", file, sizeof file);
  if (facts[0] != 0) write_facts(facts, home, file);
  if (strstr(arguments, "open-hangs") != NULL) sleep_ms(100000);
  if (strstr(arguments, "open-mute") != NULL) return 1;
  if (path[0] == 0) {
    snprintf(error, error_bytes, "needs log=FILE");
    return 1;
  }
  driver.wire =
      mmap(NULL, sizeof *driver.wire, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (fork() == 0) {
    setsid();
    for (int number = 1; number < 32; ++number) signal(number, SIG_DFL);
    close(0);
    close(1);
    close(2);
    be_the_device(driver.wire, path);
  }
  driver.begin_s = now_s();
  if (strstr(arguments, "below") != NULL) stay(&driver, driver.begin_s, 1);
  driver.silent = strstr(arguments, "silent") != NULL;
  driver.no_pose = strstr(arguments, "no-pose") != NULL;
  const int old = strstr(arguments, "old-abi") != NULL;
  info->abi = old ? 99 : FORCELAYER_PLUGIN_ABI;
  info->si_units = strstr(arguments, "no-si") != NULL ? 0 : FORCELAYER_PLUGIN_SI_UNITS;
  info->right_handed =
      strstr(arguments, "left-handed") != NULL ? 0 : FORCELAYER_PLUGIN_RIGHT_HANDED;
  info->sensed_axes = strstr(arguments, "no-axes") != NULL ? 0 : 63;
  info->actuated_axes = strstr(arguments, "seventh-axis") != NULL ? 127 : 63;
  snprintf(info->name, sizeof info->name, "fault plugin");
  info->rate_hz = strstr(arguments, "slow-motors") != NULL ? 49 : 1000;
  info->max_force_n = strstr(arguments, "huge-force") != NULL ? 1e308 : 8;
  info->max_torque_nm = 0.1;
  info->damping_ns_per_m = 2;
  info->damping_nms_per_rad = 0.005;
  info->delay_s = 0.001;
  info->workspace_radius_m = 0.2;
  info->watchdog_s = strstr(arguments, "no-watchdog") != NULL     ? 0
                     : strstr(arguments, "late-watchdog") != NULL ? 0.2
                                                                  : 0.02;
  *out = &driver;
  return 0;
}

static int is(const struct driver* d, const char* fault) { return strcmp(d->fault, fault) == 0; }

/* How far down the hand is, 0 to 1. It stays just behind the lowest point or not at all: a driver
 * that slept may hear of a push that is over. */
static double way_down(struct driver* d) {
  if (d->stays_s > 0) return d->stays_at;
  const double t_s = now_s(), ways = fmod((t_s - d->begin_s) / d->way_s, 2);
  if (ways < 1) return ways;
  if (ways < 1.05 && fabs(d->wire->force_z_n) > kPushN) stay(d, t_s, 2 - ways);
  return 2 - ways;
}

static int comes(const struct driver* d) {
  return d->fault[0] != 0 && d->stays_s > 0 && now_s() - d->stays_s >= d->fault_at_s &&
         (d->when[0] == 0 || access(d->when, F_OK) == 0);
}

static int read_device(void* opaque, forcelayer_plugin_reading* reading) {
  struct driver* d = opaque;
  memset(reading, 0, sizeof *reading);
  reading->position_m[2] = -kWayM * way_down(d);
  reading->orientation_wxyz[0] = d->no_pose ? 0 : 1;
  reading->status = FORCELAYER_PLUGIN_CALIBRATED;
  if (d->silent) return 0;
  if (is(d, "mm")) reading->position_m[0] = 130;
  if (!d->wire->fault && !comes(d)) return 1;
  d->wire->fault = 1;
  if (is(d, "unplug")) return -1;
  if (is(d, "freeze")) return 0;
  if (is(d, "blip") && d->missing++ < 3) return 0;
  if (is(d, "button")) reading->buttons = 1u << 1;
  if (is(d, "nan")) reading->position_m[1] = NAN;
  if (is(d, "absurd")) reading->position_m[2] *= 1000;
  if (is(d, "uncalibrated")) reading->status = 0;
  if (is(d, "crash")) abort();
  if (is(d, "wild")) write_wildly(WILD_ALL);
  if (is(d, "wild-index")) write_wildly(WILD_INDICES);
  if (is(d, "wild-force")) write_wildly(WILD_FORCES);
  if (is(d, "shrink") && ftruncate(3, 0) == 0) abort();
  while (is(d, "hang")) sleep_ms(1000);
  while (is(d, "spin")) {
  }
  return 1;
}

static int write_device(void* opaque, const forcelayer_plugin_wrench* wrench) {
  struct driver* d = opaque;
  d->wire->force_z_n = wrench->force_n[2];
  ++d->wire->written;
  return 0;
}

/* A servo thread of the SDK's own. */
static int run_device(void* opaque, const forcelayer_plugin_host* host) {
  forcelayer_plugin_reading reading;
  forcelayer_plugin_wrench wrench = {{0, 0, 0}, {0, 0, 0}};
  int end = 0;
  while (!end) {
    const int read = read_device(opaque, &reading);
    if (read != 0) end = host->exchange(host->context, read > 0 ? &reading : NULL, &wrench);
    write_device(opaque, &wrench);
    sleep_ms(1);
  }
  return 0;
}

static void close_device(void* opaque) {
  struct driver* d = opaque;
  d->wire->force_z_n = 0;
  d->wire->closed = 1;
}

static const forcelayer_plugin kPull = {open_device, read_device, write_device, NULL, close_device};
static const forcelayer_plugin kPush = {open_device, NULL, NULL, run_device, close_device};

/* The mode is chosen before open(), so by the environment. */
const forcelayer_plugin* forcelayer_plugin_entry(uint32_t host_abi) {
  if (host_abi != FORCELAYER_PLUGIN_ABI) return NULL;
  const char* mode = getenv("FORCELAYER_PLUGIN_MODE");
  return mode != NULL && strcmp(mode, "push") == 0 ? &kPush : &kPull;
}
