#include <utility>

#include "mbk/files/journal/journal.h"

// Windows keeps no real time, so that nothing records there; journals of other computers are read.
namespace mbk::journal {
namespace {

tl::unexpected<Error> no_recording(const std::filesystem::path& file) {
  return fail(ErrorKind::usage, "on Windows mbk records nothing", "record on Linux", file.string());
}

}  // namespace

Writer::Writer(Writer&& other) noexcept = default;
Writer& Writer::operator=(Writer&& other) noexcept = default;
Writer::~Writer() = default;

Result<Writer> Writer::create(const std::filesystem::path& file, const Header& /*header*/, std::uint64_t /*expected*/) {
  return no_recording(file);
}

Error Writer::already_there(const std::filesystem::path& file) {
  return no_recording(file).value();
}

Result<void> Writer::append(std::span<const Tick> /*ticks*/) {
  return no_recording(file_);
}

Result<void> Writer::end(const Ending& /*ending*/) {
  return no_recording(file_);
}

Result<void> Writer::sync() const {
  return no_recording(file_);
}

bool Writer::reaches_disk() const noexcept {
  return false;
}

Writer::Place Writer::place() const {
  return Place::here;
}

Result<void> Writer::save_elsewhere() {
  return no_recording(file_);
}

int recorded_by(const std::filesystem::path& /*file*/) {
  return 0;
}

}  // namespace mbk::journal
