# Installs BUILD into a fresh folder, builds the project of this folder against it, and runs what came out on ATLAS.
cmake_minimum_required(VERSION 3.25)
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${ARGN} failed with ${status}:\n${output}")
  endif()
endfunction()

file(REMOVE_RECURSE ${FOLDER})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${FOLDER}/prefix)
run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR} -B ${FOLDER}/build -G Ninja -DCMAKE_PREFIX_PATH=${FOLDER}/prefix
    -DCONSUMER_SOURCE=${SOURCE} -DFIRST_LINES_SOURCE=${FIRST_LINES} -DLIVE_CONSUMER_SOURCE=${LIVE_SOURCE}
    -DBOOST_CONSUMER_SOURCE=${BOOST_SOURCE} -DCMAKE_CXX_FLAGS=${FLAGS})
run(${CMAKE_COMMAND} --build ${FOLDER}/build)
run(${FOLDER}/build/consumer ${ATLAS} ${FOLDER}/consumer.db)
run(${FOLDER}/build/first_lines ${ATLAS} ${ATLAS} ${FOLDER}/first.db)
run(${FOLDER}/prefix/bin/slamdb check "${FOLDER}/first.db#both")
execute_process(COMMAND ${FOLDER}/build/first_lines gone.osa ${ATLAS} ${FOLDER}/first.db RESULT_VARIABLE status ERROR_QUIET)
if(NOT status EQUAL 4)
  message(FATAL_ERROR "an atlas that is not there: exit status ${status}, expected 4 for kNotFound")
endif()

# Without CMake. Libraries in a prefix of their own are found by their run path.
set(ENV{PKG_CONFIG_PATH} ${FOLDER}/prefix/${LIBDIR}/pkgconfig)
execute_process(COMMAND pkg-config --cflags --libs slamdb OUTPUT_VARIABLE flags COMMAND_ERROR_IS_FATAL ANY)
separate_arguments(flags UNIX_COMMAND "${flags} ${FLAGS}")
run(${COMPILER} -std=c++20 ${FIRST_LINES} -o ${FOLDER}/by_pkg_config ${flags} -Wl,-rpath,${FOLDER}/prefix/${LIBDIR})
run(${FOLDER}/by_pkg_config ${ATLAS} ${ATLAS} ${FOLDER}/second.db)

# What is private stays at home.
file(GLOB_RECURSE private ${FOLDER}/prefix/include/*/detail/*)
if(private)
  message(FATAL_ERROR "private headers were installed: ${private}")
endif()

if(LIVE)
  run(${FOLDER}/build/live_consumer)
endif()
run(${FOLDER}/build/boost_consumer ${ATLAS} ${FOLDER})
run(${FOLDER}/prefix/bin/slamdb info ${FOLDER}/copy.osa)
run(${FOLDER}/prefix/bin/slamdb info ${ATLAS})
foreach(file share/man/man1/slamdb.1 share/man/man1/slamdb-check.1 share/bash-completion/completions/slamdb)
  if(NOT EXISTS ${FOLDER}/prefix/${file})
    message(FATAL_ERROR "${file} was not installed")
  endif()
endforeach()
