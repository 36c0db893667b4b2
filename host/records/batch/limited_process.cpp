// SPDX-License-Identifier: MIT
#include "host/records/batch/limited_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <fstream>
#include <limits>

#include "common/core/text.hpp"

namespace biteline::batch {
namespace {

using Clock = std::chrono::steady_clock;

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

/// True when it ended before the deadline.  A process file descriptor becomes readable at the end.
bool ends_before(pid_t pid, Clock::time_point deadline) {
  const int fd = static_cast<int>(::syscall(SYS_pidfd_open, pid, 0));
  bool ended = false;
  while (true) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left < 0) break;
    // Without such a descriptor (old kernel) the look is repeated.
    const int wait_ms = static_cast<int>(std::min<long long>(left + 1, fd >= 0 ? 60'000 : 5));
    pollfd waiting{.fd = fd, .events = POLLIN, .revents = 0};
    ::poll(&waiting, 1, wait_ms);
    siginfo_t info{};
    if (::waitid(P_PID, static_cast<id_t>(pid), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
        info.si_pid == pid) {
      ended = true;
      break;
    }
  }
  if (fd >= 0) ::close(fd);
  return ended;
}

/// The last line that is not empty, of the file's last few thousand bytes.
std::string last_line(const std::filesystem::path& file) {
  constexpr std::streamoff k_tail_bytes = 4096;
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  const std::streamoff size = in ? static_cast<std::streamoff>(in.tellg()) : 0;
  in.seekg(std::max<std::streamoff>(0, size - k_tail_bytes));
  std::string line, last;
  while (std::getline(in, line)) {
    if (!line.empty()) last = line;
  }
  return clean_text(last);
}

}  // namespace

Result<ProcessEnd> run_limited(const std::filesystem::path& program,
                               const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                               const ProcessLimits& limits) {
  if (::access(program.c_str(), X_OK) != 0)
    return fail_errno(Errc::FileNotFound, errno, "program %s", program.c_str());
  std::vector<std::string> words{program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const std::filesystem::path stderr_file = folder / "stderr.txt";
  const int err = ::open(stderr_file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (err < 0) return fail_errno(Errc::WriteFailed, errno, "%s", stderr_file.c_str());
  const int null = ::open("/dev/null", O_RDWR | O_CLOEXEC);

  const rlimit memory{.rlim_cur = static_cast<rlim_t>(limits.memory_mb * 1024 * 1024),
                      .rlim_max = static_cast<rlim_t>(limits.memory_mb * 1024 * 1024)};
  const rlimit no_core{.rlim_cur = 0, .rlim_max = 0};
  const auto begin = Clock::now();
  const pid_t parent = ::getpid();
  const pid_t pid = ::fork();
  if (pid == 0) {
    // Only async-signal-safe calls from here to execv().
    ::setpgid(0, 0);
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(127);
    ::setrlimit(RLIMIT_DATA, &memory);
    ::setrlimit(RLIMIT_CORE, &no_core);
    ::dup2(null, STDIN_FILENO);
    ::dup2(null, STDOUT_FILENO);
    ::dup2(err, STDERR_FILENO);
    ::execv(program.c_str(), argv.data());
    ::_exit(127);
  }
  const int fork_errno = errno;
  ::close(err);
  if (null >= 0) ::close(null);
  if (pid < 0) return fail_errno(Errc::DeviceError, fork_errno, "program %s: fork", program.c_str());
  ::setpgid(pid, pid);  // also here: whichever process runs first, the group exists before it is killed

  ProcessEnd end;
  const auto most = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(limits.time_s));
  if (!ends_before(pid, begin + most)) end.how = ProcessEnd::How::TimedOut;
  // Also after a sound end: nothing that it left behind may go on beside the next recording.
  ::kill(-pid, SIGKILL);
  int raw = 0;
  rusage usage{};
  while (::wait4(pid, &raw, 0, &usage) < 0 && errno == EINTR) {
  }
  end.wall_s = std::chrono::duration<double>(Clock::now() - begin).count();
  end.cpu_s = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  end.peak_memory_mb = static_cast<double>(usage.ru_maxrss) / 1024;
  end.status = WIFEXITED(raw) ? WEXITSTATUS(raw) : WTERMSIG(raw);
  if (end.how == ProcessEnd::How::Exited && WIFSIGNALED(raw)) end.how = ProcessEnd::How::Signalled;
  end.last_words = last_line(stderr_file);
  return end;
}

}  // namespace biteline::batch
