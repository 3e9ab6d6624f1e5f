#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>  // NOLINT(modernize-deprecated-headers): kill
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <system_error>
#include <utility>

#include "mbk/base/system/command_output.h"

namespace mbk::system {
namespace {

constexpr std::size_t kLargestOutput = std::size_t{1} << 28U;

/// Both ends of a pipe, which are closed.
struct Pipe {
  std::array<int, 2> ends{-1, -1};
  Pipe() {
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) ends = {-1, -1};
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe() {
    close_end(0);
    close_end(1);
  }
  void close_end(std::size_t which) {
    if (ends[which] >= 0) ::close(std::exchange(ends[which], -1));
  }
};

/// Reads what is there; false at the end.
bool read_some(int descriptor, std::string& text) {
  std::array<char, 65536> piece{};
  const ssize_t got = ::read(descriptor, piece.data(), piece.size());
  if (got < 0) return errno == EINTR || errno == EAGAIN;
  text.append(piece.data(), static_cast<std::size_t>(got));
  return got > 0;
}

}  // namespace

Result<CommandOutput> command_output(const std::vector<std::string>& command, double longest_s) {
  Pipe out, error;
  if (out.ends[0] < 0 || error.ends[0] < 0) return bad_data("no pipe can be made", "close other programs");
  std::vector<char*> arguments;
  for (const std::string& one : command) arguments.push_back(const_cast<char*>(one.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&files, out.ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&files, error.ends[1], STDERR_FILENO);
  pid_t id = -1;
  const int code = posix_spawnp(&id, arguments[0], &files, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (code != 0) {
    return bad_usage(fmt::format("{}: {}", command.front(), std::generic_category().message(code)),
                     "install it, or put its folder into PATH");
  }
  out.close_end(1);
  error.close_end(1);
  const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(longest_s);
  CommandOutput said;
  std::array<pollfd, 2> both{{{out.ends[0], POLLIN, 0}, {error.ends[0], POLLIN, 0}}};
  bool in_time = true;
  while (both[0].fd >= 0 || both[1].fd >= 0) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - std::chrono::steady_clock::now());
    in_time = left.count() > 0 && said.out.size() + said.error.size() < kLargestOutput;
    if (!in_time) break;
    if (::poll(both.data(), both.size(), static_cast<int>(std::min<std::int64_t>(left.count(), 1000))) < 0) continue;
    if (both[0].fd >= 0 && both[0].revents != 0 && !read_some(both[0].fd, said.out)) both[0].fd = -1;
    if (both[1].fd >= 0 && both[1].revents != 0 && !read_some(both[1].fd, said.error)) both[1].fd = -1;
  }
  if (!in_time) ::kill(id, SIGKILL);
  int status = 0;
  while (::waitpid(id, &status, 0) < 0 && errno == EINTR) continue;
  if (!in_time) return bad_data(fmt::format("{} does not answer", command.front()), "try again later");
  said.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return said;
}

}  // namespace mbk::system
