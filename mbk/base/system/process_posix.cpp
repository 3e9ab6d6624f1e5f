#include <elf.h>
#include <fmt/format.h>
#include <link.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/random.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <system_error>

#include "mbk/base/system/process.h"

namespace mbk::system {
namespace {

int find_build(dl_phdr_info* object, std::size_t /*bytes*/, void* found) {
  for (int k = 0; k < object->dlpi_phnum; ++k) {
    const auto& segment = object->dlpi_phdr[k];
    if (segment.p_type != PT_NOTE) continue;
    const auto* at = reinterpret_cast<const char*>(object->dlpi_addr + segment.p_vaddr);
    const char* const end = at + segment.p_memsz;
    while (at + sizeof(ElfW(Nhdr)) <= end) {
      ElfW(Nhdr) note;
      std::memcpy(&note, at, sizeof note);
      const auto padded = [](std::size_t n) { return (n + 3) / 4 * 4; };
      const char* const name = at + sizeof note;
      const char* const content = name + padded(note.n_namesz);
      if (note.n_type == NT_GNU_BUILD_ID && note.n_namesz == 4 && std::memcmp(name, "GNU", 4) == 0) {
        std::string& text = *static_cast<std::string*>(found);
        for (std::size_t b = 0; b < note.n_descsz; ++b) {
          text += fmt::format("{:02x}", static_cast<unsigned char>(content[b]));
        }
        return 1;
      }
      at = content + padded(note.n_descsz);
    }
  }
  return 1;  // the first object is the program itself
}

rusage usage_of_this_process() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage;
}

constexpr std::array kEndSignals = {SIGINT, SIGTERM, SIGHUP};

volatile std::sig_atomic_t signal_that_came = 0;

void note_signal(int signal) {
  signal_that_came = signal;
}

}  // namespace

int process_id() {
  return ::getpid();
}

std::string host_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

std::filesystem::path program_file() {
  std::error_code error;
  auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  errno = error.value();
  return error ? std::filesystem::path() : program;
}

std::string build_identity() {
  std::string build;
  dl_iterate_phdr(find_build, &build);
  return build;
}

bool is_administrator() {
  return ::geteuid() == 0;
}

double cpu_seconds() {
  const rusage usage = usage_of_this_process();
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

std::int64_t peak_memory() {
  return 1024 * std::int64_t{usage_of_this_process().ru_maxrss};
}

unsigned usable_processors() {
  cpu_set_t allowed;
  return sched_getaffinity(0, sizeof(allowed), &allowed) == 0 ? static_cast<unsigned>(CPU_COUNT(&allowed)) : 0;
}

bool random_bytes(std::span<std::byte> bytes, bool wait) {
  return ::getrandom(bytes.data(), bytes.size(), wait ? 0 : GRND_NONBLOCK) == std::ssize(bytes);
}

bool end_with_parent() {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  return ::getppid() != 1;
}

std::string signal_name(int number) {
  const char* const name = sigabbrev_np(number);
  return name != nullptr ? std::string("SIG") + name : "";
}

void set_environment(const char* name, const std::string& value) {
  ::setenv(name, value.c_str(), 1);
}

std::vector<std::string> arguments(int argc, char** argv) {
  return {argv + std::min(argc, 1), argv + argc};
}

NotedEndRequests::NotedEndRequests() {
  signal_that_came = 0;
  for (const int signal : kEndSignals) {
    struct sigaction action {};
    action.sa_handler = note_signal;
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    sigaction(signal, &action, nullptr);
  }
}

NotedEndRequests::~NotedEndRequests() {
  for (const int signal : kEndSignals) std::signal(signal, SIG_DFL);
}

EndRequest NotedEndRequests::came() const {
  switch (signal_that_came) {
    case SIGINT:
      return EndRequest::interrupt;
    case SIGTERM:
      return EndRequest::terminate;
    case SIGHUP:
      return EndRequest::hang_up;
    default:
      return EndRequest::none;
  }
}

int NotedEndRequests::exit_code() const {
  return 128 + signal_that_came;
}

}  // namespace mbk::system
