#include "souple/scene/keys/parts.h"

namespace souple::scene_format {

namespace {

CodecPtr<GridMesh> grid_codec() {
  auto keys = table<GridMesh>("grid",
                              "A flat sheet of square cells in the XZ plane, centered at the origin, facing "
                              "up. Vertex index = row * columns + column.");
  keys->required<&GridMesh::columns>("columns", number<int>(within(2, 10000)), "vertices along X")
      .required<&GridMesh::rows>("rows", number<int>(within(2, 10000)), "vertices along Z")
      .required<&GridMesh::size>("size", number<double>(size_range), "width along X [m]")
      .key<&GridMesh::diagonals>(
          "diagonals",
          enumeration<Diagonals>({{"alternating", Diagonals::alternating}, {"one_way", Diagonals::one_way}}),
          "how squares are split into triangles; one_way favors one direction and serves for comparison")
      .check([](const GridMesh& mesh, const JsonPath& path) {
        check_count(static_cast<double>(mesh.columns) * mesh.rows, path);
      });
  return keys;
}

CodecPtr<DiskMesh> disk_codec() {
  auto keys = table<DiskMesh>(
      "disk",
      "A flat disk in the XZ plane, facing up. Vertex 0 is the center; the others follow ring by ring.");
  keys->required<&DiskMesh::rings>("rings", number<int>(within(1, 10000)), "rings around the center")
      .required<&DiskMesh::segments>("segments", number<int>(within(3, 10000)), "vertices per ring")
      .required<&DiskMesh::radius>("radius", number<double>(size_range), "radius [m]")
      .check([](const DiskMesh& mesh, const JsonPath& path) {
        check_count(1 + static_cast<double>(mesh.rings) * mesh.segments, path);
      });
  return keys;
}

CodecPtr<SphereMesh> sphere_mesh_codec() {
  auto keys =
      table<SphereMesh>("sphere_mesh", "A closed sphere of 20 * 4^subdivisions nearly equal triangles.");
  keys->required<&SphereMesh::radius>("radius", number<double>(size_range), "radius [m]")
      .key<&SphereMesh::subdivisions>(
          "subdivisions", number<int>(within(0, 8)),
          "number of times that each triangle of an icosahedron is split into four");
  return keys;
}

CodecPtr<BoxMesh> box_mesh_codec() {
  auto keys = table<BoxMesh>("box_mesh", "A closed box, centered at the origin.");
  keys->required<&BoxMesh::size>("size", vector3<double>(size_range), "side lengths [m]")
      .key<&BoxMesh::divisions>("divisions", counts(1000), "cells along each side")
      .check([](const BoxMesh& mesh, const JsonPath& path) {
        const auto [x, y, z] = std::array<double, 3>{static_cast<double>(mesh.divisions[0]),
                                                     static_cast<double>(mesh.divisions[1]),
                                                     static_cast<double>(mesh.divisions[2])};
        check_count(2 * (x * y + y * z + z * x) + 2, path);
      });
  return keys;
}

CodecPtr<TorusMesh> torus_codec() {
  auto keys = table<TorusMesh>("torus", "A closed ring around the Y axis.");
  keys->required<&TorusMesh::major_radius>("major_radius", number<double>(size_range),
                                           "distance from the axis to the center of the tube [m]")
      .required<&TorusMesh::minor_radius>("minor_radius", number<double>(size_range),
                                          "radius of the tube [m]")
      .key<&TorusMesh::major_segments>("major_segments", number<int>(within(3, 2000)),
                                       "segments around the axis")
      .key<&TorusMesh::minor_segments>("minor_segments", number<int>(within(3, 2000)),
                                       "segments around the tube")
      .check([](const TorusMesh& mesh, const JsonPath& path) {
        if (mesh.minor_radius >= mesh.major_radius) {
          path.key("minor_radius")
              .fail("must be smaller than major_radius, " + number_text(mesh.major_radius) + "; found " +
                    number_text(mesh.minor_radius));
        }
      });
  return keys;
}

CodecPtr<CapsuleMesh> capsule_mesh_codec() {
  auto keys = table<CapsuleMesh>("capsule_mesh", "A closed cylinder along Y between two hemispheres.");
  keys->required<&CapsuleMesh::radius>("radius", number<double>(size_range), "radius [m]")
      .required<&CapsuleMesh::length>("length", number<double>(size_range),
                                      "length of the cylinder, without caps [m]")
      .key<&CapsuleMesh::segments>("segments", number<int>(within(3, 1000)), "segments around the axis")
      .key<&CapsuleMesh::rings>("rings", number<int>(within(1, 1000)), "rings of each hemisphere")
      .key<&CapsuleMesh::divisions>("divisions", number<int>(within(1, 1000)), "divisions along the length");
  return keys;
}

CodecPtr<CylinderMesh> cylinder_mesh_codec() {
  auto keys = table<CylinderMesh>("cylinder_mesh", "A closed cylinder along Y.");
  keys->required<&CylinderMesh::radius>("radius", number<double>(size_range), "radius [m]")
      .required<&CylinderMesh::height>("height", number<double>(size_range), "height [m]")
      .key<&CylinderMesh::segments>("segments", number<int>(within(3, 1000)), "segments around the axis")
      .key<&CylinderMesh::divisions>("divisions", number<int>(within(1, 1000)), "divisions along the height")
      .key<&CylinderMesh::cap_rings>("cap_rings", number<int>(within(1, 1000)), "rings of each cap");
  return keys;
}

CodecPtr<TetBarMesh> tet_bar_codec() {
  auto keys = table<TetBarMesh>("tet_bar", "A solid box of cells split into tets; for soft bodies only.");
  keys->required<&TetBarMesh::cells>("cells", counts(1000), "cells along X, Y and Z")
      .required<&TetBarMesh::size>("size", vector3<double>(size_range), "side lengths [m]")
      .check([](const TetBarMesh& mesh, const JsonPath& path) {
        check_count((mesh.cells[0] + 1.0) * (mesh.cells[1] + 1.0) * (mesh.cells[2] + 1.0), path);
      });
  return keys;
}

CodecPtr<TetBallMesh> tet_ball_codec() {
  auto keys = table<TetBallMesh>("tet_ball", "A solid ball of tets; for soft bodies only.");
  keys->key<&TetBallMesh::subdivisions>(
          "subdivisions", number<int>(within(0, 6)),
          "subdivisions of an icosahedron: 12, 42, 162, 642, 2562, 10242 or 40962 vertices on the surface")
      .key<&TetBallMesh::layers>("layers", number<int>(within(1, 20)),
                                 "shells between the center and the surface")
      .required<&TetBallMesh::radius>("radius", number<double>(size_range), "radius [m]");
  return keys;
}

}  // namespace

CodecPtr<UpAxis> up_codec() {
  return enumeration<UpAxis>({{"x", UpAxis::x}, {"y", UpAxis::y}, {"z", UpAxis::z}});
}

void check_count(double vertices, const JsonPath& path) {
  if (vertices > max_vertices) {
    path.fail("would have " + number_text(vertices) + " vertices; at most " + number_text(max_vertices) +
              " are allowed");
  }
}

CodecPtr<MeshDescription> mesh_codec(MeshUse use) {
  using M = MeshDescription;
  const char* heading =
      use == MeshUse::surface ? "surface" : (use == MeshUse::solid ? "solid" : "point_file");
  const char* doc = use == MeshUse::surface ? "A surface mesh, generated or read from a file."
                    : use == MeshUse::solid ? "The shape of a soft body: a surface, closed but for small "
                                              "holes, filled with a lattice of tets, or "
                                              "a tet mesh."
                                            : "Points from a file: the vertices of a mesh.";
  using V = decltype(M::source);
  std::vector<Alternative> sources;
  if (use == MeshUse::surface) {
    sources.push_back(alternative<V>("grid", grid_codec(), "a flat sheet"));
    sources.push_back(alternative<V>("disk", disk_codec(), "a flat disk"));
  }
  if (use != MeshUse::points) {
    sources.push_back(alternative<V>("sphere", sphere_mesh_codec(), "a closed sphere"));
    sources.push_back(alternative<V>("box", box_mesh_codec(), "a closed box"));
    sources.push_back(alternative<V>("torus", torus_codec(), "a closed ring"));
    sources.push_back(alternative<V>("capsule", capsule_mesh_codec(), "a closed capsule"));
    sources.push_back(alternative<V>("cylinder", cylinder_mesh_codec(), "a closed cylinder"));
  }
  if (use == MeshUse::solid) {
    sources.push_back(alternative<V>("tet_bar", tet_bar_codec(), "a box of tets"));
    sources.push_back(alternative<V>("tet_ball", tet_ball_codec(), "a ball of tets"));
  }
  const char* formats =
      use == MeshUse::solid
          ? "OBJ, PLY or STL, or with assimp glTF, FBX, COLLADA, 3DS, Blender, OFF or X3D for a "
            "surface; .msh, .node/.ele or .vtk for tets"
          : "OBJ, PLY or STL, or with assimp glTF, FBX, COLLADA, 3DS, Blender, OFF or X3D";
  sources.push_back(alternative<V>("file", wrapped<FileMesh>(&FileMesh::file, file()), formats));
  auto keys = table<M>(heading, doc);
  keys->choice<&M::source>(std::move(sources))
      .key<&M::import, &MeshImport::scale>("scale", number<double>(positive(1e6)),
                                           "meters per unit of the file")
      .key<&M::import, &MeshImport::up>(
          "up", up_codec(), "the axis that points up in the file; Blender writes STL and PLY with \"z\"")
      .key<&M::import, &MeshImport::node>(
          "node", text(),
          "reads only this object of the file: an object or group of OBJ, a node of glTF or FBX; if not "
          "given, all objects together")
      .needs("scale", "file")
      .needs("up", "file")
      .needs("node", "file");
  return keys;
}

}  // namespace souple::scene_format
