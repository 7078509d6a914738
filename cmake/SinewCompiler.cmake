# What every target of ours is compiled with. C++17: Simbody 3.7's headers do not compile as C++20.
add_library(sinew_compiler INTERFACE)
target_compile_features(sinew_compiler INTERFACE cxx_std_17)
target_compile_options(sinew_compiler INTERFACE
  $<BUILD_INTERFACE:-Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual>
  # gcc 12 warns of every std::optional that it inlines (its bug 80635).
  $<BUILD_INTERFACE:$<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>>
  # Lets "#pragma omp simd" reorder the sums of the loops that ask for it; no OpenMP runtime is involved.
  $<BUILD_INTERFACE:-fopenmp-simd>
  # gcc looks for memory to free at 1 GB first, not at 128 MB: saves it a twelfth of its time.
  $<BUILD_INTERFACE:$<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=1000000>>)
if(SINEW_WERROR)
  target_compile_options(sinew_compiler INTERFACE $<BUILD_INTERFACE:-Werror>)
endif()
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
find_program(SINEW_CCACHE ccache)
if(SINEW_CCACHE)
  # ccache passes by every file with a precompiled header unless told that these differences do not matter.
  set(launcher ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${SINEW_CCACHE})
  target_compile_options(sinew_compiler INTERFACE $<BUILD_INTERFACE:$<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>>)
endif()
if(SINEW_KEEP_WARNINGS)
  set(launcher ${CMAKE_CURRENT_LIST_DIR}/keep_warnings.sh ${launcher})
endif()
if(launcher)
  set(CMAKE_C_COMPILER_LAUNCHER ${launcher})
  set(CMAKE_CXX_COMPILER_LAUNCHER ${launcher})
endif()
