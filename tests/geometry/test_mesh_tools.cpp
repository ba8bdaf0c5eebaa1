#include "checks.h"
#include "souple/error.h"
#include "souple/geometry/adjacency.h"
#include "souple/geometry/builders.h"
#include "souple/geometry/measures.h"
#include "souple/geometry/reorder.h"
#include "souple/geometry/rest_frames.h"
#include "souple/geometry/submesh.h"
#include "souple/geometry/vertex_maps.h"
#include "souple/geometry/weld.h"
#include "tests/expect_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <gtest/gtest.h>

namespace souple::test_geometry_mesh_tools {

TEST(Edges, OfTwoTrianglesInOrderOfFirstAppearance) {
  const std::vector<Triangle> triangles{{4, 7, 2}, {2, 7, 9}};
  const TriangleEdges edges = triangle_edges(triangles);
  EXPECT_EQ(edges.edges, (std::vector<Edge>{{4, 7}, {7, 2}, {2, 4}, {7, 9}, {9, 2}}));
  EXPECT_EQ(edges.of_triangle[1], (std::array<std::uint32_t, 3>{1, 3, 4}));
  EXPECT_EQ(unique_edges(triangles), edges.edges);
}

TEST(Edges, CountsFollowEuler) {
  const TriangleMesh ball = sphere(3, 1);
  EXPECT_EQ(unique_edges(ball.triangles).size(), ball.triangles.size() * 3 / 2);
  EXPECT_EQ(interior_edges(ball.triangles).size(), ball.triangles.size() * 3 / 2);
  EXPECT_TRUE(boundary_edges(ball.triangles).empty());
  const TriangleMesh sheet = grid(6, 4, 1);
  EXPECT_EQ(unique_edges(sheet.triangles).size(), 5u * 4 + 6 * 3 + 15);
  EXPECT_EQ(boundary_edges(sheet.triangles).size(), 2u * (5 + 3));
  EXPECT_EQ(interior_edges(sheet.triangles).size(), 53u - 16);
}

TEST(Edges, OfTetsFormASolidBall) {
  const TetMesh bar = tet_bar(3, 2, 2, {3, 2, 2});
  // V - E + F - T = 1 for a solid without holes.
  const std::size_t outside = surface_triangles(bar.tets).size();
  const std::size_t faces = (4 * bar.tets.size() + outside) / 2;
  EXPECT_EQ(
      long(bar.positions.size()) - long(unique_edges(bar.tets).size()) + long(faces) - long(bar.tets.size()),
      1);
}

TEST(Hinges, KeepOrientation) {
  // Both triangles of a hinge, read as (a, b, c) and (b, a, d), must face outward on a sphere.
  const TriangleMesh ball = sphere(2, 1);
  for (const auto& [a, b, c, d] : interior_edges(ball.triangles)) {
    const Vec3d &pa = ball.positions[a], &pb = ball.positions[b], &pc = ball.positions[c],
                &pd = ball.positions[d];
    EXPECT_GT(dot(cross(pb - pa, pc - pa), pa), 0);
    EXPECT_GT(dot(cross(pa - pb, pd - pb), pb), 0);
  }
}

TEST(Hinges, OfANonManifoldEdgePairNeighbors) {
  const std::vector<Triangle> book{{0, 1, 2}, {1, 0, 3}, {0, 1, 4}};
  EXPECT_EQ(interior_edges(book), (std::vector<Hinge>{{0, 1, 2, 3}, {1, 0, 3, 4}}));
  // Two triangles on the same corners have no hinge angle.
  EXPECT_TRUE(interior_edges(std::vector<Triangle>{{0, 1, 2}, {1, 0, 2}}).empty());
}

TEST(Edges, DegenerateTrianglesGiveNoLoop) {
  const TriangleEdges edges = triangle_edges(std::vector<Triangle>{{1, 1, 2}, {3, 3, 3}});
  EXPECT_EQ(edges.edges, (std::vector<Edge>{{1, 2}}));
  EXPECT_EQ(edges.of_triangle[0][0], TriangleEdges::no_edge);
}

TEST(VertexTriangles, AreThoseAroundAVertex) {
  const TriangleMesh sheet = grid(3, 3, 1);
  const Lists<std::uint32_t> around = vertex_triangles(sheet.triangles, 9);
  EXPECT_EQ(around[4].size(), 8u);  // the diagonals of a 3 x 3 grid meet in the center
  std::size_t sum = 0;
  for (std::size_t v = 0; v < 9; ++v)
    for (const std::uint32_t t : around[v]) {
      ++sum;
      const Triangle& triangle = sheet.triangles[t];
      EXPECT_TRUE(triangle[0] == v || triangle[1] == v || triangle[2] == v);
    }
  EXPECT_EQ(sum, 24u);
  EXPECT_THROW(vertex_triangles(sheet.triangles, 8), Error);
}

TEST(Components, AreNumberedByLowestVertex) {
  const std::vector<Triangle> triangles{{5, 6, 7}, {1, 2, 3}, {3, 8, 1}};
  const Components pieces = connected_components(triangles, 10);
  EXPECT_EQ(pieces.count, 5u);  // 0, {1 2 3 8}, 4, {5 6 7}, 9
  EXPECT_EQ(pieces.of_vertex, (std::vector<std::uint32_t>{0, 1, 1, 1, 2, 3, 3, 3, 1, 4}));
  EXPECT_EQ(connected_components(tet_bar(3, 3, 3, {1, 1, 1}).tets, 64).count, 1u);
}

TEST(CheckIndices, NamesTheCulprit) {
  TriangleMesh mesh = grid(2, 2, 1);
  mesh.triangles[1][2] = 99;
  EXPECT_EQ(error_of([&] { check_indices(mesh, "flag.obj"); }),
            "flag.obj: triangle 1 names vertex 99, but there are 4 vertices (numbered from 0)");
}

TEST(Measures, OfABoxFarFromTheOrigin) {
  TriangleMesh mesh = box({0.1, 0.2, 0.3}, 3);
  for (Vec3d& p : mesh.positions) p += Vec3d{1000, -2000, 500};
  EXPECT_NEAR(enclosed_volume(mesh.positions, mesh.triangles), 0.006, 1e-13);
  EXPECT_NEAR(surface_area(mesh.positions, mesh.triangles), 0.22, 1e-12);
  const BoundingBox bounds = bounding_box(mesh.positions);
  EXPECT_NEAR(bounds.size().y, 0.2, 1e-12);
  EXPECT_NEAR(bounds.center().y, -2000, 1e-12);
  EXPECT_NEAR(bounds.diagonal(), std::sqrt(0.14), 1e-12);
  for (Triangle& t : mesh.triangles) std::swap(t[0], t[1]);
  EXPECT_NEAR(enclosed_volume(mesh.positions, mesh.triangles), -0.006, 1e-13);
}

TEST(Measures, BoundingBoxSkipsWhatIsNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const BoundingBox bounds = bounding_box(std::vector<Vec3d>{{nan, 0, 0}, {1, 2, 3}, {2, 1, 4}});
  EXPECT_EQ(bounds.lo, (Vec3d{1, 1, 3}));
  EXPECT_EQ(bounds.hi, (Vec3d{2, 2, 4}));
  EXPECT_EQ(bounding_box({}).diagonal(), 0);
}

TEST(Measures, MassesSumToDensityTimesMeasureAndCenterStays) {
  const TriangleMesh sheet = disk(5, 20, 0.7);
  Vec3d moment;
  double sum = 0;
  const std::vector<double> masses = lumped_masses(sheet.positions, sheet.triangles, 0.2);
  for (std::size_t v = 0; v < masses.size(); ++v) {
    sum += masses[v];
    moment += sheet.positions[v] * masses[v];
  }
  EXPECT_NEAR(sum, 0.2 * surface_area(sheet.positions, sheet.triangles), 1e-14);
  EXPECT_NEAR(length(moment), 0, 1e-15);
  const TetMesh bar = tet_bar(4, 2, 2, {2, 1, 1});
  double tet_sum = 0;
  for (const double m : lumped_masses(bar, 1000)) tet_sum += m;
  EXPECT_NEAR(tet_sum, 2000, 1e-9);
  EXPECT_NEAR(tet_volume(bar), 2, 1e-14);
}

TEST(Measures, NormalsOfASpherePointAwayFromItsCenterAtEverySize) {
  for (const double radius : {1e-6, 1.0, 1e6}) {
    const TriangleMesh ball = sphere(3, radius);
    std::vector<Vec3f> positions;
    for (const Vec3d& p : ball.positions) positions.push_back(Vec3f(p));
    std::vector<Vec3f> normals(positions.size());
    vertex_normals<float>(positions, ball.triangles, normals);
    for (std::size_t v = 0; v < normals.size(); ++v) {
      EXPECT_NEAR(length(normals[v]), 1, 1e-6);
      EXPECT_GT(dot(Vec3d(normals[v]), normalized(ball.positions[v])), 0.995);
    }
  }
  TriangleMesh stray = grid(2, 2, 1);
  stray.positions.push_back({5, 5, 5});
  EXPECT_EQ(vertex_normals(stray)[4], Vec3d{});
  EXPECT_EQ(vertex_normals(stray)[0], (Vec3d{0, 1, 0}));
}

void expect_orthonormal(const RestFrame& f) {
  EXPECT_NEAR(length(f.warp), 1, 1e-12);
  EXPECT_NEAR(length(f.weft), 1, 1e-12);
  EXPECT_NEAR(dot(f.warp, f.weft), 0, 1e-12);
}

TEST(RestFrames, FollowTheUvsRound) {
  TriangleMesh mesh = grid(6, 5, 1);
  for (const RestFrame& f : rest_frames(mesh)) {
    expect_orthonormal(f);
    EXPECT_NEAR(length(f.warp - Vec3d{1, 0, 0}), 0, 1e-6);
  }
  // The pattern rotated by 30 degrees, and mirrored: warp follows U in space.
  const double c = std::cos(0.5), s = std::sin(0.5);
  for (const float mirror : {1.0f, -1.0f}) {
    for (std::size_t v = 0; v < mesh.uvs.size(); ++v) {
      const Vec3d& p = mesh.positions[v];
      mesh.uvs[v] = {float(c * p.x + s * p.z), mirror * float(-s * p.x + c * p.z)};
    }
    for (const RestFrame& f : rest_frames(mesh)) {
      expect_orthonormal(f);
      EXPECT_NEAR(length(f.warp - Vec3d{c, 0, s}), 0, 1e-6);
      EXPECT_NEAR(length(cross(f.warp, f.weft) - Vec3d{0, 1, 0}), 0, 1e-6);
    }
  }
}

TEST(RestFrames, UvsOfQuadFaces) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {0, 0, 2}, {2, 0, 2}, {2, 0, 0}};
  mesh.faces = {{0, 1, 2, 3}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.uvs = {{9, 9}, {0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.face_uvs = {{1, 2, 3, 4}};  // U grows along +Z
  for (const RestFrame& f : rest_frames(mesh)) EXPECT_NEAR(length(f.warp - Vec3d{0, 0, 1}), 0, 1e-12);
  mesh.face_uvs = {{1, 2, 3}};
  EXPECT_THROW(rest_frames(mesh), Error);
  mesh.face_uvs = {{1, 2, 3, 5}};
  EXPECT_THROW(rest_frames(mesh), Error);
}

TEST(RestFrames, WithoutUvsTheGrainIsOneAllOver) {
  const TriangleMesh ball = sphere(3, 1);
  for (const RestFrame& f : rest_frames(ball)) {
    expect_orthonormal(f);
    EXPECT_GT(f.warp.x, 0);
  }
  // Perpendicular to the fallback: the first edge.
  TriangleMesh wall;
  wall.positions = {{0, 0, 0}, {0, 2, 0}, {0, 0, 3}};
  wall.triangles = {{0, 1, 2}, {0, 1, 1}};
  const auto frames = rest_frames(wall);
  EXPECT_EQ(frames[0].warp, (Vec3d{0, 1, 0}));
  EXPECT_EQ(frames[1].warp, Vec3d{});
  const FlatTriangle flat = flatten(frames[0], wall.positions[0], wall.positions[1], wall.positions[2]);
  EXPECT_EQ(flat.b, (std::array<double, 2>{2, 0}));
  EXPECT_EQ(flat.c, (std::array<double, 2>{0, 3}));
}

// A grid with shuffled vertices, like meshes from modeling programs.
TriangleMesh shuffled_grid(int n) {
  TriangleMesh mesh = grid(n, n, 1);
  std::vector<std::uint32_t> order(mesh.positions.size());
  std::iota(order.begin(), order.end(), 0u);
  check::Random random(5);
  for (std::size_t i = order.size() - 1; i > 0; --i) std::swap(order[i], order[random.bits() % (i + 1)]);
  TriangleMesh result;
  for (const std::uint32_t v : order) result.positions.push_back(mesh.positions[v]);
  const std::vector<std::uint32_t> now = inverse_order(order);
  for (const Triangle& t : mesh.triangles) result.triangles.push_back({now[t[0]], now[t[1]], now[t[2]]});
  return result;
}

// Mean distance in memory between the ends of an edge.
double mean_span(const std::vector<Edge>& edges, const std::vector<std::uint32_t>& order) {
  const std::vector<std::uint32_t> now = inverse_order(order);
  double sum = 0;
  for (const Edge& e : edges) {
    const std::uint32_t a = now[e[0]], b = now[e[1]];
    sum += std::max(a, b) - std::min(a, b);
  }
  return sum / double(edges.size());
}

bool is_permutation_of_all(std::vector<std::uint32_t> order, std::size_t count) {
  std::sort(order.begin(), order.end());
  for (std::size_t i = 0; i < order.size(); ++i)
    if (order[i] != i) return false;
  return order.size() == count;
}

TEST(Reorder, MortonBringsNeighborsTogether) {
  const TriangleMesh mesh = shuffled_grid(60);
  const std::vector<Edge> edges = unique_edges(mesh.triangles);
  std::vector<std::uint32_t> identity(mesh.positions.size());
  std::iota(identity.begin(), identity.end(), 0u);
  const std::vector<std::uint32_t> morton = morton_order(mesh.positions);
  EXPECT_TRUE(is_permutation_of_all(morton, mesh.positions.size()));
  EXPECT_GT(mean_span(edges, identity), 1000);
  EXPECT_LT(mean_span(edges, morton), 100);
}

TEST(Reorder, MortonVisitsTheEightOctantsInTurn) {
  std::vector<Vec3d> corners;
  for (int i = 7; i >= 0; --i) corners.push_back({double(i & 1), double(i >> 1 & 1), double(i >> 2)});
  EXPECT_EQ(morton_order(corners), (std::vector<std::uint32_t>{7, 6, 5, 4, 3, 2, 1, 0}));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(morton_order(std::vector<Vec3d>{{nan, 0, 0}, {1, 1, 1}, {1, 1, 1}}),
            (std::vector<std::uint32_t>{1, 2, 0}));
}

/// A quad and a triangle beside it, and a vertex of no face.
TriangleMesh quad_and_triangle() {
  TriangleMesh mesh;
  mesh.positions = {{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0, 0}};
  mesh.triangles = {{1, 2, 3}, {1, 3, 4}, {2, 5, 3}};
  mesh.faces = {{1, 2, 3, 4}, {2, 5, 3}};
  mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0.5f, 0.5f}};
  mesh.face_uvs = {{0, 1, 2, 3}, {1, 4, 2}};
  mesh.colors = std::vector<Vec3f>(6, {1, 1, 1});
  mesh.groups = {{"loose", {0}}, {"right", {2, 3, 5}}};
  mesh.appearance.materials = {"red", "blue"};
  mesh.appearance.face_materials = {0, 1};
  mesh.appearance.smoothing = {1, 0};
  mesh.appearance.normals = {{0, 0, 1}, {0, 1, 0}};
  mesh.appearance.face_normals = {{0, 0, 0, 0}, {1, 1, 1}};
  return mesh;
}

TEST(Submesh, KeepsTheFacesWhollyOnItsVertices) {
  const TriangleMesh part = submesh(quad_and_triangle(), std::vector<std::uint32_t>{2, 3, 5});
  EXPECT_EQ(part.positions, (std::vector<Vec3d>{{1, 0, 0}, {1, 1, 0}, {2, 0, 0}}));
  EXPECT_EQ(part.triangles, (std::vector<Triangle>{{0, 2, 1}}));
  EXPECT_EQ(part.faces, (std::vector<std::vector<std::uint32_t>>{{0, 2, 1}}));
  EXPECT_EQ(part.uvs, (std::vector<std::array<float, 2>>{{1, 0}, {1, 1}, {0.5f, 0.5f}}));
  EXPECT_EQ(part.face_uvs, (std::vector<std::vector<std::uint32_t>>{{0, 2, 1}}));
  EXPECT_EQ(part.colors.size(), 3u);
  EXPECT_EQ(part.groups, (std::map<std::string, std::vector<std::uint32_t>>{{"right", {0, 1, 2}}}));
  EXPECT_EQ(part.appearance.face_materials, std::vector<std::uint32_t>{1});
  EXPECT_EQ(part.appearance.smoothing, std::vector<std::uint32_t>{0});
  EXPECT_EQ(part.appearance.normals, (std::vector<Vec3f>{{0, 1, 0}}));
  EXPECT_EQ(part.appearance.face_normals, (std::vector<std::vector<std::uint32_t>>{{0, 0, 0}}));
}

TEST(Submesh, OnAllVerticesIsTheMesh) {
  const TriangleMesh mesh = quad_and_triangle();
  const TriangleMesh whole = submesh(mesh, std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5});
  EXPECT_EQ(whole.positions, mesh.positions);
  EXPECT_EQ(whole.triangles, mesh.triangles);
  EXPECT_EQ(whole.uvs, mesh.uvs);
  EXPECT_EQ(whole.face_uvs, mesh.face_uvs);
  EXPECT_EQ(whole.groups, mesh.groups);
  EXPECT_EQ(whole.appearance, mesh.appearance);
}

TEST(VertexMaps, FromGroups) {
  TriangleMesh mesh = grid(3, 2, 1);
  mesh.groups = {{"collar", {0, 2}}, {"sleeve", {2, 3}}};
  EXPECT_EQ(map_from_group(mesh, "collar"), (std::vector<float>{1, 0, 1, 0, 0, 0}));
  EXPECT_EQ(map_from_groups(mesh, {{"collar", 2.0f}, {"sleeve", 3.0f}}, 0.5f),
            (std::vector<float>{2, 0.5f, 3, 3, 0.5f, 0.5f}));
  EXPECT_EQ(error_of([&] { map_from_group(mesh, "coller"); }),
            "the mesh has no group 'coller'; its groups are: collar, sleeve");
  mesh.groups["sleeve"].push_back(6);
  EXPECT_THROW(map_from_group(mesh, "sleeve"), Error);
}

TEST(VertexMaps, FromColors) {
  TriangleMesh mesh = grid(2, 2, 1);
  EXPECT_THROW(map_from_colors(mesh, ColorChannel::red), Error);
  mesh.colors = {{0, 0.25f, 1}, {1, 0.5f, 0}, {2, -1, 0.5f}, {0, 0, 0}};
  EXPECT_EQ(map_from_colors(mesh, ColorChannel::red), (std::vector<float>{0, 1, 1, 0}));
  EXPECT_EQ(map_from_colors(mesh, ColorChannel::green, 2, 4), (std::vector<float>{2.5f, 3, 2, 2}));
  EXPECT_EQ(map_from_colors(mesh, ColorChannel::blue, 1, 0), (std::vector<float>{0, 1, 0.5f, 1}));
  mesh.colors[3].x = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(map_from_colors(mesh, ColorChannel::red), Error);
}

// Each triangle with three vertices of its own, as in an STL file.
TriangleMesh exploded(const TriangleMesh& mesh) {
  TriangleMesh result;
  for (const Triangle& t : mesh.triangles) {
    const std::uint32_t first = std::uint32_t(result.positions.size());
    for (const std::uint32_t v : t) result.positions.push_back(mesh.positions[v]);
    result.triangles.push_back({first, first + 1, first + 2});
  }
  return result;
}

TEST(Weld, ClosesAnExplodedSphere) {
  const TriangleMesh ball = sphere(3, 1), triangle_soup = exploded(ball);
  const Weld weld = weld_vertices(triangle_soup.positions);
  EXPECT_EQ(weld.size(), ball.positions.size());
  const WeldedTriangles welded = weld_triangles(weld, triangle_soup.triangles);
  EXPECT_TRUE(check::is_watertight(welded.triangles));
  for (std::size_t v = 0; v < triangle_soup.positions.size(); ++v)
    EXPECT_EQ(triangle_soup.positions[weld.to_vertex[weld.to_welded[v]]], triangle_soup.positions[v]);
}

TEST(Weld, KeepsTheOrderOfTheUser) {
  const std::vector<Vec3d> p{{5, 0, 0}, {1, 0, 0}, {5, 0, 0}, {0, 0, 0}, {-0.0, 0, 0}, {1, 0, 0}};
  const Weld weld = weld_vertices(p);
  EXPECT_EQ(weld.to_vertex, (std::vector<std::uint32_t>{0, 1, 3}));
  EXPECT_EQ(weld.to_welded, (std::vector<std::uint32_t>{0, 1, 0, 2, 2, 1}));
  const std::vector<int> value{10, 11, 12, 13, 14, 15};
  EXPECT_EQ(gather<int>(weld, value), (std::vector<int>{10, 11, 13}));
  EXPECT_EQ(weld_vertices(std::vector<Vec3d>{{1, 2, 3}, {3, 2, 1}}).size(), 2u);
}

TEST(Weld, NoChainCreepsWithATolerance) {
  std::vector<Vec3d> line(10);
  for (std::size_t i = 0; i < line.size(); ++i) line[i].x = 0.6 * static_cast<double>(i);
  const Weld weld = weld_vertices(line, 1.0);
  EXPECT_EQ(weld.to_vertex, (std::vector<std::uint32_t>{0, 2, 4, 6, 8}));
}

TEST(Weld, AgreesWithTheQuadraticDefinition) {
  check::Random random(3);
  std::vector<Vec3d> p;
  for (int i = 0; i < 1500; ++i) {
    const Vec3d x = random.vector() + Vec3d{1e6, -1e6, 0};
    p.push_back(x);
    p.push_back(x + random.vector() * 0.05);
  }
  const double tolerance = 0.05;
  const Weld weld = weld_vertices(p, tolerance);
  std::vector<std::uint32_t> representatives;
  for (std::uint32_t v = 0; v < p.size(); ++v) {
    std::uint32_t found = v;
    for (const std::uint32_t r : representatives)
      if (length(p[r] - p[v]) <= tolerance) {
        found = r;
        break;
      }
    if (found == v) representatives.push_back(v);
    ASSERT_EQ(weld.to_vertex[weld.to_welded[v]], found);
  }
  EXPECT_LT(weld.size(), p.size());
}

TEST(Weld, RoundingToleranceJoinsRoundedCopiesAndNothingElse) {
  TriangleMesh ball = sphere(3, 100);
  const std::size_t count = ball.positions.size();
  for (std::size_t v = 0; v < count; ++v) ball.positions.push_back(ball.positions[v] + Vec3d{1e-8, 0, -1e-8});
  EXPECT_EQ(weld_vertices(ball.positions).size(), 2 * count);
  EXPECT_EQ(weld_vertices(ball.positions, rounding_tolerance(ball.positions)).size(), count);
}

TEST(Weld, SurvivesWhatIsNotFiniteOrExtreme) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const std::vector<Vec3d> p{{nan, 0, 0}, {nan, 0, 0}, {inf, 0, 0}, {inf, 0, 0}, {1, 1, 1}, {1, 1, 1}};
  EXPECT_EQ(weld_vertices(p).size(), 5u);
  EXPECT_EQ(weld_vertices(p, 0.1).size(), 5u);
  const std::vector<Vec3d> huge{{1.7e308, 0, 0}, {-1.7e308, 0, 0}, {1.7e308, 0, 0}, {5e-324, 0, 0}};
  EXPECT_EQ(weld_vertices(huge, 1e-9).size(), 3u);
  EXPECT_EQ(weld_vertices({}, 1e-9).size(), 0u);
  EXPECT_THROW(weld_vertices(p, -1), Error);
  EXPECT_THROW(weld_vertices(p, nan), Error);
}

TEST(Weld, DropsTrianglesThatLostAnEdge) {
  const std::vector<Vec3d> p{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}};
  const WeldedTriangles welded =
      weld_triangles(weld_vertices(p), std::vector<Triangle>{{0, 1, 3}, {0, 3, 2}});
  EXPECT_EQ(welded.triangles, (std::vector<Triangle>{{0, 1, 2}}));
  EXPECT_EQ(welded.source, (std::vector<std::uint32_t>{1}));
  EXPECT_THROW(weld_triangles(weld_vertices(p), std::vector<Triangle>{{0, 1, 4}}), Error);
}

}  // namespace souple::test_geometry_mesh_tools
