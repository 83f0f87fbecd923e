# The images: the loader, and the application linked for each of the two slots. Ceilings fail the build.
set(triskin_board ${CMAKE_CURRENT_SOURCE_DIR}/board/stm32g474)

add_library(triskin_fw_board STATIC ${triskin_board}/src/clock.cpp ${triskin_board}/src/flash.cpp ${triskin_board}/src/flash_area.cpp
            ${triskin_board}/src/can.cpp ${triskin_board}/src/usb.cpp ${triskin_board}/src/line.cpp ${triskin_board}/src/options.cpp ${triskin_board}/src/chain.cpp)
target_include_directories(triskin_fw_board PUBLIC ${triskin_board}/include ${triskin_board}/src)
target_link_libraries(triskin_fw_board PUBLIC triskin_fw_boot)
add_dependencies(triskin_fw_board triskin_layering)
set(TRISKIN_CRYSTAL_MHZ 8 CACHE STRING "Crystal of the board in MHz, a multiple of 4 up to 48: 8 on the patch controller, 24 on a NUCLEO-G474RE")
target_compile_definitions(triskin_fw_board PRIVATE TRISKIN_CRYSTAL_MHZ=${TRISKIN_CRYSTAL_MHZ}U)

# tools/check_stack.py leaves the bound of the stack, and the chain of calls that needs it, beside the image.
# triskin_image(name SCRIPT file FLASH_CEILING bytes RAM_CEILING bytes SOURCES files LIBS targets)
function(triskin_image name)
  cmake_parse_arguments(arg "" "SCRIPT;FLASH_CEILING;RAM_CEILING" "SOURCES;LIBS" ${ARGN})
  add_executable(${name} ${triskin_board}/src/startup.cpp ${triskin_board}/src/memory.cpp ${arg_SOURCES})
  set_target_properties(${name} PROPERTIES SUFFIX .elf LINK_DEPENDS "${triskin_board}/${arg_SCRIPT};${triskin_board}/sections.ld;${triskin_board}/app_sections.ld;${CMAKE_SOURCE_DIR}/tools/check_stack.py")
  target_link_libraries(${name} PRIVATE ${arg_LIBS} triskin_fw_board)
  target_link_options(${name} PRIVATE -L${triskin_board} -T${triskin_board}/${arg_SCRIPT} -Wl,-Map=$<TARGET_FILE:${name}>.map)
  add_custom_command(TARGET ${name} POST_BUILD
    COMMAND ${Python3_EXECUTABLE} ${CMAKE_SOURCE_DIR}/tools/check_image_size.py ${CMAKE_SIZE} $<TARGET_FILE:${name}>
            ${arg_FLASH_CEILING} ${arg_RAM_CEILING}
    COMMAND ${Python3_EXECUTABLE} ${CMAKE_SOURCE_DIR}/tools/check_stack.py ${CMAKE_OBJDUMP} ${CMAKE_ADDR2LINE} $<TARGET_FILE:${name}>
            ${triskin_board}/include/triskin/board/priorities.hpp $<TARGET_FILE:${name}>.stack
    VERBATIM)
endfunction()

triskin_image(triskin_loader SCRIPT loader.ld FLASH_CEILING 16384 RAM_CEILING 24576 SOURCES ${triskin_board}/src/loader_main.cpp)
foreach(slot a b)
  triskin_image(triskin_app_${slot} SCRIPT slot_${slot}.ld FLASH_CEILING 73728 RAM_CEILING 65536
                SOURCES ${triskin_board}/src/main.cpp LIBS triskin_fw_app)
endforeach()

# What triskin flash --firmware and dfu-util write.
add_custom_target(triskin_firmware_package ALL
  COMMAND ${CMAKE_OBJCOPY} -O binary $<TARGET_FILE:triskin_app_a> triskin_app_a.bin
  COMMAND ${CMAKE_OBJCOPY} -O binary $<TARGET_FILE:triskin_app_b> triskin_app_b.bin
  COMMAND ${Python3_EXECUTABLE} ${CMAKE_SOURCE_DIR}/tools/make_firmware_package triskin_app_a.bin triskin_app_b.bin triskin_firmware.tsf ${PROJECT_VERSION}
  DEPENDS triskin_app_a triskin_app_b WORKING_DIRECTORY ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} VERBATIM)
