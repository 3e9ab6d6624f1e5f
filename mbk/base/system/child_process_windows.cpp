#include <utility>

#include "mbk/base/system/child_process.h"
#include "mbk/base/system/command_output.h"

// No command of Windows' mbk works in other processes: those that can, work in threads of their own.
namespace mbk::system {
namespace {

tl::unexpected<Error> no_processes(const std::string& program) {
  return bad_usage(program + ": on Windows mbk starts no other programs",
                   "omit the option that asks for them, or use mbk on Linux");
}

}  // namespace

Result<ChildProcess> ChildProcess::start(const std::vector<std::string>& command,
                                         const std::filesystem::path& /*output*/) {
  return no_processes(command.front());
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept : id_(std::exchange(other.id_, -1)), ended_(other.ended_) {}
ChildProcess::~ChildProcess() = default;
void ChildProcess::send(Signal /*signal*/) const {}
std::optional<int> ChildProcess::wait(double /*longest*/) {
  return ended_;
}

Result<CommandOutput> command_output(const std::vector<std::string>& command, double /*longest_s*/) {
  return no_processes(command.front());
}

}  // namespace mbk::system
