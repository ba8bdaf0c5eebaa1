# souple_embed(target function file...): adds to the target a source that defines
#   std::string_view souple::render::function(std::string_view name)
# which returns the text of the file of that name (without its folder), or an empty view.
function(souple_embed target function)
  set(entries "")
  foreach(file IN LISTS ARGN)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${file})
    file(READ ${file} text)
    cmake_path(GET file FILENAME name)
    string(APPEND entries "  if (name == \"${name}\") return R\"souple(${text})souple\";\n")
  endforeach()
  set(source ${CMAKE_CURRENT_BINARY_DIR}/${function}.cpp)
  file(CONFIGURE OUTPUT ${source} @ONLY CONTENT
"// Generated from the files it names.
#include <string_view>

namespace souple::render {

std::string_view @function@(std::string_view name);

std::string_view @function@(std::string_view name) {
@entries@  return {};
}

}  // namespace souple::render
")
  target_sources(${target} PRIVATE ${source})
endfunction()
