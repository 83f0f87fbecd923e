# triskin_embed(variable name=file...): writes a C++ source that carries the files in the program, and sets `variable` to
# its path. The assembler reads the files (.incbin), so a file of a megabyte costs no compile time.
function(triskin_embed variable)
  set(blocks "")
  set(rows "")
  set(files "")
  set(number 0)
  set(types_js "text/javascript; charset=utf-8")
  set(types_css "text/css; charset=utf-8")
  set(types_html "text/html; charset=utf-8")
  set(types_txt "text/plain; charset=utf-8")
  foreach(pair ${ARGN})
    string(REGEX MATCH "^([^=]+)=(.*)$" match "${pair}")
    set(name "${CMAKE_MATCH_1}")
    set(file "${CMAKE_MATCH_2}")
    string(REGEX REPLACE ".*\\." "" extension "${name}")
    list(APPEND files "${file}")
    string(APPEND blocks "asm(\".section .rodata\\n\"
    \".global triskin_asset_${number}\\ntriskin_asset_${number}:\\n.incbin \\\"${file}\\\"\\n\"
    \".global triskin_asset_${number}_end\\ntriskin_asset_${number}_end:\\n.byte 0\\n.previous\\n\");
extern \"C\" const char triskin_asset_${number}[], triskin_asset_${number}_end[];\n")
    string(APPEND rows "      {\"${name}\", {\"${types_${extension}}\", between(triskin_asset_${number}, triskin_asset_${number}_end)}},\n")
    math(EXPR number "${number} + 1")
  endforeach()
  set(source ${CMAKE_CURRENT_BINARY_DIR}/embedded_assets.cpp)
  file(CONFIGURE OUTPUT ${source} @ONLY CONTENT "// Made by cmake/embed.cmake.
#include \"triskin/view/page.hpp\"

@blocks@
namespace triskin::view {
namespace {
std::string_view between(const char* first, const char* last) {
  return {first, static_cast<std::size_t>(last - first)};
}
}  // namespace

const std::map<std::string_view, Asset>& assets() {
  static const std::map<std::string_view, Asset> all{
@rows@  };
  return all;
}

}  // namespace triskin::view
")
  # Among the sources of a unity build it would be compiled without what it depends on, and a changed page would stay as it was.
  set_source_files_properties(${source} PROPERTIES OBJECT_DEPENDS "${files}" SKIP_UNITY_BUILD_INCLUSION ON)
  set(${variable} ${source} PARENT_SCOPE)
endfunction()
