# A forbidden include or link breaks the build. Components see only the include folders of the targets they link; this check
# also catches relative paths, vendor headers, and links that no include shows, on every build.
set(TRISKIN_LINKS ${CMAKE_BINARY_DIR}/links.txt)
add_custom_target(triskin_layering ALL
  COMMAND ${Python3_EXECUTABLE} ${CMAKE_SOURCE_DIR}/tools/check_layering.py ${CMAKE_SOURCE_DIR} ${TRISKIN_LINKS}
  COMMENT "Checking that no include and no link crosses a forbidden seam"
  VERBATIM)

# Writes "target: what it links directly" for every target of ours, once all are declared.
function(triskin_write_links)
  set(folders ${CMAKE_SOURCE_DIR})
  set(text "")
  while(folders)
    list(POP_FRONT folders folder)
    get_property(inner DIRECTORY ${folder} PROPERTY SUBDIRECTORIES)
    list(APPEND folders ${inner})
    get_property(targets DIRECTORY ${folder} PROPERTY BUILDSYSTEM_TARGETS)
    foreach(target ${targets})
      get_target_property(type ${target} TYPE)
      if(type STREQUAL "UTILITY")
        continue()
      endif()
      set(links "")
      foreach(property LINK_LIBRARIES INTERFACE_LINK_LIBRARIES)
        get_target_property(value ${target} ${property})
        if(value)
          list(APPEND links ${value})
        endif()
      endforeach()
      string(REGEX REPLACE "\\$<LINK_ONLY:([^>]*)>" "\\1" links "${links}")
      list(REMOVE_DUPLICATES links)
      list(JOIN links " " links)
      string(APPEND text "${target}: ${links}\n")
    endforeach()
  endwhile()
  file(CONFIGURE OUTPUT ${TRISKIN_LINKS} CONTENT "${text}" @ONLY)
endfunction()
cmake_language(DEFER DIRECTORY ${CMAKE_SOURCE_DIR} CALL triskin_write_links)
