# Run by cpack once the files of the packages are staged: what Debian wants compressed, named or placed otherwise.
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)  # SOURCE_DATE_EPOCH, where it is set
set(changelog ${CPACK_TEMPORARY_DIRECTORY}/changelog.Debian)
configure_file(${CMAKE_CURRENT_LIST_DIR}/changelog.Debian.in ${changelog} @ONLY)

set(program ${CPACK_TEMPORARY_DIRECTORY}/program/usr/share)
set(development ${CPACK_TEMPORARY_DIRECTORY}/development/usr/share)

file(REMOVE ${program}/doc/mbk/LICENSE)  # copyright holds it
file(RENAME ${program}/doc/mbk/CHANGELOG.md ${program}/doc/mbk/changelog)
file(RENAME ${program}/zsh/site-functions ${program}/zsh/vendor-completions)
file(MAKE_DIRECTORY ${program}/lintian/overrides ${development}/lintian/overrides ${development}/doc/libmbk-dev)
file(COPY_FILE ${CMAKE_CURRENT_LIST_DIR}/lintian-overrides ${program}/lintian/overrides/mbk)
file(COPY_FILE ${CMAKE_CURRENT_LIST_DIR}/lintian-overrides ${development}/lintian/overrides/libmbk-dev)
file(COPY_FILE ${CMAKE_CURRENT_LIST_DIR}/copyright ${development}/doc/libmbk-dev/copyright)
file(COPY_FILE ${changelog} ${program}/doc/mbk/changelog.Debian)
file(COPY_FILE ${changelog} ${development}/doc/libmbk-dev/changelog.Debian)

# What programs are built with goes where the other headers are.
set(c ${CPACK_TEMPORARY_DIRECTORY}/c/usr)
if(EXISTS ${c})
  file(MAKE_DIRECTORY ${CPACK_TEMPORARY_DIRECTORY}/development/usr/include ${CPACK_TEMPORARY_DIRECTORY}/development/usr/lib)
  file(RENAME ${c}/include/mbk.h ${CPACK_TEMPORARY_DIRECTORY}/development/usr/include/mbk.h)
  file(REMOVE_RECURSE ${c}/include)
  if(EXISTS ${program}/doc/mbk/licences)  # of the libraries inside
    file(COPY ${program}/doc/mbk/licences DESTINATION ${c}/share/doc/libmbk1)
  endif()
  file(GLOB_RECURSE link LIST_DIRECTORIES false RELATIVE ${c} ${c}/libmbk.so)
  file(RENAME ${c}/${link} ${CPACK_TEMPORARY_DIRECTORY}/development/usr/${link})
  file(MAKE_DIRECTORY ${c}/share/lintian/overrides ${c}/share/doc/libmbk1)
  file(COPY_FILE ${CMAKE_CURRENT_LIST_DIR}/lintian-overrides ${c}/share/lintian/overrides/libmbk1)
  file(COPY_FILE ${CMAKE_CURRENT_LIST_DIR}/copyright ${c}/share/doc/libmbk1/copyright)
  file(COPY_FILE ${changelog} ${c}/share/doc/libmbk1/changelog.Debian)
endif()

# Debian keeps packages of Python in one place for all versions. The loader of the system finds the library.
set(python ${CPACK_TEMPORARY_DIRECTORY}/python/usr)
if(EXISTS ${python})
  file(GLOB folder ${python}/lib/python3.*)
  file(RENAME ${folder} ${python}/lib/python3)
  file(REMOVE ${python}/lib/python3/dist-packages/mbk/libmbk.so.1)
  file(MAKE_DIRECTORY ${python}/share/lintian/overrides ${python}/share/doc/python3-mbk)
  file(COPY_FILE ${CMAKE_CURRENT_LIST_DIR}/lintian-overrides ${python}/share/lintian/overrides/python3-mbk)
  file(COPY_FILE ${CMAKE_CURRENT_LIST_DIR}/copyright ${python}/share/doc/python3-mbk/copyright)
  file(COPY_FILE ${changelog} ${python}/share/doc/python3-mbk/changelog.Debian)
endif()

file(GLOB compressed ${program}/man/man1/*.1 ${program}/doc/mbk/changelog* ${development}/doc/libmbk-dev/changelog*
     ${c}/share/doc/libmbk1/changelog* ${python}/share/doc/python3-mbk/changelog*)
execute_process(COMMAND gzip -9n ${compressed} COMMAND_ERROR_IS_FATAL ANY)
