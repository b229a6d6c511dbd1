# Run by cpack over what was installed, before it is packed: what Debian's policy wants of a package and what an installation
# elsewhere does not. Manual pages and changelogs are compressed, each package has its copyright, zsh has its folder.
file(GLOB roots ${CPACK_TEMPORARY_DIRECTORY}/*/usr)
if(NOT CPACK_DEB_COMPONENT_INSTALL)
  set(roots ${CPACK_TEMPORARY_DIRECTORY}/usr)
endif()
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)  # or SOURCE_DATE_EPOCH

foreach(root IN LISTS roots)
  cmake_path(GET root PARENT_PATH component)
  cmake_path(GET component FILENAME component)
  string(TOUPPER "${component}" component)
  set(package ${CPACK_PACKAGE_NAME})
  if(CPACK_DEB_COMPONENT_INSTALL)
    set(package ${CPACK_DEBIAN_${component}_PACKAGE_NAME})
  endif()

  set(folder ${root}/share/doc/${package})
  file(MAKE_DIRECTORY ${folder})
  file(COPY_FILE ${CPACK_SLAMDB_SOURCE}/CHANGELOG.md ${folder}/changelog)
  file(WRITE ${folder}/changelog.Debian
    "slamdb (${CPACK_PACKAGE_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}) unstable; urgency=medium\n\n"
    "  * Packed by cpack from the source tree; what changed is in changelog.gz.\n\n"
    " -- ${CPACK_PACKAGE_CONTACT}  ${date}\n")
  file(READ ${CPACK_SLAMDB_SOURCE}/LICENSE license)
  string(REGEX REPLACE "^BSD 3-Clause License\n\n(Copyright [^\n]*)\n\n" "" license "${license}")
  set(holder "${CMAKE_MATCH_1}")
  string(REPLACE "Copyright (c) " "" holder "${holder}")
  string(REGEX REPLACE "\n+$" "" license "${license}")
  string(REPLACE "\n\n" "\n.\n" license "${license}")
  string(REPLACE "\n" "\n " license "${license}")
  file(WRITE ${folder}/copyright
    "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/\nUpstream-Name: slamdb\n\n"
    "Files: *\nCopyright: ${holder}\nLicense: BSD-3-clause\n ${license}\n")

  file(GLOB pages ${root}/share/man/man1/*.1)
  execute_process(COMMAND gzip -9n ${folder}/changelog ${folder}/changelog.Debian ${pages} COMMAND_ERROR_IS_FATAL ANY)
  file(CHMOD_RECURSE ${folder} FILE_PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ
    DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
  if(EXISTS ${root}/share/zsh/site-functions)
    file(RENAME ${root}/share/zsh/site-functions ${root}/share/zsh/vendor-completions)
  endif()
endforeach()
