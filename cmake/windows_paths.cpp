// Text becomes a path in UTF-8 on Windows, too. libstdc++ takes bytes for the characters of C's locale there, which has
// none beyond ASCII, though it gives a path back in UTF-8. The linker leads its calls here (--wrap, target
// mbk_wrapped).
#include <codecvt>
#include <cwchar>
#include <locale>

using Of = std::codecvt<wchar_t, char, std::mbstate_t>;

std::codecvt_base::result from_utf8(const Of* self, std::mbstate_t& state, const char* from, const char* from_end,
                                    const char*& from_next, wchar_t* to, wchar_t* to_end,
                                    wchar_t*& to_next) asm("__wrap__ZNKSt7codecvtIwciE5do_inERiPKcS3_RS3_PwS5_RS5_");

std::codecvt_base::result from_utf8(const Of* /*self*/, std::mbstate_t& state, const char* from, const char* from_end,
                                    const char*& from_next, wchar_t* to, wchar_t* to_end, wchar_t*& to_next) {
  static const std::codecvt_utf8_utf16<wchar_t> utf8;
  return utf8.in(state, from, from_end, from_next, to, to_end, to_next);
}
