# What `cmake --install` and the Debian package hold: the command, its man pages and completions (cli/), the library with
# its headers, and the package that find_package(slamdb) finds.
include(CMakePackageConfigHelpers)

set(libraries slamdb slamdb_boost)
if(SLAMDB_BUILD_LIVE)
  list(APPEND libraries slamdb_live_library)
endif()
install(TARGETS ${libraries} EXPORT slamdbTargets FILE_SET HEADERS)
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/slamdb)
install(EXPORT slamdbTargets NAMESPACE slamdb:: DESTINATION ${package_folder})
configure_package_config_file(cmake/slamdbConfig.cmake.in slamdbConfig.cmake INSTALL_DESTINATION ${package_folder})
if(SLAMDB_BUILD_LIVE)
  install(FILES cmake/FindOpenCVCore.cmake DESTINATION ${package_folder})
endif()
write_basic_package_version_file(slamdbConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/slamdbConfig.cmake ${PROJECT_BINARY_DIR}/slamdbConfigVersion.cmake
  DESTINATION ${package_folder})

# For builds without CMake: pkg-config --cflags --libs slamdb
if(NOT BUILD_SHARED_LIBS)
  set(pc_static_libs " -lsqlite3 -lz -lmd -pthread")
  if(SLAMDB_CAIRO)
    string(APPEND pc_static_libs " -lcairo")
  endif()
endif()
# Relative to the file itself, so that the whole may be moved.
file(RELATIVE_PATH pc_to_prefix /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
configure_file(cmake/slamdb.pc.in slamdb.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/slamdb.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
if(SLAMDB_BUILD_LIVE)
  configure_file(cmake/slamdb-live.pc.in slamdb-live.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/slamdb-live.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "the slamdb authors")
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
include(CPack)
