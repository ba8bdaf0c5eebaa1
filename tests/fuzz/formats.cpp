#include "formats.h"

namespace souple::fuzz {

namespace {

constexpr Format formats[] = {
    {"checkpoint", parse_checkpoint_bytes},
    {"manifest", parse_manifest_bytes},
    {"mdd", parse_mdd_bytes},
    {"msh", parse_msh_bytes},
    {"obj", parse_obj_bytes},
    {"pc2", parse_pc2_bytes},
    {"ply", parse_ply_bytes},
    {"scene", parse_scene_bytes},
    {"stl", parse_stl_bytes},
    {"tetgen", parse_tetgen_bytes},
    {"vtk", parse_vtk_bytes},
};

}  // namespace

const Format* find_format(std::string_view name) {
  for (const Format& format : formats) {
    if (format.name == name) return &format;
  }
  return nullptr;
}

}  // namespace souple::fuzz
