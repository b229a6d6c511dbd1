# What every target of the tree gets: the include root, warnings, sanitizers.
function(slamdb_configure target)
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/lib>)
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

# slamdb_layer(name [FOLDER folder] SOURCES files... HEADERS files... LINKS layers... PRIVATE libraries...): one folder of
# lib/slamdb, which may include only itself and what it links; tests/architecture holds it to that. HEADERS are the
# public ones, which are installed. Tests link single layers; users link the one library that is made of all of them.
function(slamdb_layer name)
  cmake_parse_arguments(LAYER "" "FOLDER" "SOURCES;HEADERS;LINKS;PRIVATE" ${ARGN})
  set(folder ${CMAKE_CURRENT_SOURCE_DIR})
  if(LAYER_FOLDER)
    set(folder ${folder}/${LAYER_FOLDER})
    list(TRANSFORM LAYER_SOURCES PREPEND ${LAYER_FOLDER}/)
  endif()
  list(TRANSFORM LAYER_HEADERS PREPEND ${folder}/)
  list(TRANSFORM LAYER_SOURCES REPLACE "^[^/].*" "${CMAKE_CURRENT_SOURCE_DIR}/\\0")
  add_library(slamdb_${name} STATIC ${LAYER_SOURCES})
  slamdb_configure(slamdb_${name})
  set_target_properties(slamdb_${name} PROPERTIES POSITION_INDEPENDENT_CODE ON ARCHIVE_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/layers
    SLAMDB_FOLDER "${folder}" SLAMDB_SOURCES "${LAYER_SOURCES}" SLAMDB_HEADERS "${LAYER_HEADERS}" SLAMDB_LINKS "${LAYER_LINKS};${LAYER_PRIVATE}")
  target_link_libraries(slamdb_${name} PUBLIC ${LAYER_LINKS} PRIVATE ${LAYER_PRIVATE})
  set_property(GLOBAL APPEND PROPERTY SLAMDB_LAYERS slamdb_${name})
endfunction()

# slamdb_library(target LAYERS layers... HEADERS files... PUBLIC libraries... PRIVATE libraries...): what users link,
# static or shared as BUILD_SHARED_LIBS says, made of the objects of its layers.
function(slamdb_library target)
  cmake_parse_arguments(LIBRARY "" "" "LAYERS;HEADERS;PUBLIC;PRIVATE" ${ARGN})
  set(headers ${LIBRARY_HEADERS})
  add_library(${target})
  slamdb_configure(${target})
  foreach(layer IN LISTS LIBRARY_LAYERS)
    target_sources(${target} PRIVATE $<TARGET_OBJECTS:${layer}>)
    get_target_property(layer_headers ${layer} SLAMDB_HEADERS)
    list(APPEND headers ${layer_headers})
  endforeach()
  target_sources(${target} PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR}/lib FILES ${headers})
  target_link_libraries(${target} PUBLIC ${LIBRARY_PUBLIC} PRIVATE ${LIBRARY_PRIVATE})
  # Before 1.0 a minor version may break the binary interface, as semantic versioning has it.
  set_target_properties(${target} PROPERTIES LINKER_LANGUAGE CXX INSTALL_RPATH "$ORIGIN" VERSION ${PROJECT_VERSION}
    SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR} SLAMDB_HEADERS "${headers}")
endfunction()
