# sinew_library(FOLDER SOURCES ... [PUBLIC ...] [PRIVATE ...]): the library of one top-level folder, alias sinew::FOLDER.
# sinew_part(FOLDER PART [FOLDERS ...] SOURCES ... [PUBLIC ...] [PRIVATE ...]): a library of a part of it, alias
# sinew::FOLDER_PART, whose headers are those of FOLDER/PART, or of the FOLDERS that are named; PART "core" has those that
# stand in FOLDER itself as well.
#
# Headers are named from the root of the tree ("identify/problem.h"; for users also <sinew/identify/problem.h>). Each target
# offers only its own folder (links in the build tree), so that an include against the direction of DESIGN does not compile:
# its target is not linked.
function(sinew_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  set(view ${PROJECT_BINARY_DIR}/include/${name})
  file(MAKE_DIRECTORY ${view})
  file(CREATE_LINK ${CMAKE_CURRENT_SOURCE_DIR} ${view}/${name} SYMBOLIC)
  sinew_target(${name} ${view} SOURCES ${ARG_SOURCES} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
endfunction()

function(sinew_part folder part)
  cmake_parse_arguments(ARG "" "" "FOLDERS;SOURCES;PUBLIC;PRIVATE" ${ARGN})
  if(NOT ARG_FOLDERS AND NOT part STREQUAL core)
    set(ARG_FOLDERS ${part})
  endif()
  set(view ${PROJECT_BINARY_DIR}/include/${folder}_${part})
  file(MAKE_DIRECTORY ${view}/${folder})
  if(part STREQUAL core)
    file(GLOB headers CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.h)
    foreach(header ${headers})
      get_filename_component(file ${header} NAME)
      file(CREATE_LINK ${header} ${view}/${folder}/${file} SYMBOLIC)
    endforeach()
  endif()
  foreach(inner ${ARG_FOLDERS})
    file(CREATE_LINK ${CMAKE_CURRENT_SOURCE_DIR}/${inner} ${view}/${folder}/${inner} SYMBOLIC)
  endforeach()
  sinew_target(${folder}_${part} ${view} SOURCES ${ARG_SOURCES} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
endfunction()

# sinew_target(NAME VIEW ...): a static library sinew_NAME, alias sinew::NAME, whose headers are reached through VIEW.
function(sinew_target name view)
  cmake_parse_arguments(ARG "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  file(CREATE_LINK ${view} ${view}/sinew SYMBOLIC)  # <sinew/identify/problem.h>
  add_library(sinew_${name} STATIC ${ARG_SOURCES})
  add_library(sinew::${name} ALIAS sinew_${name})
  set_target_properties(sinew_${name} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(sinew_${name} PUBLIC
    $<BUILD_INTERFACE:${view}>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/sinew> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(sinew_${name} PUBLIC sinew_compiler ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
  set_property(GLOBAL APPEND PROPERTY SINEW_LIBRARIES sinew_${name})
  sinew_unity(sinew_${name})
endfunction()
