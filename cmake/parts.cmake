# triskin_part(NAME [SOLVER] [NO_UNITY] DEPENDS targets... [PRECOMPILE headers...]): the folder of the calling file, with
# include/triskin/NAME for what other parts use and src for the rest, as the library triskin_NAME (alias triskin::NAME).
#   SOLVER    never part of libtriskin, so it needs no position-independent code
#   NO_UNITY  its anonymous namespaces repeat names, so its files are compiled one by one
function(triskin_part name)
  cmake_parse_arguments(arg "SOLVER;NO_UNITY" "" "DEPENDS;PRECOMPILE" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/src/*.cpp)
  add_library(triskin_${name} STATIC ${sources})
  add_library(triskin::${name} ALIAS triskin_${name})
  target_include_directories(triskin_${name} PUBLIC include PRIVATE src)
  target_link_libraries(triskin_${name} PUBLIC triskin_options ${arg_DEPENDS})
  add_dependencies(triskin_${name} triskin_layering)
  if(NOT arg_SOLVER)
    triskin_position_independent(triskin_${name})
  endif()
  # A unity build or a precompiled header both save processor time.
  if(TRISKIN_UNITY AND NOT arg_NO_UNITY)
    set_target_properties(triskin_${name} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 12)
  elseif(arg_PRECOMPILE)
    triskin_precompile(triskin_${name} ${arg_PRECOMPILE})
  endif()
endfunction()

# triskin_precompile(target headers...): headers that cost each file of a target seconds to read are read once. System headers
# only: a header of ours would make every file of the target wait for it.
function(triskin_precompile target)
  target_precompile_headers(${target} PRIVATE ${ARGN})
  # ccache sees what a precompiled header holds only when gcc says so.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
endfunction()

set(triskin_data_headers <algorithm> <string> <vector> <Eigen/Geometry> <fmt/format.h> <nlohmann/json.hpp>)
