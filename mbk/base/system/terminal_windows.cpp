#include <fcntl.h>
#include <io.h>

#include "mbk/base/system/terminal.h"
#include "mbk/base/system/windows_api.h"

namespace mbk::system {
namespace {

HANDLE stream_of(int descriptor) {
  return GetStdHandle(descriptor == kInput    ? STD_INPUT_HANDLE
                      : descriptor == kOutput ? STD_OUTPUT_HANDLE
                                              : STD_ERROR_HANDLE);
}

}  // namespace

bool is_terminal(int descriptor) {
  DWORD mode = 0;
  return GetConsoleMode(stream_of(descriptor), &mode) != 0;  // _isatty is also true of NUL
}

std::size_t terminal_columns(int descriptor) {
  CONSOLE_SCREEN_BUFFER_INFO information{};
  if (GetConsoleScreenBufferInfo(stream_of(descriptor), &information) == 0) return 0;
  return static_cast<std::size_t>(information.srWindow.Right - information.srWindow.Left + 1);
}

bool shows_colours(int descriptor) {
  DWORD mode = 0;
  const HANDLE stream = stream_of(descriptor);
  return GetConsoleMode(stream, &mode) != 0 && SetConsoleMode(stream, mode | ENABLE_VIRTUAL_TERMINAL_PROCESSING) != 0;
}

bool prepare_streams() noexcept {
  SetConsoleOutputCP(CP_UTF8);
  SetConsoleCP(CP_UTF8);
  for (int descriptor = kInput; descriptor <= kError; ++descriptor) {
    if (_get_osfhandle(descriptor) >= 0) _setmode(descriptor, _O_BINARY);
  }
  return true;
}

bool wait_for_room(int /*descriptor*/, std::chrono::milliseconds longest) noexcept {
  Sleep(static_cast<DWORD>(longest.count()));
  return false;
}

void end_without_reader() noexcept {}

}  // namespace mbk::system
