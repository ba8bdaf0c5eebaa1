#include "render/passes/pass_context.h"

namespace souple::render {

std::string target_define(Target target) {
  switch (target) {
    case Target::material:
      return "TARGET_MATERIAL";
    case Target::glass_entry:
      return "TARGET_GLASS_ENTRY";
    case Target::glass_exit:
      return "TARGET_GLASS_EXIT";
    case Target::sunlight:
      return "TARGET_SUNLIGHT";
    case Target::depth:
      return "TARGET_DEPTH";
    case Target::pick:
      return "TARGET_PICK";
  }
  return {};
}

void draw_screen() {
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace souple::render
