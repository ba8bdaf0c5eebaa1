#include "check_mesh.h"
#include "formats.h"
#include "souple/mesh_files/mesh_parse.h"
#include "souple/mesh_files/mesh_write.h"

#include <vector>

namespace souple::fuzz {

// A mesh that was read is written and read again: it must survive the writer's own groups and faces.
void parse_obj_bytes(std::string_view bytes) {
  const TriangleMesh mesh = parse_obj(bytes, "fuzz.obj");
  check(mesh);
  std::vector<Vec3f> positions;
  for (const Vec3d& p : mesh.positions) positions.emplace_back(p);
  const TriangleMesh again = must_read([&] { return parse_obj(obj_text(mesh, positions), "again.obj"); });
  require(again.triangles == mesh.triangles && again.face_uvs == mesh.face_uvs);
}

}  // namespace souple::fuzz
