// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/cad/reader_sandbox.hpp"

#ifdef TRISKIN_SECCOMP
#include <fcntl.h>
#include <sched.h>
#include <seccomp.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <initializer_list>
#include <memory>
#endif

namespace triskin::cad {

#ifdef TRISKIN_SECCOMP
namespace {

constexpr std::array kRefused{
    // programs, processes and their memory
    "execve", "execveat", "fork", "vfork", "kill", "tkill", "rt_sigqueueinfo", "rt_tgsigqueueinfo", "pidfd_open",
    "pidfd_send_signal", "pidfd_getfd", "ptrace", "process_vm_readv", "process_vm_writev", "process_madvise", "kcmp",
    "setrlimit", "setpgid", "setsid", "setpriority", "sched_setscheduler",
    // files
    "creat", "truncate", "unlink", "unlinkat", "rename", "renameat", "renameat2", "link", "linkat", "symlink",
    "symlinkat", "mkdir", "mkdirat", "rmdir", "mknod", "mknodat", "chmod", "fchmod", "fchmodat", "chown", "fchown",
    "lchown", "fchownat", "utime", "utimes", "utimensat", "futimesat", "setxattr", "lsetxattr", "fsetxattr",
    "removexattr", "lremovexattr", "fremovexattr", "open_by_handle_at", "ioctl",
    // messages and memory that outlive the process
    "mq_open", "mq_unlink", "msgget", "msgsnd", "msgctl", "shmget", "shmat", "shmctl", "semget", "semop", "semctl",
    // connections, and other ways to do the same
    "socket", "socketpair", "connect", "bind", "listen", "accept", "accept4", "sendto", "sendmsg", "sendmmsg",
    "io_uring_setup", "io_uring_enter", "io_uring_register",
    // the computer
    "mount", "umount2", "pivot_root", "chroot", "unshare", "setns", "bpf", "perf_event_open", "userfaultfd", "add_key",
    "request_key", "keyctl", "init_module", "finit_module", "delete_module", "kexec_load", "reboot", "swapon",
    "swapoff", "sethostname", "setdomainname", "settimeofday", "clock_settime", "adjtimex", "clock_adjtime", "syslog",
    "acct", "quotactl", "fanotify_init", "fsopen", "fsmount", "move_mount", "open_tree"};
// Calls that are newer than libseccomp 2.5 and change files: fchmodat2, setxattrat, removexattrat and file_setattr have
// these numbers on every processor.
constexpr std::array kRefusedNumbers{452, 463, 466, 469};
// The filter cannot look into the structures that these take. ENOSYS sends the C library to the older call.
constexpr std::array kUnknown{"clone3", "openat2"};

class Filter {
 public:
  Filter() : context_(seccomp_init(SCMP_ACT_ALLOW), &seccomp_release) {}

  void refuse(const char* call, int error) { refuse(call, error, {}); }
  void refuse(const char* call, int error, std::initializer_list<scmp_arg_cmp> when) {
    const int number = seccomp_syscall_resolve_name(call);
    if (number >= 0) refuse(number, error, when);  // Others are calls that this processor does not have.
  }
  void refuse(int number, int error, std::initializer_list<scmp_arg_cmp> when) {
    if (!context_) return;
    is_whole_ = seccomp_rule_add_array(context_.get(), SCMP_ACT_ERRNO(static_cast<std::uint32_t>(error)), number,
                                       static_cast<unsigned>(when.size()), when.begin()) == 0 &&
                is_whole_;
  }
  [[nodiscard]] bool load() const { return context_ && is_whole_ && seccomp_load(context_.get()) == 0; }

 private:
  std::unique_ptr<void, decltype(&seccomp_release)> context_;
  bool is_whole_ = true;
};

scmp_arg_cmp has(unsigned argument, std::uint64_t mask, std::uint64_t bits) {
  return {argument, SCMP_CMP_MASKED_EQ, mask, bits};
}

// A file opens for reading only. O_TMPFILE has O_DIRECTORY, which alone is harmless, and needs one of the two modes.
void refuse_writing(Filter& filter, const char* call, unsigned flags) {
  for (const std::uint64_t mode : {std::uint64_t{O_WRONLY}, std::uint64_t{O_RDWR}})
    filter.refuse(call, EPERM, {has(flags, O_ACCMODE, mode)});
  for (const std::uint64_t bit : {std::uint64_t{O_CREAT}, std::uint64_t{O_TRUNC}})
    filter.refuse(call, EPERM, {has(flags, bit, bit)});
}

}  // namespace

bool enter_reader_sandbox() {
  Filter filter;
  for (const char* call : kRefused) filter.refuse(call, EPERM);
  for (const int number : kRefusedNumbers) filter.refuse(number, EPERM, {});
  for (const char* call : kUnknown) filter.refuse(call, ENOSYS);
  refuse_writing(filter, "open", 1);
  refuse_writing(filter, "openat", 2);
  filter.refuse("clone", EPERM, {has(0, CLONE_THREAD, 0)});
  const auto self = static_cast<std::uint64_t>(::getpid());
  filter.refuse("tgkill", EPERM, {{0, SCMP_CMP_NE, self, 0}});  // A process that aborts signals itself.
  filter.refuse("fcntl", EPERM, {{1, SCMP_CMP_EQ, F_SETOWN, 0}});
  filter.refuse("prlimit64", EPERM, {{2, SCMP_CMP_NE, 0, 0}});  // Threads ask for their limits.
  return filter.load();
}
#else
bool enter_reader_sandbox() {
  return false;
}
#endif

}  // namespace triskin::cad
