# A forbidden include breaks the build. Components see only the include folders of the targets they link;
# this text check also catches relative paths and vendor headers, on every build.
find_package(Python3 REQUIRED COMPONENTS Interpreter)
add_custom_target(triskin_layering ALL
  COMMAND ${Python3_EXECUTABLE} ${CMAKE_SOURCE_DIR}/tools/check_layering.py ${CMAKE_SOURCE_DIR}
  COMMENT "Checking that no include crosses a forbidden seam"
  VERBATIM)
