# One interface target that every target of ours links: warnings, sanitizers, exact floating point.
add_library(triskin_options INTERFACE)
target_compile_options(triskin_options INTERFACE
  -Wall -Wextra -Wconversion -Wshadow -Wdouble-promotion $<$<BOOL:${TRISKIN_WERROR}>:-Werror>
  # Results must agree between gcc and clang: never contract a*b+c, never fast-math.
  -ffp-contract=off)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND TRISKIN_SANITIZE)
  # The sanitizers' instrumentation makes gcc 12 see null pointers and out-of-range indices that are not there.
  target_compile_options(triskin_options INTERFACE -Wno-null-dereference -Wno-maybe-uninitialized
                         -Wno-array-bounds -Wno-stringop-overflow -Wno-restrict)
endif()
if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  # libstdc++ 12's own stable_sort calls what it declares deprecated.
  target_compile_options(triskin_options INTERFACE -Wno-deprecated-declarations)
  # CGAL 5.5 has templates that nobody instantiates and that name a member that is not there (boost/graph/iterator.h); clang 19 looks at once.
  target_compile_options(triskin_options INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-fdelayed-template-parsing>
                         $<$<COMPILE_LANGUAGE:CXX>:-Wno-delayed-template-parsing-in-cxx20>)
  # Delayed bodies of libstdc++'s <algorithm> do not come back whole from a precompiled header (__is_signed is read as a keyword).
  set(CMAKE_DISABLE_PRECOMPILE_HEADERS ON)
endif()
if(TRISKIN_SANITIZE STREQUAL "thread")
  add_compile_options(-fsanitize=thread -fno-omit-frame-pointer)
  add_link_options(-fsanitize=thread)
elseif(TRISKIN_SANITIZE)
  add_compile_options(-fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
  add_link_options(-fsanitize=address,undefined)
  if(TRISKIN_FUZZERS)
    add_compile_options(-fsanitize=fuzzer-no-link)
  endif()
endif()
