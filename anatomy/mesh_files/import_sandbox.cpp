#include "anatomy/mesh_files/import_sandbox.h"

#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>

#include <cerrno>
#include <cstddef>
#include <vector>

#include "anatomy/limits.h"

namespace ecorche::inline v1 {
namespace {

#if defined(__x86_64__)
constexpr unsigned kMachine = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr unsigned kMachine = AUDIT_ARCH_AARCH64;
#else
#error "name this machine's AUDIT_ARCH"
#endif

// Memory, time, signals to itself, its descriptors, its end.
constexpr int kAllowed[] = {SYS_brk,
                            SYS_clock_getres,
                            SYS_clock_gettime,
                            SYS_clock_nanosleep,
                            SYS_close,
                            SYS_exit,
                            SYS_exit_group,
                            SYS_fstat,
                            SYS_futex,
                            SYS_getpid,
                            SYS_getrandom,
                            SYS_getrusage,
                            SYS_gettid,
                            SYS_gettimeofday,
                            SYS_lseek,
                            SYS_madvise,
                            SYS_mmap,
                            SYS_mprotect,
                            SYS_mremap,
                            SYS_munmap,
                            SYS_pread64,
                            SYS_read,
                            SYS_restart_syscall,
                            SYS_rt_sigaction,
                            SYS_rt_sigprocmask,
                            SYS_rt_sigreturn,
                            SYS_sched_yield,
                            SYS_sysinfo,
                            SYS_tgkill};

sock_filter load(std::size_t offset) {
  return BPF_STMT(BPF_LD | BPF_W | BPF_ABS, unsigned(offset));
}
sock_filter answer(unsigned value) { return BPF_STMT(BPF_RET | BPF_K, value); }
sock_filter jump(unsigned value, unsigned char equal, unsigned char other) {
  return BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, value, equal, other);
}

std::vector<sock_filter> filter() {
  const unsigned refuse = SECCOMP_RET_ERRNO | (EPERM & SECCOMP_RET_DATA);
  std::vector<sock_filter> out{load(offsetof(seccomp_data, arch)), jump(kMachine, 1, 0),
                               answer(SECCOMP_RET_KILL_PROCESS), load(offsetof(seccomp_data, nr))};
  for (const int call : kAllowed) {
    out.push_back(jump(unsigned(call), 0, 1));
    out.push_back(answer(SECCOMP_RET_ALLOW));
  }
  for (const int call : {SYS_write, SYS_writev}) {  // to 1 and 2
    out.push_back(jump(unsigned(call), 0, 5));
    out.push_back(load(offsetof(seccomp_data, args)));
    out.push_back(jump(1, 1, 0));
    out.push_back(jump(2, 0, 1));
    out.push_back(answer(SECCOMP_RET_ALLOW));
    out.push_back(answer(refuse));
  }
  out.push_back(answer(refuse));
  return out;
}

bool bound(int resource, rlim_t most) {
  const rlimit both{most, most};
  return setrlimit(static_cast<__rlimit_resource>(resource), &both) == 0;
}

}  // namespace

bool give_up_rights() {
  const rlimit seconds{rlim_t(limits::kImportSeconds), rlim_t(limits::kImportSeconds) + 1};
  if (setrlimit(RLIMIT_CPU, &seconds) != 0) return false;
  if (!bound(RLIMIT_AS, limits::kImportMemory) || !bound(RLIMIT_FSIZE, limits::kImportBytes) ||
      !bound(RLIMIT_CORE, 0) || !bound(RLIMIT_NOFILE, 3))
    return false;
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return false;
  std::vector<sock_filter> lines = filter();
  const sock_fprog program{static_cast<unsigned short>(lines.size()), lines.data()};
  return prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
}

}  // namespace ecorche::inline v1
