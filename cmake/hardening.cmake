# What makes a fault harder to exploit. Linker options cost nothing when the program runs: the tables of functions are
# filled in at the start and read-only from then on.
if(NOT CMAKE_CROSSCOMPILING)
  add_link_options(-Wl,-z,relro -Wl,-z,now -Wl,-z,noexecstack)
endif()
# Checks of the stack and of buffers with a known size; jumps only to where a function begins. The sanitizers see more and
# do not go with them. Packages and the preset robot turn it on; those of development share objects and leave it out.
option(TRISKIN_HARDENED "Compile with stack protector, _FORTIFY_SOURCE and control-flow protection" OFF)
if(TRISKIN_HARDENED AND NOT CMAKE_CROSSCOMPILING AND NOT TRISKIN_SANITIZE AND CMAKE_BUILD_TYPE MATCHES "Rel")
  add_compile_options(-fstack-protector-strong -fstack-clash-protection -U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=2)
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    add_compile_options(-fcf-protection)
  endif()
endif()
# RUNPATH of what is installed. CMake makes room for another one by empty elements, and an empty element means the current
# folder: whoever starts the program there would load the libraries that lie in it. So these targets have their final
# RUNPATH from the start; the libraries of the program are in the system's folders.
function(triskin_final_runpath target)
  set_target_properties(${target} PROPERTIES BUILD_WITH_INSTALL_RPATH ON INSTALL_RPATH "${ARGN}")
endfunction()
