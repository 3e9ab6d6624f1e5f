# Hardening of every target, libraries and tests included: what a damaged file or a hostile datagram overwrites is noticed
# before it is used. tests/hardening.py looks for each of these in the programs as built. The sanitizers and libFuzzer
# bring checks of their own, which _FORTIFY_SOURCE would hide.
include(CheckPIESupported)
check_pie_supported(LANGUAGES C CXX)

if(WIN32)
  add_compile_options(-fstack-protector-strong)
  add_link_options(-fstack-protector-strong)  # which links what that calls
elseif(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND NOT CMAKE_CXX_FLAGS MATCHES "-fsanitize")
  add_compile_options(-fstack-protector-strong -fstack-clash-protection)
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    add_compile_options(-fcf-protection)
  endif()
  # It needs optimisation; the compiler of a distribution may define it already.
  add_compile_options("$<$<CONFIG:Release>:SHELL:-U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=2>")
endif()
if(WIN32)
  return()  # its linker asks for what there is without being told
endif()
# The tables through which functions of other libraries are called become read-only before main begins.
add_link_options(-Wl,-z,relro -Wl,-z,now -Wl,-z,noexecstack)
