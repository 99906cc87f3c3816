# add_source_hash(TARGET FILE CONSTANT FOLDERS...): TARGET's sources may include "FILE.h", which holds
#   inline constexpr char CONSTANT[] = "<sha256 of all headers and sources of FOLDERS>";
# Written anew at build time when one of them changes: part of the names of cache files, so that
# changed code never takes what other code has made. FOLDERS: of the source tree, without those
# inside them.
function(add_source_hash target file constant)
  set(sources)
  foreach(folder ${ARGN})
    file(GLOB found CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/${folder}/*.h
      ${CMAKE_SOURCE_DIR}/${folder}/*.cpp)
    list(APPEND sources ${found})
  endforeach()
  string(REPLACE ";" "," folders "${ARGN}")
  set(header ${CMAKE_BINARY_DIR}/generated/${file}.h)
  set(script ${CMAKE_SOURCE_DIR}/cmake/write_source_hash.cmake)
  add_custom_command(OUTPUT ${header}
    COMMAND ${CMAKE_COMMAND} -DROOT=${CMAKE_SOURCE_DIR} -DFOLDERS=${folders} -DHEADER=${header}
      -DCONSTANT=${constant} -P ${script}
    DEPENDS ${sources} ${script}
    COMMENT "Hashing sources for ${file}.h"
    VERBATIM)
  target_sources(${target} PRIVATE ${header})
  target_include_directories(${target} PRIVATE ${CMAKE_BINARY_DIR}/generated)
endfunction()
