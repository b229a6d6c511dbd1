# What every target of the tree gets: the include root, warnings, sanitizers.
function(slamdb_configure target)
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/lib> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wshadow -Wconversion -Wnon-virtual-dtor -Wno-sign-conversion
    -Wno-missing-field-initializers)  # with designated initialisers, what is not named has its default
  if(SLAMDB_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(SLAMDB_SANITIZE)
    target_compile_options(${target} PUBLIC -fsanitize=${SLAMDB_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
    target_link_options(${target} PUBLIC -fsanitize=${SLAMDB_SANITIZE})
  endif()
endfunction()

# slamdb_layer(name SOURCES files... LINKS layers... PRIVATE libraries...): one folder of lib/slamdb, which may use only
# the layers it links.
function(slamdb_layer name)
  cmake_parse_arguments(LAYER "" "" "SOURCES;LINKS;PRIVATE" ${ARGN})
  add_library(slamdb_${name} STATIC ${LAYER_SOURCES})
  slamdb_configure(slamdb_${name})
  set_target_properties(slamdb_${name} PROPERTIES POSITION_INDEPENDENT_CODE ON EXPORT_NAME ${name})
  target_link_libraries(slamdb_${name} PUBLIC ${LAYER_LINKS} PRIVATE ${LAYER_PRIVATE})
  set_property(GLOBAL APPEND PROPERTY SLAMDB_LAYERS slamdb_${name})
endfunction()
