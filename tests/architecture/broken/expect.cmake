# Runs arrows.cmake on the tree beside this file, whose every include is a breach, and expects each to be named.
cmake_minimum_required(VERSION 3.25)
set(root ${CMAKE_CURRENT_LIST_DIR})
execute_process(COMMAND ${CMAKE_COMMAND} -DLAYERS=${root}/layers.cmake -DSOURCE=${root} -P ${ARROWS}
  RESULT_VARIABLE status ERROR_VARIABLE output)
if(status EQUAL 0)
  message(FATAL_ERROR "no breach was seen")
endif()
string(REGEX REPLACE "[ \n]+" " " output "${output}")
foreach(breach
    "lib/slamdb/low/low.h: includes slamdb/high/high.h, but low does not link high"
    "lib/slamdb/low/low.h: includes nlohmann/json.hpp, but low does not link nlohmann_json::nlohmann_json"
    "lib/slamdb/low/low.h: is installed and includes slamdb/low/detail/inner.h, which is not"
    "lib/slamdb/low/low.h: includes slamdb/low/gone.h, which does not exist"
    "lib/slamdb/high/stray.h: a header that is not public belongs into detail/"
    "lib/slamdb/slamdb.h: lacks slamdb/high/high.h"
    "cli/main.cc: the command lives on public headers")
  string(FIND "${output}" "${breach}" at)
  if(at EQUAL -1)
    message(FATAL_ERROR "not seen: ${breach}\nin: ${output}")
  endif()
endforeach()
