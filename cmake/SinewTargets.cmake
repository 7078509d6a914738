# sinew_library(FOLDER SOURCES ... [PUBLIC ...] [PRIVATE ...]): the library of one top-level folder, alias sinew::FOLDER.
#
# Headers are named from the root of the tree ("identify/problem.h"; outside of it also <sinew/identify/problem.h>).
# Each target offers only its own folder (a link in the build tree), so that an include against the direction of DESIGN
# does not compile: its target is not linked.
function(sinew_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  set(view ${PROJECT_BINARY_DIR}/include/${name})
  file(MAKE_DIRECTORY ${view}/sinew)
  foreach(link ${name} sinew/${name})
    file(CREATE_LINK ${CMAKE_CURRENT_SOURCE_DIR} ${view}/${link} SYMBOLIC)
  endforeach()
  add_library(sinew_${name} STATIC ${ARG_SOURCES})
  add_library(sinew::${name} ALIAS sinew_${name})
  set_target_properties(sinew_${name} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(sinew_${name} PUBLIC
    $<BUILD_INTERFACE:${view}>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/sinew> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(sinew_${name} PUBLIC sinew_compiler ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
endfunction()
