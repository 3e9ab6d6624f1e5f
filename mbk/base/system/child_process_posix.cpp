#include <fcntl.h>
#include <signal.h>  // NOLINT(modernize-deprecated-headers): kill
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>
#include <tuple>
#include <utility>

#include "mbk/base/system/child_process.h"

namespace mbk::system {

namespace {

/// Becomes the program, or says why not through `said`. Only calls that a child of several threads may make.
[[noreturn]] void become(char* const* arguments, const char* output, pid_t parent, int said) {
  // Whoever would start it again has gone with the parent.
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  const int nothing = ::open("/dev/null", O_RDONLY), log = ::open(output, O_WRONLY | O_CREAT | O_TRUNC, 0600);
  if (::getppid() == parent && nothing >= 0 && log >= 0 && ::dup2(nothing, STDIN_FILENO) >= 0 &&
      ::dup2(log, STDOUT_FILENO) >= 0 && ::dup2(log, STDERR_FILENO) >= 0) {
    ::execvp(arguments[0], arguments);
  }
  const int error = errno;
  std::ignore = ::write(said, &error, sizeof error);
  ::_exit(127);
}

}  // namespace

Result<ChildProcess> ChildProcess::start(const std::vector<std::string>& command, const std::filesystem::path& output) {
  std::vector<char*> arguments;
  for (const std::string& one : command) arguments.push_back(const_cast<char*>(one.c_str()));
  arguments.push_back(nullptr);
  const auto failed = [&](int error) {
    return bad_data(std::strerror(error), "check that the program exists", command.front());
  };
  std::array<int, 2> said{};
  if (::pipe2(said.data(), O_CLOEXEC) != 0) return failed(errno);
  const pid_t parent = ::getpid(), id = ::fork();
  if (id == 0) become(arguments.data(), output.c_str(), parent, said[1]);
  int error = id < 0 ? errno : 0;
  ::close(said[1]);
  if (id > 0) {
    while (::read(said[0], &error, sizeof error) < 0 && errno == EINTR) {
    }
  }
  ::close(said[0]);
  if (error == 0) return ChildProcess(id);
  if (id > 0) ::waitpid(id, nullptr, 0);
  return failed(error);
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept : id_(std::exchange(other.id_, -1)), ended_(other.ended_) {}

ChildProcess::~ChildProcess() {
  if (id_ < 0 || ended_) return;
  send(Signal::kill);
  waitpid(id_, nullptr, 0);
}

void ChildProcess::send(Signal signal) const {
  if (id_ <= 0 || ended_) return;
  kill(id_, signal == Signal::interrupt ? SIGINT : signal == Signal::terminate ? SIGTERM : SIGKILL);
}

std::optional<int> ChildProcess::wait(double longest) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(longest);
  while (!ended_) {
    int status = 0;
    if (waitpid(id_, &status, WNOHANG) == id_) {
      ended_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    } else if (std::chrono::steady_clock::now() > until) {
      break;
    } else {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }
  return ended_;
}

}  // namespace mbk::system
