#include "apps/mbk/options/output.h"

#include <fmt/format.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <system_error>

#include "apps/mbk/caller.h"
#include "apps/mbk/terminal/messages.h"
#include "apps/mbk/terminal/terminal.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/base/core/printable.h"
#include "mbk/base/system/terminal.h"
#include "mbk/files/recording/write_file.h"

namespace mbk::app {

int report_error(const Error& error) {
  if (Caller* const caller = Caller::current(); caller != nullptr) {
    caller->fail(error);
  } else {
    std::fflush(stdout);
    if (terminal_at(system::kError).colour) {
      say("\x1b[1;31mmbk:\x1b[0m {}\n", error.line());
    } else {
      say("mbk: {}\n", error.line());
    }
  }
  switch (error.kind) {
    case ErrorKind::usage:
      return kWrongUsage;
    case ErrorKind::data:
      return kBadData;
    case ErrorKind::not_usable:
      return kNotUsable;
  }
  return kBadData;
}

void Output::add_options(Command command) {
  const Option out = command.add_option("--out", file, "write to this file instead of standard output")
                         .type_name("FILE")
                         .check(not_empty());
  command.add_flag("--overwrite", overwrite, "replace an existing file").needs(out);
}

Result<void> check_new_file(const std::filesystem::path& file, const char* option, bool overwrite,
                            const std::vector<std::filesystem::path>& inputs) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return {};
  for (const std::filesystem::path& input : inputs) {
    if (std::filesystem::equivalent(file, input, error)) {
      return fail(ErrorKind::usage, "this is an input file, which would be overwritten",
                  fmt::format("choose another name for {}", option), file.string());
    }
  }
  if (overwrite) return {};
  return fail(ErrorKind::usage, "the file already exists", "pass --overwrite to replace it", file.string());
}

namespace {

std::atomic<bool> reader_has_ended = false;

/// What nobody reads any more is no error.
Result<void> write_to_stdout(const std::string& text) {
  if (reader_has_ended) return {};
  flush_messages();  // so that both are in order at a terminal
  if (std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0) return {};
  const int error = errno;
  if (error == EPIPE) {
    reader_has_ended = true;
    return {};
  }
  return bad_data(fmt::format("standard output could not be written: {}", std::strerror(error)),
                  error == ENOSPC ? "free space on the disk" : "check where it is redirected to");
}

}  // namespace

void say_written(const std::string& what, bool quiet) {
  if (!quiet && Caller::current() == nullptr) say("mbk: wrote {}\n", what);
}

int ended(int code) noexcept {
  if (code != kFine || !reader_has_ended) return code;
  system::end_without_reader();
  return code;
}

Result<void> Output::check(const std::vector<std::filesystem::path>& inputs) const {
  return file ? check_new_file(*file, "--out", overwrite, inputs) : Result<void>{};
}

Result<void> Output::write(const std::string& text, const std::vector<std::filesystem::path>& sources) const {
  if (Caller* const caller = Caller::current(); caller != nullptr) {
    caller->write(text);
    if (!file) return {};
  }
  if (file) return recording::write_derived(*file, overwrite, text, sources);
  return write_to_stdout(printable_lines(text));
}

Result<void> print_text(const std::string& text) {
  return Output().write(text, {});
}

Result<void> Output::show(const std::string& text, const std::vector<std::filesystem::path>& sources) const {
  const bool printed = !file && Caller::current() == nullptr;
  return printed ? write_to_stdout(for_people(text, terminal_at(system::kOutput))) : write(text, sources);
}

}  // namespace mbk::app
