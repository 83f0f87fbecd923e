# The images: the loader, and the application linked for each of the two slots. Ceilings fail the build. ${triskin_chip} is
# the folder of the chip, which has the rest of the drivers.
set(triskin_board ${CMAKE_CURRENT_SOURCE_DIR}/board/stm32)

add_library(triskin_fw_board STATIC ${triskin_board}/src/flash.cpp ${triskin_board}/src/flash_area.cpp ${triskin_board}/src/can_port.cpp ${triskin_board}/src/pll.cpp
            ${triskin_board}/src/usb.cpp ${triskin_board}/src/line.cpp ${triskin_board}/src/options.cpp ${triskin_board}/src/chain.cpp
            ${triskin_board}/src/crash.cpp ${triskin_board}/src/health.cpp ${triskin_board}/src/serial.cpp ${triskin_board}/src/time.cpp
            ${triskin_chip}/src/clock.cpp ${triskin_chip}/src/can.cpp ${triskin_chip}/src/line_places.cpp)
target_include_directories(triskin_fw_board PUBLIC ${triskin_board}/include ${triskin_board}/src ${triskin_chip}/include ${triskin_board_folder})
target_link_libraries(triskin_fw_board PUBLIC triskin_fw_boot)
add_dependencies(triskin_fw_board triskin_layering)
set_target_properties(triskin_fw_board PROPERTIES UNITY_BUILD OFF)  # blocks have registers and bits of the same names

# The graph of calls is taken from an image with nothing in RAM; what runs during an erase goes there in the images below.
set(triskin_ram_code ${CMAKE_CURRENT_BINARY_DIR}/ram_code)
set(triskin_no_ram_code ${CMAKE_CURRENT_BINARY_DIR}/no_ram_code)
file(WRITE ${triskin_no_ram_code}/ram_code.ld "/* Nothing: this image is looked at, not flashed. */\n")
set(triskin_place ${Python3_EXECUTABLE} ${CMAKE_SOURCE_DIR}/tools/place_ram_code.py)

# tools/check_stack.py leaves the bound of the stack, and the chain of calls that needs it, beside the image.
# triskin_image(name SCRIPT file FLASH_CEILING bytes RAM_CEILING bytes SOURCES files LIBS targets)
function(triskin_image name)
  cmake_parse_arguments(arg "" "SCRIPT;FLASH_CEILING;RAM_CEILING" "SOURCES;LIBS" ${ARGN})
  add_executable(${name} ${triskin_board}/src/startup.cpp ${triskin_board}/src/memory.cpp ${arg_SOURCES})
  set_target_properties(${name} PROPERTIES UNITY_BUILD OFF SUFFIX .elf LINK_DEPENDS "${triskin_board}/${arg_SCRIPT};${triskin_board}/sections.ld;${triskin_board}/app_sections.ld;${CMAKE_SOURCE_DIR}/tools/check_stack.py")
  target_link_libraries(${name} PRIVATE ${arg_LIBS} triskin_fw_board)
  target_link_options(${name} PRIVATE -L${triskin_board} -T${triskin_board}/${arg_SCRIPT} -Wl,-Map=$<TARGET_FILE:${name}>.map)
  add_custom_command(TARGET ${name} POST_BUILD
    COMMAND ${Python3_EXECUTABLE} ${CMAKE_SOURCE_DIR}/tools/check_image_size.py ${CMAKE_SIZE} $<TARGET_FILE:${name}>
            ${arg_FLASH_CEILING} ${arg_RAM_CEILING}
    COMMAND ${Python3_EXECUTABLE} ${CMAKE_SOURCE_DIR}/tools/check_stack.py ${CMAKE_OBJDUMP} ${CMAKE_ADDR2LINE} $<TARGET_FILE:${name}>
            ${triskin_board}/include/triskin/board/priorities.hpp $<TARGET_FILE:${name}>.stack
    VERBATIM)
endfunction()

add_executable(triskin_app_graph ${triskin_board}/src/startup.cpp ${triskin_board}/src/memory.cpp ${triskin_board}/src/main.cpp)
set_target_properties(triskin_app_graph PROPERTIES UNITY_BUILD OFF SUFFIX .elf LINK_DEPENDS "${triskin_board}/slot_a.ld;${triskin_board}/app_sections.ld")
target_link_libraries(triskin_app_graph PRIVATE triskin_fw_app triskin_fw_board)
target_link_options(triskin_app_graph PRIVATE -L${triskin_no_ram_code} -L${triskin_board} -T${triskin_board}/slot_a.ld -Wl,-Map=$<TARGET_FILE:triskin_app_graph>.map)
add_custom_command(OUTPUT ${triskin_ram_code}/ram_code.ld
  COMMAND ${CMAKE_COMMAND} -E make_directory ${triskin_ram_code}
  COMMAND ${triskin_place} place ${CMAKE_OBJDUMP} ${CMAKE_ADDR2LINE} $<TARGET_FILE:triskin_app_graph> $<TARGET_FILE:triskin_app_graph>.map ${triskin_ram_code}/ram_code.ld
  DEPENDS triskin_app_graph ${CMAKE_SOURCE_DIR}/tools/place_ram_code.py ${CMAKE_SOURCE_DIR}/tools/check_stack.py VERBATIM)
add_custom_target(triskin_ram_code DEPENDS ${triskin_ram_code}/ram_code.ld)

triskin_image(triskin_loader SCRIPT loader.ld FLASH_CEILING 16384 RAM_CEILING 24576 SOURCES ${triskin_board}/src/loader_main.cpp)
foreach(slot a b)
  triskin_image(triskin_app_${slot} SCRIPT slot_${slot}.ld FLASH_CEILING 81920 RAM_CEILING 65536
                SOURCES ${triskin_board}/src/main.cpp LIBS triskin_fw_app)
  target_link_options(triskin_app_${slot} PRIVATE -L${triskin_ram_code})
  add_dependencies(triskin_app_${slot} triskin_ram_code)
  set_property(TARGET triskin_app_${slot} APPEND PROPERTY LINK_DEPENDS ${triskin_ram_code}/ram_code.ld)
  add_custom_command(TARGET triskin_app_${slot} POST_BUILD
    COMMAND ${triskin_place} check ${CMAKE_OBJDUMP} ${CMAKE_ADDR2LINE} $<TARGET_FILE:triskin_app_${slot}> $<TARGET_FILE:triskin_app_${slot}>.ram
    VERBATIM)
endforeach()

# What triskin flash --firmware and dfu-util write.
add_custom_target(triskin_firmware_package ALL
  COMMAND ${CMAKE_OBJCOPY} -O binary $<TARGET_FILE:triskin_app_a> triskin_app_a.bin
  COMMAND ${CMAKE_OBJCOPY} -O binary $<TARGET_FILE:triskin_app_b> triskin_app_b.bin
  COMMAND ${Python3_EXECUTABLE} ${CMAKE_SOURCE_DIR}/tools/make_firmware_package triskin_app_a.bin triskin_app_b.bin triskin_firmware.tsf ${PROJECT_VERSION}
  DEPENDS triskin_app_a triskin_app_b WORKING_DIRECTORY ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} VERBATIM)

# What a programmer writes into a new board. The tests program both: with the application in slot A, as it is delivered, and
# in slot B, where an update puts it.
set(triskin_pins ${triskin_board_folder}/triskin/board/board_config.hpp)
add_custom_target(triskin_factory_file ALL
  COMMAND ${CMAKE_OBJCOPY} -O binary $<TARGET_FILE:triskin_loader> triskin_loader.bin
  COMMAND ${Python3_EXECUTABLE} ${CMAKE_SOURCE_DIR}/tools/make_factory_file triskin_loader.bin triskin_app_a.bin 0x08004000 triskin_factory ${PROJECT_VERSION} ${triskin_pins} ${triskin_chip}
  COMMAND ${Python3_EXECUTABLE} ${CMAKE_SOURCE_DIR}/tools/make_factory_file triskin_loader.bin triskin_app_b.bin 0x08040000 triskin_factory_b ${PROJECT_VERSION} ${triskin_pins} ${triskin_chip}
  DEPENDS triskin_loader ${CMAKE_SOURCE_DIR}/tools/make_factory_file WORKING_DIRECTORY ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} VERBATIM)
add_dependencies(triskin_factory_file triskin_firmware_package)
