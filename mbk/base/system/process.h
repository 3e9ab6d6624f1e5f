#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

/// This process.
namespace mbk::system {

[[nodiscard]] int process_id();
[[nodiscard]] std::string host_name();               ///< "" where it has none
[[nodiscard]] std::filesystem::path program_file();  ///< of this process; "" with errno where nobody says
/// The note that the linker leaves in every program it makes, as hexadecimal digits; "" where there is none.
[[nodiscard]] std::string build_identity();
[[nodiscard]] bool is_administrator();

[[nodiscard]] double cpu_seconds();          ///< taken by this process [s]
[[nodiscard]] std::int64_t peak_memory();    ///< of this process [bytes]
[[nodiscard]] unsigned usable_processors();  ///< for this process; 0 where nobody says

/// Not to be guessed.   @param wait  until the system has enough of them; otherwise the call may fail
[[nodiscard]] bool random_bytes(std::span<std::byte> bytes, bool wait = true);

/// This process is killed when its parent ends.   @returns  false: the parent has ended
[[nodiscard]] bool end_with_parent();

[[nodiscard]] std::string signal_name(int number);  ///< "SIGINT"; "" where it has none

void set_environment(const char* name, const std::string& value);

/// The words of the command line behind the program's name, in UTF-8.
[[nodiscard]] std::vector<std::string> arguments(int argc, char** argv);

/// What asked this process to end.
enum class EndRequest { none, interrupt, terminate, hang_up };

/// During its lifetime the request to end is noted, and a second one ends the program.
class NotedEndRequests {
 public:
  NotedEndRequests();
  NotedEndRequests(const NotedEndRequests&) = delete;
  NotedEndRequests& operator=(const NotedEndRequests&) = delete;
  ~NotedEndRequests();
  [[nodiscard]] EndRequest came() const;
  [[nodiscard]] int exit_code() const;  ///< 128 and the signal's number
};

}  // namespace mbk::system
