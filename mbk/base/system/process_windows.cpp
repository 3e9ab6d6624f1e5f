#include <array>
#include <csignal>

#include "mbk/base/system/process.h"
#include "mbk/base/system/windows_api.h"
// after windows.h
#include <bcrypt.h>
#include <psapi.h>
#include <shellapi.h>

namespace mbk::system {
namespace {

volatile std::sig_atomic_t signal_that_came = 0;

void note_signal(int signal) {
  signal_that_came = signal;
}

}  // namespace

int process_id() {
  return static_cast<int>(GetCurrentProcessId());
}

std::string host_name() {
  std::array<wchar_t, 256> name{};
  auto length = static_cast<DWORD>(name.size());
  return GetComputerNameExW(ComputerNameDnsHostname, name.data(), &length) != 0 ? utf8({name.data(), length}) : "";
}

std::filesystem::path program_file() {
  std::array<wchar_t, 32768> name{};
  const DWORD length = GetModuleFileNameW(nullptr, name.data(), static_cast<DWORD>(name.size()));
  errno = length > 0 ? 0 : error_number();
  return std::wstring(name.data(), length);
}

std::string build_identity() {
  return "";
}

bool is_administrator() {
  return false;  // nothing is done otherwise
}

double cpu_seconds() {
  FILETIME began{}, ended{}, kernel{}, user{};
  if (GetProcessTimes(GetCurrentProcess(), &began, &ended, &kernel, &user) == 0) return 0.0;
  const auto seconds = [](const FILETIME& time) {
    return 1e-7 * (static_cast<double>(time.dwHighDateTime) * 4294967296.0 + static_cast<double>(time.dwLowDateTime));
  };
  return seconds(kernel) + seconds(user);
}

std::int64_t peak_memory() {
  PROCESS_MEMORY_COUNTERS counters{};
  counters.cb = sizeof counters;
  return K32GetProcessMemoryInfo(GetCurrentProcess(), &counters, sizeof counters) != 0
             ? static_cast<std::int64_t>(counters.PeakWorkingSetSize)
             : 0;
}

unsigned usable_processors() {
  return GetActiveProcessorCount(ALL_PROCESSOR_GROUPS);
}

bool random_bytes(std::span<std::byte> bytes, bool /*wait*/) {
  return BCryptGenRandom(nullptr, reinterpret_cast<unsigned char*>(bytes.data()), static_cast<ULONG>(bytes.size()),
                         BCRYPT_USE_SYSTEM_PREFERRED_RNG) >= 0;
}

bool end_with_parent() {
  return true;  // whoever starts it ends it
}

std::string signal_name(int /*number*/) {
  return "";
}

void set_environment(const char* name, const std::string& value) {
  _putenv_s(name, value.c_str());
}

std::vector<std::string> arguments(int /*argc*/, char** /*argv*/) {
  // Those of main are in the code page of the system.
  int count = 0;
  wchar_t** const words = CommandLineToArgvW(GetCommandLineW(), &count);
  std::vector<std::string> all;
  for (int k = 1; k < count; ++k) all.push_back(utf8(words[k]));
  LocalFree(words);
  return all;
}

NotedEndRequests::NotedEndRequests() {
  signal_that_came = 0;
  std::signal(SIGINT, note_signal);  // which then acts as usual
  std::signal(SIGTERM, note_signal);
}

NotedEndRequests::~NotedEndRequests() {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

EndRequest NotedEndRequests::came() const {
  const int signal = signal_that_came;
  return signal == SIGINT ? EndRequest::interrupt : signal == SIGTERM ? EndRequest::terminate : EndRequest::none;
}

int NotedEndRequests::exit_code() const {
  return 128 + signal_that_came;
}

}  // namespace mbk::system
