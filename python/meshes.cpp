#include "python/bind.h"
#include "python/enums.h"
#include "python/structs.h"
#include "souple/geometry/fill.h"
#include "souple/geometry/lattice.h"
#include "souple/geometry/mesh_report.h"
#include "souple/geometry/tet_mesh.h"
#include "souple/geometry/vertex_maps.h"
#include "souple/mesh_files/mesh_animation.h"
#include "souple/mesh_files/mesh_write.h"

#include <filesystem>
#include <pybind11/stl/filesystem.h>

namespace souple::python {

namespace {

void bind_mesh_structs(py::module_& m) {
  using A = FaceAppearance;
  Struct<A>(m, "FaceAppearance")
      .fields<&A::material_files, &A::materials, &A::face_materials, &A::smoothing, &A::normals,
              &A::face_normals>();
  using M = TriangleMesh;
  Struct<M>(m, "TriangleMesh")
      .fields<&M::positions, &M::triangles, &M::uvs, &M::faces, &M::face_uvs, &M::colors, &M::groups,
              &M::appearance>();
  Struct<TetMesh>(m, "TetMesh").fields<&TetMesh::positions, &TetMesh::tets, &TetMesh::groups>();
  Struct<MeshImport>(m, "MeshImport").fields<&MeshImport::scale, &MeshImport::up, &MeshImport::node>();
  using I = MeshAnimationImport;
  Struct<I>(m, "MeshAnimationImport").fields<&I::animation, &I::node, &I::frame_rate>();
  Result<MeshAnimation>(m, "MeshAnimation")
      .fields<&MeshAnimation::points, &MeshAnimation::times, &MeshAnimation::positions>();
}

void bind_builders(py::module_& m) {
  m.def("grid", &grid, "columns"_a, "rows"_a, "size"_a,
        py::arg_v("diagonals", Diagonals::alternating, "Diagonals.alternating"), doc("grid"));
  m.def("disk", &disk, "rings"_a, "segments"_a, "radius"_a, doc("disk"));
  m.def("sphere", &sphere, "subdivisions"_a, "radius"_a, doc("sphere"));
  m.def("box", py::overload_cast<const Vec3d&, int>(&box), "size"_a, "divisions"_a = 1, doc("box"));
  m.def("box", py::overload_cast<const Vec3d&, const std::array<int, 3>&>(&box), "size"_a, "divisions"_a,
        doc("box"));
  m.def("torus", &torus, "major_radius"_a, "minor_radius"_a, "major_segments"_a, "minor_segments"_a,
        doc("torus"));
  m.def("capsule", &capsule, "radius"_a, "length"_a, "segments"_a, "rings"_a, "divisions"_a = 1,
        doc("capsule"));
  m.def("cylinder", &cylinder, "radius"_a, "height"_a, "segments"_a, "divisions"_a = 1, "cap_rings"_a = 1,
        doc("cylinder"));
  m.def("tet_bar", &tet_bar, "nx"_a, "ny"_a, "nz"_a, "size"_a, doc("tet_bar"));
  m.def("tet_ball", &tet_ball, "subdivisions"_a, "layers"_a, "radius"_a, doc("tet_ball"));
  m.def("fill", py::overload_cast<const Vec3d&, const Vec3d&, double, const std::string&>(&fill), "lo"_a,
        "hi"_a, "spacing"_a, "name"_a = "box", doc("fill"));
  m.def("fill", py::overload_cast<const TriangleMesh&, double, const std::string&>(&fill), "surface"_a,
        "spacing"_a, "name"_a = "mesh", doc("fill"));
}

/// A function of a path and options, which are a struct or keywords.
template <class Options, class Read>
void def_read(py::module_& m, const char* name, const Read& read) {
  m.def(
      name,
      [read, name](const std::filesystem::path& path, const std::optional<Options>& options,
                   const py::kwargs& kwargs) { return read(path, with_keywords(options, kwargs, name)); },
      "path"_a, "options"_a = py::none(), doc(name));
}

void bind_mesh_files(py::module_& m) {
  def_read<MeshImport>(m, "read_triangle_mesh", &read_triangle_mesh);
  def_read<MeshImport>(m, "read_tet_mesh", &read_tet_mesh);
  def_read<MeshAnimationImport>(m, "read_mesh_animation", &read_mesh_animation);
  m.def("mesh_import_has_assimp", &mesh_import_has_assimp, doc("mesh_import_has_assimp"));
  m.def(
      "obj_text",
      [](std::span<const Vec3f> positions, std::span<const Vec3f> normals,
         std::span<const Triangle> triangles) { return obj_text(positions, normals, triangles); },
      "positions"_a, "normals"_a, "triangles"_a, "A surface as the text of an OBJ file.");
  m.def(
      "ply_bytes",
      [](std::span<const Vec3f> positions, std::span<const Vec3f> normals,
         std::span<const Triangle> triangles, const std::optional<std::vector<Vec3f>>& velocities) {
        return py::bytes(ply_bytes(positions, normals, triangles, velocities.value_or(std::vector<Vec3f>())));
      },
      "positions"_a, "normals"_a, "triangles"_a, "velocities"_a = py::none(),
      "A surface as the bytes of a PLY file, with velocities [m/s] if they are given.");
}

void bind_mesh_reports(py::module_& m) {
  using R = MeshReport;
  Result<R>(m, "MeshReport")
      .fields<&R::vertex_count, &R::triangle_count, &R::non_finite_vertices, &R::unreferenced_vertices,
              &R::duplicate_vertices, &R::collapsed_triangles, &R::zero_area_triangles, &R::pieces,
              &R::is_closed, &R::signed_volume>()
      .def("is_clean", &R::is_clean);
  m.def("inspect", py::overload_cast<const TriangleMesh&>(&inspect), "mesh"_a, doc("inspect"));
  m.def("describe", &describe, "report"_a, doc("describe"));
  m.def("map_from_group", &map_from_group, "mesh"_a, "group"_a, "inside"_a = 1, "outside"_a = 0,
        doc("map_from_group"));
}

}  // namespace

void bind_meshes(py::module_& m) {
  bind_mesh_structs(m);
  bind_builders(m);
  bind_mesh_files(m);
  bind_mesh_reports(m);
}

}  // namespace souple::python
