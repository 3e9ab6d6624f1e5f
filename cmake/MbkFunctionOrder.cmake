# mbk_order_functions(TARGET FILE): the program has the functions that FILE lists in one place, before its others. The
# kernel maps a program in pieces of 64 kB: what stands between would be in memory, too. FILE has names as the linker knows
# them, one a line, where an asterisk stands for any end; bench/function_order.py writes it.
#
# GNU ld takes an order only as part of a whole script; so its own is asked for, and the names are put into it. Another
# linker leaves functions where they are.
include(CheckLinkerFlag)

function(mbk_order_functions target file)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
  execute_process(COMMAND ${CMAKE_LINKER} -pie -z relro -z now --verbose OUTPUT_VARIABLE said ERROR_QUIET RESULT_VARIABLE code)
  set(others "    *(.text .stub .text.* .gnu.linkonce.t.*)\n")
  string(REGEX MATCH "\n====+\n(.*)\n====+\n" found "${said}")
  set(script "${CMAKE_MATCH_1}")
  string(FIND "${script}" "${others}" place)
  if(NOT code EQUAL 0 OR place EQUAL -1)
    message(STATUS "${target}: functions stand where the linker puts them, for it is not GNU ld as it is known here")
    return()
  endif()
  file(STRINGS ${file} names)
  list(TRANSFORM names REPLACE "^(.+)$" "    *(.text.\\1)\n")
  list(JOIN names "" lines)
  string(REPLACE "${others}" "${lines}${others}" script "${script}")
  set(ordered ${CMAKE_CURRENT_BINARY_DIR}/${target}_function_order.ld)
  file(CONFIGURE OUTPUT ${ordered} CONTENT "${script}\n" @ONLY)
  check_linker_flag(CXX LINKER:-T,${ordered} MBK_ORDERS_FUNCTIONS)
  if(MBK_ORDERS_FUNCTIONS)
    target_link_options(${target} PRIVATE LINKER:-T,${ordered})
    set_property(TARGET ${target} APPEND PROPERTY LINK_DEPENDS ${ordered})
  endif()
endfunction()
