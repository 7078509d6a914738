# Headers of others that most of our files include: parsed once for all libraries, once for the program and once for all
# tests. A file still includes what it needs: the preset tidy compiles without (and clang-tidy reads every file alone).
set(SINEW_COMMON_HEADERS
  <algorithm> <array> <cmath> <functional> <map> <memory> <optional> <string> <string_view> <utility> <vector>
  <Eigen/Core> <fmt/format.h> <tl/expected.hpp>)

# sinew_precompile(TARGET HEADERS...) or sinew_precompile(TARGET REUSE_FROM OTHER): as target_precompile_headers.
function(sinew_precompile target)
  if(NOT SINEW_PRECOMPILED_HEADERS)
    return()
  elseif(ARGV1 STREQUAL REUSE_FROM)
    target_precompile_headers(${target} REUSE_FROM ${ARGV2})
  else()
    target_precompile_headers(${target} PRIVATE ${ARGN})
  endif()
endfunction()
