// SPDX-License-Identifier: MIT
#include "host/intake/child_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace biteline::intake {
namespace {

using Clock = std::chrono::steady_clock;

class Fd {
 public:
  explicit Fd(int fd = -1) : fd_{fd} {}
  Fd(Fd&& other) noexcept : fd_{std::exchange(other.fd_, -1)} {}
  Fd& operator=(Fd&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~Fd() {
    if (fd_ >= 0) ::close(fd_);
  }
  [[nodiscard]] int get() const { return fd_; }

 private:
  int fd_;
};

struct Pipe {
  Fd read, write;
};

Result<Pipe> make_pipe() {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return fail_errno(Errc::DeviceError, errno, "pipe");
  return Pipe{Fd{ends[0]}, Fd{ends[1]}};
}

int remaining_ms(Clock::time_point deadline) {
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
  return left > 0 ? static_cast<int>(left) : 0;
}

}  // namespace

std::filesystem::path program_folder() {
  std::error_code error;
  return std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
}

struct ChildProcess::State {
  std::string name;
  pid_t pid{-1};
  Fd out, in;
  std::string pending;  ///< read from stdout, no line yet
  std::optional<int> status;
  std::thread listener;  ///< reads stderr to its end
  mutable std::mutex mutex;
  std::string last_words;  ///< guarded by mutex
  int stderr_lines{0};     ///< guarded by mutex

  void listen(Fd err, bool show) {
    std::string line;
    std::array<char, 1024> chunk{};
    for (;;) {
      const ssize_t count = ::read(err.get(), chunk.data(), chunk.size());
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) break;
      for (ssize_t i = 0; i < count; ++i) {
        const char c = chunk[static_cast<std::size_t>(i)];
        if (c != '\n') {
          line += c;
          continue;
        }
        if (show) std::fprintf(stderr, "[%s] %s\n", name.c_str(), line.c_str());
        if (!line.empty()) {
          const std::lock_guard lock{mutex};
          last_words = line;
          ++stderr_lines;
        }
        line.clear();
      }
    }
  }

  /// Reaps the child if it ended.
  bool ended() {
    if (status) return true;
    int raw = 0;
    if (::waitpid(pid, &raw, WNOHANG) != pid) return false;
    status = WIFEXITED(raw) ? WEXITSTATUS(raw) : 128 + WTERMSIG(raw);
    return true;
  }
};

ChildProcess::ChildProcess(std::unique_ptr<State> state) : state_{std::move(state)} {}
ChildProcess::ChildProcess(ChildProcess&&) noexcept = default;
ChildProcess& ChildProcess::operator=(ChildProcess&& other) noexcept {
  std::swap(state_, other.state_);
  return *this;
}

ChildProcess::~ChildProcess() {
  if (!state_) return;
  stop();
  if (state_->listener.joinable()) state_->listener.join();
}

Result<ChildProcess> ChildProcess::start(const Config& config) {
  if (::access(config.program.c_str(), X_OK) != 0) {
    return fail_errno(Errc::FileNotFound, errno, "program %s", config.program.c_str());
  }
  BITELINE_ASSIGN(Pipe out, make_pipe());
  BITELINE_ASSIGN(Pipe err, make_pipe());
  Pipe in;
  if (config.give_stdin) {
    BITELINE_ASSIGN(in, make_pipe());
  }
  std::vector<std::string> words{config.program.string()};
  words.insert(words.end(), config.arguments.begin(), config.arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  const pid_t parent = ::getpid();
  const pid_t pid = ::fork();
  if (pid < 0) return fail_errno(Errc::DeviceError, errno, "program %s: fork", config.program.c_str());
  if (pid == 0) {
    // Only async-signal-safe calls from here to execv().
    // A group of its own: stop() then reaches what the child itself started, which may hold our pipes open.
    ::setpgid(0, 0);
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (::getppid() != parent) ::_exit(127);  // the parent died before the line above
    if (in.read.get() >= 0) ::dup2(in.read.get(), STDIN_FILENO);
    ::dup2(out.write.get(), STDOUT_FILENO);
    ::dup2(err.write.get(), STDERR_FILENO);
    ::execv(config.program.c_str(), argv.data());
    ::_exit(127);
  }
  ::setpgid(pid,
            pid);  // also here: whichever process runs first, the group exists before a signal goes to it
  auto state = std::make_unique<State>();
  state->name = config.program.filename();
  state->pid = pid;
  state->out = std::move(out.read);
  state->in = std::move(in.write);
  state->listener = std::thread{[s = state.get(), fd = std::move(err.read),
                                 show = config.pass_stderr]() mutable { s->listen(std::move(fd), show); }};
  return ChildProcess{std::move(state)};
}

Result<std::string> ChildProcess::next_line(Duration timeout) {
  const auto deadline = Clock::now() + timeout;
  for (;;) {
    if (const auto end = state_->pending.find('\n'); end != std::string::npos) {
      std::string line = state_->pending.substr(0, end);
      state_->pending.erase(0, end + 1);
      return line;
    }
    pollfd waiting{.fd = state_->out.get(), .events = POLLIN, .revents = 0};
    const int ready = ::poll(&waiting, 1, remaining_ms(deadline));
    if (ready < 0 && errno == EINTR) continue;
    if (ready == 0) return fail(Errc::Timeout, "program %s", state_->name.c_str());
    std::array<char, 4096> chunk{};
    const ssize_t count = ::read(state_->out.get(), chunk.data(), chunk.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0)
      return fail(Errc::ProcessDied, "program %s: %s", state_->name.c_str(), last_words().c_str());
    state_->pending.append(chunk.data(), static_cast<std::size_t>(count));
  }
}

Result<void> ChildProcess::write_line(const std::string& line) {
  const std::string text = line + "\n";
  std::size_t written = 0;
  while (written < text.size()) {
    const ssize_t count = ::write(state_->in.get(), text.data() + written, text.size() - written);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0)
      return fail_errno(Errc::ProcessDied, errno, "program %s: %s", state_->name.c_str(),
                        last_words().c_str());
    written += static_cast<std::size_t>(count);
  }
  return {};
}

Result<int> ChildProcess::wait(Duration timeout) {
  const auto deadline = Clock::now() + timeout;
  while (!state_->ended()) {
    if (Clock::now() >= deadline) return fail(Errc::Timeout, "program %s still runs", state_->name.c_str());
    std::this_thread::sleep_for(std::chrono::milliseconds{2});
  }
  // What it said last is worth waiting for: the pipe ends with the child.
  if (state_->listener.joinable()) state_->listener.join();
  return *state_->status;
}

bool ChildProcess::running() {
  return !state_->ended();
}

int ChildProcess::stop(Duration grace) {
  if (!state_->ended()) {
    ::kill(-state_->pid, SIGTERM);
    if (!wait(grace)) {
      ::kill(-state_->pid, SIGKILL);
      static_cast<void>(wait(std::chrono::seconds{5}));
    }
  }
  return state_->status.value_or(128 + SIGKILL);
}

std::string ChildProcess::last_words() const {
  const std::lock_guard lock{state_->mutex};
  return state_->last_words;
}

int ChildProcess::stderr_lines() const {
  const std::lock_guard lock{state_->mutex};
  return state_->stderr_lines;
}

int ChildProcess::pid() const {
  return state_->pid;
}

}  // namespace biteline::intake
