# Run by cpack once the files of both packages are staged: what Debian wants compressed, named or placed otherwise.
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

file(GLOB compressed ${program}/man/man1/*.1 ${program}/doc/mbk/changelog* ${development}/doc/libmbk-dev/changelog*)
execute_process(COMMAND gzip -9n ${compressed} COMMAND_ERROR_IS_FATAL ANY)
