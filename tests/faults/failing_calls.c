// A shim under a program (LD_PRELOAD): it counts the calls of a group, lets the nth fail, and writes down what reached
// the disk. tests/faults/nth_call.py drives it.
//
// System calls are caught by a seccomp filter, so that those count too that the C library makes by itself (stdio); what
// is no system call is taken over by name: the allocator, pthread_create and clock_gettime.
//
//   MBK_FAULT_COUNTS   a file; number of calls of each group in it, as 64-bit numbers in the order of `enum group`,
//                      and behind them how many were made to fail. It outlives a process that is killed.
//   MBK_FAULT_GROUP    whose calls fail, a word of kGroupNames
//   MBK_FAULT_NTH      which one, from 1
//   MBK_FAULT_ERRNO    the error as a number; 0: the call succeeds with half of the bytes (read and write)
//   MBK_FAULT_STICKY   1: all later ones fail as well
//   MBK_FAULT_STACKS   a file; 64 bits for each allocation, a sum over the functions that led to it
//   MBK_FAULT_TRACE    a file; what was done to files, in its order (struct record)
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <time.h>
#include <ucontext.h>
#include <unistd.h>
#include <unwind.h>

enum group { WRITE, SYNC, OPEN, NAME, READ, STATUS, SOCKET, SLEEP, CLOCK, MEMORY, THREAD, GROUPS };
static const char* const kGroupNames[GROUPS] = {"write",  "sync",  "open",  "name",   "read",  "status",
                                                "socket", "sleep", "clock", "memory", "thread"};

static const struct {
  uint16_t number, group;
} kCalls[] = {
    {SYS_write, WRITE},
    {SYS_writev, WRITE},
    {SYS_pwrite64, WRITE},
    {SYS_pwritev, WRITE},
    {SYS_fsync, SYNC},
    {SYS_fdatasync, SYNC},
    {SYS_fallocate, SYNC},
    {SYS_ftruncate, SYNC},
    {SYS_truncate, SYNC},
    {SYS_open, OPEN},
    {SYS_openat, OPEN},
    {SYS_creat, OPEN},
    {SYS_rename, NAME},
    {SYS_renameat, NAME},
    {SYS_renameat2, NAME},
    {SYS_link, NAME},
    {SYS_linkat, NAME},
    {SYS_unlink, NAME},
    {SYS_unlinkat, NAME},
    {SYS_mkdir, NAME},
    {SYS_rmdir, NAME},
    {SYS_read, READ},
    {SYS_readv, READ},
    {SYS_pread64, READ},
    {SYS_getdents64, READ},
    {SYS_fstat, STATUS},
    {SYS_newfstatat, STATUS},
    {SYS_statx, STATUS},
    {SYS_statfs, STATUS},
    {SYS_fstatfs, STATUS},
    {SYS_lseek, STATUS},
    {SYS_socket, SOCKET},
    {SYS_bind, SOCKET},
    {SYS_connect, SOCKET},
    {SYS_sendto, SOCKET},
    {SYS_sendmsg, SOCKET},
    {SYS_recvfrom, SOCKET},
    {SYS_recvmsg, SOCKET},
    {SYS_setsockopt, SOCKET},
    {SYS_poll, SOCKET},
    {SYS_ppoll, SOCKET},
    {SYS_nanosleep, SLEEP},
    {SYS_clock_nanosleep, SLEEP},
};
enum { KINDS_OF_CALLS = sizeof kCalls / sizeof *kCalls };

/// What was done to a file; `length` bytes follow, of data or of names.
struct record {
  char kind;  // O opened, W written, T truncated, A space reserved, B sync begins, E sync ended, R renamed, U removed,
              // M folder made
  char unused[3];
  uint32_t flags;  // of open; of fallocate
  uint64_t inode, offset, length;
};

struct counts {
  _Atomic uint64_t calls[GROUPS], failed;
};

static struct counts before_the_file;  // until the file is there
static struct counts* counts = &before_the_file;
static int failing = -1;  // group
static uint64_t nth;
static int error;
static int sticky;
static int trace = -1;
static atomic_flag tracing = ATOMIC_FLAG_INIT;
static uint64_t* stacks;
static const uint64_t kMaxStacks = 1 << 23;
static __thread int in_shim __attribute__((tls_model("initial-exec")));

// The one place whose system calls pass the filter.
long failing_calls_raw(long number, long a, long b, long c, long d, long e, long f);
extern char failing_calls_raw_end[];
__asm__(
    ".text\n.globl failing_calls_raw\n.hidden failing_calls_raw\nfailing_calls_raw:\n"
    "endbr64; mov %rdi,%rax; mov %rsi,%rdi; mov %rdx,%rsi; mov %rcx,%rdx; mov %r8,%r10; mov %r9,%r8; mov 8(%rsp),%r9\n"
    "syscall\n.globl failing_calls_raw_end\n.hidden failing_calls_raw_end\nfailing_calls_raw_end: ret\n");

/// Counts a call. Whether it has to fail.
static int fails(int group) {
  const uint64_t count = atomic_fetch_add(&counts->calls[group], 1) + 1;
  if (group != failing || nth == 0 || (sticky ? count < nth : count != nth)) return 0;
  atomic_fetch_add(&counts->failed, 1);
  return 1;
}

static int group_of(long number) {
  for (int i = 0; i < KINDS_OF_CALLS; ++i) {
    if (kCalls[i].number == number) return kCalls[i].group;
  }
  return -1;
}

static void write_all(const void* data, size_t bytes) {
  for (size_t done = 0; done < bytes;) {
    const long wrote = failing_calls_raw(SYS_write, trace, (long)data + (long)done, (long)(bytes - done), 0, 0, 0);
    if (wrote <= 0) _exit(99);
    done += (size_t)wrote;
  }
}

static void note(char kind, int descriptor, uint32_t flags, uint64_t offset, const void* data, uint64_t length) {
  struct record record = {kind, "", flags, 0, offset, length};
  struct stat status;
  if (descriptor >= 0) {
    if (failing_calls_raw(SYS_fstat, descriptor, (long)&status, 0, 0, 0, 0) != 0) return;
    if (!S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode)) return;
    record.inode = status.st_ino;
  }
  write_all(&record, sizeof record);
  write_all(data, length);
}

static void note_folder(const char* path) {
  struct stat status;
  if (failing_calls_raw(SYS_stat, (long)path, (long)&status, 0, 0, 0, 0) != 0) return;
  const struct record record = {'M', "", 0, status.st_ino, 0, strlen(path)};
  write_all(&record, sizeof record);
  write_all(path, record.length);
}

static void note_two(const char* first, const char* second) {
  char names[8192];
  const size_t from = strlen(first) + 1, to = strlen(second);
  if (from + to > sizeof names) _exit(99);
  memcpy(names, first, from);
  memcpy(names + from, second, to);
  note('R', -1, 0, 0, names, from + to);
}

/// Makes the call and writes down what it did. One at a time, so that the order is the true one; but not the syncs,
/// which others write beside.
static long traced(long number, const greg_t* r) {
  const long a = r[REG_RDI], b = r[REG_RSI], c = r[REG_RDX], d = r[REG_R10];
  const int syncs = number == SYS_fsync || number == SYS_fdatasync;
  const struct timespec nap = {0, 20000};
  while (atomic_flag_test_and_set(&tracing)) failing_calls_raw(SYS_nanosleep, (long)&nap, 0, 0, 0, 0, 0);
  if (syncs) {
    note('B', (int)a, 0, 0, "", 0);
    atomic_flag_clear(&tracing);
  }
  const long result = failing_calls_raw(number, a, b, c, d, r[REG_R8], r[REG_R9]);
  if (syncs) {
    while (atomic_flag_test_and_set(&tracing)) failing_calls_raw(SYS_nanosleep, (long)&nap, 0, 0, 0, 0, 0);
  }
  if (result >= 0) {
    const long at =
        number == SYS_write || number == SYS_writev ? failing_calls_raw(SYS_lseek, a, 0, SEEK_CUR, 0, 0, 0) : 0;
    const uint64_t offset = (uint64_t)(at - result);
    switch (number) {
      case SYS_open:
        note('O', (int)result, (uint32_t)b, 0, (const char*)a, strlen((const char*)a));
        break;
      case SYS_openat:
        note('O', (int)result, (uint32_t)c, 0, (const char*)b, strlen((const char*)b));
        break;
      case SYS_write:
        note('W', (int)a, 0, offset, (const void*)b, (uint64_t)result);
        break;
      case SYS_pwrite64:
        note('W', (int)a, 0, (uint64_t)d, (const void*)b, (uint64_t)result);
        break;
      case SYS_writev: {
        uint64_t done = 0;
        for (long i = 0; i < c && done < (uint64_t)result; ++i) {
          const struct iovec* part = (const struct iovec*)b + i;
          const uint64_t left = (uint64_t)result - done, bytes = part->iov_len < left ? part->iov_len : left;
          note('W', (int)a, 0, offset + done, part->iov_base, bytes);
          done += bytes;
        }
        break;
      }
      case SYS_ftruncate:
        note('T', (int)a, 0, (uint64_t)b, "", 0);
        break;
      case SYS_fallocate:
        note('A', (int)a, (uint32_t)b, (uint64_t)(c + d), "", 0);
        break;
      case SYS_fsync:
      case SYS_fdatasync:
        note('E', (int)a, 0, 0, "", 0);
        break;
      case SYS_rename:
        note_two((const char*)a, (const char*)b);
        break;
      case SYS_renameat:
      case SYS_renameat2:
        note_two((const char*)b, (const char*)d);
        break;
      case SYS_mkdir:
        note_folder((const char*)a);
        break;
      case SYS_unlink:
        note('U', -1, 0, 0, (const char*)a, strlen((const char*)a));
        break;
      case SYS_unlinkat:
        note('U', -1, 0, 0, (const char*)b, strlen((const char*)b));
        break;
      default:
        break;
    }
  }
  atomic_flag_clear(&tracing);
  return result;
}

static long called(long number, greg_t* r) {
  const int group = group_of(number);
  if (group >= 0 && fails(group)) {
    if (error != 0) return -error;
    if (r[REG_RDX] > 1) r[REG_RDX] = r[REG_RDX] / 2;  // bytes; of writev the buffers
  }
  if (trace >= 0 && (group == WRITE || group == SYNC || group == OPEN || group == NAME)) return traced(number, r);
  return failing_calls_raw(number, r[REG_RDI], r[REG_RSI], r[REG_RDX], r[REG_R10], r[REG_R8], r[REG_R9]);
}

static void caught(int signal, siginfo_t* info, void* context) {
  (void)signal;
  greg_t* const registers = ((ucontext_t*)context)->uc_mcontext.gregs;
  registers[REG_RAX] = called(info->si_syscall, registers);
}

static void* map_file(const char* name, size_t bytes) {
  const int descriptor = open(name, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (descriptor < 0 || ftruncate(descriptor, (off_t)bytes) != 0) _exit(98);
  void* const at = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
  if (at == MAP_FAILED) _exit(98);
  close(descriptor);
  return at;
}

static void install_filter(void) {
  struct sigaction action;
  memset(&action, 0, sizeof action);
  action.sa_sigaction = caught;
  action.sa_flags = SA_SIGINFO | SA_NODEFER | SA_RESTART;
  if (sigaction(SIGSYS, &action, NULL) != 0) _exit(97);
  struct sock_filter filter[KINDS_OF_CALLS + 8];
  size_t n = 0;
  const uint8_t kinds = KINDS_OF_CALLS;
  filter[n++] = (struct sock_filter)BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr));
  for (uint8_t i = 0; i < kinds; ++i) {
    filter[n++] = (struct sock_filter)BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, kCalls[i].number, (uint8_t)(kinds - i), 0);
  }
  filter[n++] = (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
  filter[n++] =
      (struct sock_filter)BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, instruction_pointer));
  filter[n++] =
      (struct sock_filter)BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, (uint32_t)(uintptr_t)failing_calls_raw_end, 0, 1);
  filter[n++] = (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
  filter[n++] = (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRAP);
  const struct sock_fprog program = {(unsigned short)n, filter};
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 || prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) != 0) {
    static const char words[] = "failing_calls: this system lets no process filter its own system calls\n";
    (void)!write(2, words, sizeof words - 1);
    _exit(77);
  }
}

__attribute__((constructor)) static void begin(void) {
  const char* const file = getenv("MBK_FAULT_COUNTS");
  if (file == NULL) return;
  struct counts* const shared = map_file(file, sizeof(struct counts));
  const char* const name = getenv("MBK_FAULT_GROUP");
  for (int i = 0; name != NULL && i < GROUPS; ++i) {
    if (strcmp(name, kGroupNames[i]) == 0) failing = i;
  }
  const char* word = getenv("MBK_FAULT_NTH");
  nth = word != NULL ? strtoull(word, NULL, 10) : 0;
  word = getenv("MBK_FAULT_ERRNO");
  error = word != NULL ? atoi(word) : EIO;
  word = getenv("MBK_FAULT_STICKY");
  sticky = word != NULL && *word == '1';
  if ((word = getenv("MBK_FAULT_TRACE")) != NULL) {
    trace = open(word, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
    if (trace < 0) _exit(98);
  }
  if ((word = getenv("MBK_FAULT_STACKS")) != NULL) stacks = map_file(word, kMaxStacks * sizeof *stacks);
  install_filter();
  counts = shared;
}

// ------------------------------------------------------------------------------- what is no system call

extern void* __libc_malloc(size_t bytes);
extern void* __libc_calloc(size_t count, size_t bytes);
extern void* __libc_realloc(void* old, size_t bytes);
extern void* __libc_memalign(size_t alignment, size_t bytes);

struct walk {
  uint64_t sum;
  int depth;
};

static _Unwind_Reason_Code add_frame(struct _Unwind_Context* context, void* data) {
  struct walk* const walk = data;
  walk->sum = (walk->sum ^ (uint64_t)_Unwind_GetIP(context)) * 0x9E3779B97F4A7C15U;
  return ++walk->depth < 24 ? _URC_NO_REASON : _URC_END_OF_STACK;
}

static int no_memory(void) {
  if (counts == &before_the_file || in_shim) return 0;
  if (stacks != NULL) {
    in_shim = 1;
    struct walk walk = {1, 0};
    _Unwind_Backtrace(add_frame, &walk);
    const uint64_t at = atomic_load(&counts->calls[MEMORY]);
    if (at < kMaxStacks) stacks[at] = walk.sum;
    in_shim = 0;
  }
  if (!fails(MEMORY)) return 0;
  errno = ENOMEM;
  return 1;
}

void* malloc(size_t bytes) {
  return no_memory() ? NULL : __libc_malloc(bytes);
}

void* calloc(size_t count, size_t bytes) {
  return no_memory() ? NULL : __libc_calloc(count, bytes);
}

void* realloc(void* old, size_t bytes) {
  return no_memory() ? NULL : __libc_realloc(old, bytes);
}

void* memalign(size_t alignment, size_t bytes) {
  return no_memory() ? NULL : __libc_memalign(alignment, bytes);
}

void* aligned_alloc(size_t alignment, size_t bytes) {
  return no_memory() ? NULL : __libc_memalign(alignment, bytes);
}

int posix_memalign(void** result, size_t alignment, size_t bytes) {
  if (no_memory()) return ENOMEM;
  void* const got = __libc_memalign(alignment, bytes);
  if (got == NULL) return ENOMEM;
  *result = got;
  return 0;
}

int clock_gettime(clockid_t clock, struct timespec* time) {
  if (counts != &before_the_file && fails(CLOCK)) {
    errno = error;
    return -1;
  }
  return (int)failing_calls_raw(SYS_clock_gettime, clock, (long)time, 0, 0, 0, 0);
}

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*work)(void*), void* argument) {
  static int (*real)(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
  if (counts != &before_the_file && fails(THREAD)) return error;
  if (real == NULL) *(void**)&real = dlsym(RTLD_NEXT, "pthread_create");
  return real(thread, attributes, work, argument);
}

// SIGSYS stays the shim's: a thread that blocks it would be killed at its next system call.
int sigaction(int signal, const struct sigaction* action, struct sigaction* old) {
  static int (*real)(int, const struct sigaction*, struct sigaction*);
  if (real == NULL) *(void**)&real = dlsym(RTLD_NEXT, "sigaction");
  if (signal == SIGSYS && counts != &before_the_file) {
    if (old != NULL) memset(old, 0, sizeof *old);
    return 0;
  }
  if (action == NULL) return real(signal, action, old);
  struct sigaction without = *action;
  sigdelset(&without.sa_mask, SIGSYS);
  return real(signal, &without, old);
}

static const sigset_t* without_sigsys(int how, const sigset_t* set, sigset_t* copy) {
  if (set == NULL || how == SIG_UNBLOCK) return set;
  *copy = *set;
  sigdelset(copy, SIGSYS);
  return copy;
}

int pthread_sigmask(int how, const sigset_t* set, sigset_t* old) {
  sigset_t copy;
  return (int)-failing_calls_raw(SYS_rt_sigprocmask, how, (long)without_sigsys(how, set, &copy), (long)old, 8, 0, 0);
}

int sigprocmask(int how, const sigset_t* set, sigset_t* old) {
  const int code = pthread_sigmask(how, set, old);
  if (code == 0) return 0;
  errno = code;
  return -1;
}
