# cmake -DOUTPUT=parts.cc [-DTEMPLATE=page.html -DSTYLE=page.css -DSCRIPT=main.js] -P EmbedPage.cmake: writes the parts of
# the page of `slamdb view` into a C++ source (lib/slamdb/view/detail/parts.h), empty ones where none are given.
cmake_minimum_required(VERSION 3.25)
set(parts "// Made by cmake/EmbedPage.cmake.\n#include \"slamdb/view/detail/parts.h\"\n\nnamespace slamdb::view {\n")

# A raw string: what stands in the file is what stands in the program.
function(embed name file)
  set(text "")
  if(file)
    file(READ ${file} text)
    if(NOT name STREQUAL "kPageTemplate")  # whose end is the page's
      string(REGEX REPLACE "\n$" "" text "${text}")
    endif()
  endif()
  if(text MATCHES "\\)slamdb_page\"" OR (NOT name STREQUAL "kPageTemplate" AND text MATCHES "</(script|style)"))
    message(FATAL_ERROR "${file} would end where it is embedded")
  endif()
  set(parts "${parts}\nconst std::string_view ${name} = R\"slamdb_page(${text})slamdb_page\";\n" PARENT_SCOPE)
endfunction()

embed(kPageTemplate "${TEMPLATE}")
embed(kPageStyle "${STYLE}")
embed(kPageScript "${SCRIPT}")
file(WRITE ${OUTPUT} "${parts}\n}  // namespace slamdb::view\n")
