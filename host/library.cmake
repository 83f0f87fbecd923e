# libtriskin: the device side as a shared library with a C interface, its Python module, and how others find them
# (docs/library.md).
include(GNUInstallDirs)
if(NOT TRISKIN_LIBRARY)
  return()
endif()

file(GLOB library_sources CONFIGURE_DEPENDS library/src/*.cpp)
add_library(triskin_library SHARED ${library_sources})
set_target_properties(triskin_library PROPERTIES
  OUTPUT_NAME triskin EXPORT_NAME triskin VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}
  CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)
target_include_directories(triskin_library
  PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/library/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
  PRIVATE library/src)
target_link_libraries(triskin_library PRIVATE triskin_skin triskin_connect triskin_deploy triskin_recording triskin_options)
# Whatever is linked in stays inside: a program may have its own copy.
target_link_options(triskin_library PRIVATE -Wl,--exclude-libs,ALL)
if(NOT TRISKIN_SANITIZE)
  target_link_options(triskin_library PRIVATE -Wl,-z,defs)
endif()
target_compile_definitions(triskin_library PRIVATE TRISKIN_VERSION="${PROJECT_VERSION}")
add_dependencies(triskin_library triskin_layering)

install(TARGETS triskin_library EXPORT triskin COMPONENT library LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS triskin COMPONENT program RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(FILES library/include/triskin/triskin.h COMPONENT library DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/triskin)
set(triskin_cmake_folder ${CMAKE_INSTALL_LIBDIR}/cmake/triskin)
install(EXPORT triskin NAMESPACE triskin:: COMPONENT library FILE triskinConfig.cmake DESTINATION ${triskin_cmake_folder})
include(CMakePackageConfigHelpers)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/triskinConfigVersion.cmake COMPATIBILITY SameMinorVersion)
file(RELATIVE_PATH triskin_pc_up /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
configure_file(library/triskin.pc.in ${CMAKE_CURRENT_BINARY_DIR}/triskin.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/triskinConfigVersion.cmake COMPONENT library DESTINATION ${triskin_cmake_folder})
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/triskin.pc COMPONENT library DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

# The module is for Debian's Python, whose pybind11 it is built with.
set(TRISKIN_PYTHON /usr/bin/python3 CACHE FILEPATH "Interpreter that the Python module is built for")
find_package(pybind11 QUIET)
if(EXISTS ${TRISKIN_PYTHON})
  execute_process(COMMAND ${TRISKIN_PYTHON} -c "import sysconfig as s; print(s.get_path('include'), s.get_config_var('EXT_SUFFIX'), sep=';')"
                  OUTPUT_VARIABLE python_facts OUTPUT_STRIP_TRAILING_WHITESPACE)
endif()
list(GET python_facts 0 python_include)
if(NOT pybind11_FOUND OR NOT EXISTS "${python_include}/Python.h")
  message(STATUS "The Python module is left out: pybind11-dev, python3-dev or ${TRISKIN_PYTHON} is not there")
  return()
endif()
list(GET python_facts 1 python_suffix)
add_library(triskin_python MODULE python/src/module.cpp)
set_target_properties(triskin_python PROPERTIES
  OUTPUT_NAME triskin PREFIX "" SUFFIX ${python_suffix} CXX_VISIBILITY_PRESET hidden
  LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/python INSTALL_RPATH "$ORIGIN/../..;$ORIGIN/../../${CMAKE_LIBRARY_ARCHITECTURE}")
target_include_directories(triskin_python SYSTEM PRIVATE ${python_include} ${pybind11_INCLUDE_DIRS})
target_link_libraries(triskin_python PRIVATE triskin_library triskin_options)
add_dependencies(triskin_python triskin_layering)
install(TARGETS triskin_python COMPONENT python LIBRARY DESTINATION lib/python3/dist-packages)
