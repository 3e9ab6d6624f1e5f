# Run by cpack once the files of the packages are staged: what Debian wants compressed, named or placed otherwise.
set(program ${CPACK_TEMPORARY_DIRECTORY}/program/usr/share)
set(development ${CPACK_TEMPORARY_DIRECTORY}/development/usr/share)

file(REMOVE ${program}/doc/mbk/LICENSE)  # copyright holds it
file(RENAME ${program}/doc/mbk/CHANGELOG.md ${program}/doc/mbk/changelog)
file(RENAME ${program}/zsh/site-functions ${program}/zsh/vendor-completions)
file(MAKE_DIRECTORY ${program}/lintian/overrides ${development}/lintian/overrides ${development}/doc/libmbk-dev)
file(COPY_FILE ${CMAKE_CURRENT_LIST_DIR}/lintian-overrides ${program}/lintian/overrides/mbk)
file(COPY_FILE ${CMAKE_CURRENT_LIST_DIR}/lintian-overrides ${development}/lintian/overrides/libmbk-dev)
file(COPY_FILE ${CMAKE_CURRENT_LIST_DIR}/copyright ${development}/doc/libmbk-dev/copyright)
file(COPY_FILE ${CPACK_MBK_CHANGELOG} ${program}/doc/mbk/changelog.Debian)
file(COPY_FILE ${CPACK_MBK_CHANGELOG} ${development}/doc/libmbk-dev/changelog.Debian)

# Debian keeps packages of Python in one place for all versions.
set(python ${CPACK_TEMPORARY_DIRECTORY}/python/usr)
if(EXISTS ${python})
  file(GLOB folder ${python}/lib/python3.*)
  file(RENAME ${folder} ${python}/lib/python3)
  file(MAKE_DIRECTORY ${python}/share/lintian/overrides ${python}/share/doc/python3-mbk)
  file(COPY_FILE ${CMAKE_CURRENT_LIST_DIR}/lintian-overrides ${python}/share/lintian/overrides/python3-mbk)
  file(COPY_FILE ${CMAKE_CURRENT_LIST_DIR}/copyright ${python}/share/doc/python3-mbk/copyright)
  file(COPY_FILE ${CPACK_MBK_CHANGELOG} ${python}/share/doc/python3-mbk/changelog.Debian)
endif()

file(GLOB compressed ${program}/man/man1/*.1 ${program}/doc/mbk/changelog* ${development}/doc/libmbk-dev/changelog*
     ${python}/share/doc/python3-mbk/changelog*)
execute_process(COMMAND gzip -9n ${compressed} COMMAND_ERROR_IS_FATAL ANY)
