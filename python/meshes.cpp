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
      .field<&A::material_files>("material_files")
      .field<&A::materials>("materials")
      .field<&A::face_materials>("face_materials")
      .field<&A::smoothing>("smoothing")
      .field<&A::normals>("normals")
      .field<&A::face_normals>("face_normals");
  using M = TriangleMesh;
  Struct<M>(m, "TriangleMesh")
      .field<&M::positions>("positions")
      .field<&M::triangles>("triangles")
      .field<&M::uvs>("uvs")
      .field<&M::faces>("faces")
      .field<&M::face_uvs>("face_uvs")
      .field<&M::colors>("colors")
      .field<&M::groups>("groups")
      .field<&M::appearance>("appearance");
  Struct<TetMesh>(m, "TetMesh")
      .field<&TetMesh::positions>("positions")
      .field<&TetMesh::tets>("tets")
      .field<&TetMesh::groups>("groups");
  Struct<MeshImport>(m, "MeshImport")
      .field<&MeshImport::scale>("scale")
      .field<&MeshImport::up>("up")
      .field<&MeshImport::node>("node");
  using I = MeshAnimationImport;
  Struct<I>(m, "MeshAnimationImport")
      .field<&I::animation>("animation")
      .field<&I::node>("node")
      .field<&I::frame_rate>("frame_rate");
  Result<MeshAnimation>(m, "MeshAnimation")
      .field<&MeshAnimation::points>("points")
      .field<&MeshAnimation::times>("times")
      .field<&MeshAnimation::positions>("positions");
}

void bind_builders(py::module_& m) {
  using py::arg;
  m.def("grid", &grid, arg("columns"), arg("rows"), arg("size"),
        py::arg_v("diagonals", Diagonals::alternating, "Diagonals.alternating"), doc("grid"));
  m.def("disk", &disk, arg("rings"), arg("segments"), arg("radius"), doc("disk"));
  m.def("sphere", &sphere, arg("subdivisions"), arg("radius"), doc("sphere"));
  m.def("box", py::overload_cast<const Vec3d&, int>(&box), arg("size"), arg("divisions") = 1, doc("box"));
  m.def("box", py::overload_cast<const Vec3d&, const std::array<int, 3>&>(&box), arg("size"),
        arg("divisions"), doc("box"));
  m.def("torus", &torus, arg("major_radius"), arg("minor_radius"), arg("major_segments"),
        arg("minor_segments"), doc("torus"));
  m.def("capsule", &capsule, arg("radius"), arg("length"), arg("segments"), arg("rings"),
        arg("divisions") = 1, doc("capsule"));
  m.def("cylinder", &cylinder, arg("radius"), arg("height"), arg("segments"), arg("divisions") = 1,
        arg("cap_rings") = 1, doc("cylinder"));
  m.def("tet_bar", &tet_bar, arg("nx"), arg("ny"), arg("nz"), arg("size"), doc("tet_bar"));
  m.def("tet_ball", &tet_ball, arg("subdivisions"), arg("layers"), arg("radius"), doc("tet_ball"));
  m.def("fill", py::overload_cast<const Vec3d&, const Vec3d&, double, const std::string&>(&fill), arg("lo"),
        arg("hi"), arg("spacing"), arg("name") = "box", doc("fill"));
  m.def("fill", py::overload_cast<const TriangleMesh&, double, const std::string&>(&fill), arg("surface"),
        arg("spacing"), arg("name") = "mesh", doc("fill"));
}

MeshImport import_of(const std::optional<MeshImport>& options, const py::kwargs& kwargs,
                     const char* function) {
  return with_keywords(options, kwargs, function);
}

void bind_mesh_files(py::module_& m) {
  m.def(
      "read_triangle_mesh",
      [](const std::filesystem::path& path, const std::optional<MeshImport>& options,
         const py::kwargs& kwargs) {
        return read_triangle_mesh(path, import_of(options, kwargs, "read_triangle_mesh"));
      },
      py::arg("path"), py::arg("options") = py::none(), doc("read_triangle_mesh"));
  m.def(
      "read_tet_mesh",
      [](const std::filesystem::path& path, const std::optional<MeshImport>& options,
         const py::kwargs& kwargs) {
        return read_tet_mesh(path, import_of(options, kwargs, "read_tet_mesh"));
      },
      py::arg("path"), py::arg("options") = py::none(), doc("read_tet_mesh"));
  m.def(
      "read_mesh_animation",
      [](const std::filesystem::path& path, const std::optional<MeshAnimationImport>& options,
         const py::kwargs& kwargs) {
        return read_mesh_animation(path, with_keywords(options, kwargs, "read_mesh_animation"));
      },
      py::arg("path"), py::arg("options") = py::none(), doc("read_mesh_animation"));
  m.def("mesh_import_has_assimp", &mesh_import_has_assimp, doc("mesh_import_has_assimp"));
  m.def(
      "obj_text",
      [](std::span<const Vec3f> positions, std::span<const Vec3f> normals,
         std::span<const Triangle> triangles) { return obj_text(positions, normals, triangles); },
      py::arg("positions"), py::arg("normals"), py::arg("triangles"),
      "A surface as the text of an OBJ file.");
  m.def(
      "ply_bytes",
      [](std::span<const Vec3f> positions, std::span<const Vec3f> normals,
         std::span<const Triangle> triangles, const std::optional<std::vector<Vec3f>>& velocities) {
        return py::bytes(ply_bytes(positions, normals, triangles, velocities.value_or(std::vector<Vec3f>())));
      },
      py::arg("positions"), py::arg("normals"), py::arg("triangles"), py::arg("velocities") = py::none(),
      "A surface as the bytes of a PLY file, with velocities [m/s] if they are given.");
}

void bind_mesh_reports(py::module_& m) {
  using R = MeshReport;
  Result<R>(m, "MeshReport")
      .field<&R::vertex_count>("vertex_count")
      .field<&R::triangle_count>("triangle_count")
      .field<&R::non_finite_vertices>("non_finite_vertices")
      .field<&R::unreferenced_vertices>("unreferenced_vertices")
      .field<&R::duplicate_vertices>("duplicate_vertices")
      .field<&R::collapsed_triangles>("collapsed_triangles")
      .field<&R::zero_area_triangles>("zero_area_triangles")
      .field<&R::pieces>("pieces")
      .field<&R::is_closed>("is_closed")
      .field<&R::signed_volume>("signed_volume")
      .def("is_clean", &R::is_clean);
  m.def("inspect", py::overload_cast<const TriangleMesh&>(&inspect), py::arg("mesh"), doc("inspect"));
  m.def("describe", &describe, py::arg("report"), doc("describe"));
  m.def("map_from_group", &map_from_group, py::arg("mesh"), py::arg("group"), py::arg("inside") = 1,
        py::arg("outside") = 0, doc("map_from_group"));
}

}  // namespace

void bind_meshes(py::module_& m) {
  bind_mesh_structs(m);
  bind_builders(m);
  bind_mesh_files(m);
  bind_mesh_reports(m);
}

}  // namespace souple::python
