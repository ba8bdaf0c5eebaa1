#include "checks.h"
#include "souple/error.h"
#include "souple/geometry/builders.h"
#include "souple/geometry/close_holes.h"
#include "souple/geometry/lattice.h"
#include "souple/geometry/measures.h"
#include "souple/geometry/mesh_report.h"
#include "tests/expect_error.h"

#include <chrono>
#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

namespace souple::test_geometry_mesh_report {

TEST(MeshReport, BuiltMeshesAreClean) {
  for (const TriangleMesh& mesh : {sphere(2, 1), box({1, 2, 3}, 2), torus(1, 0.3, 12, 8),
                                   capsule(0.2, 1, 12, 4), cylinder(0.3, 1, 12, 2, 2)}) {
    const MeshReport report = inspect(mesh);
    EXPECT_TRUE(report.is_clean()) << describe(report).front();
    EXPECT_TRUE(report.is_closed);
    EXPECT_EQ(report.pieces, 1u);
    EXPECT_NEAR(report.signed_volume, check::volume(mesh), 1e-12);
    EXPECT_NO_THROW(require_closed(report, "mesh"));
    const RepairedSurface same = repair(mesh);
    EXPECT_EQ(same.triangles, mesh.triangles);
    EXPECT_TRUE(same.sentences.empty());
  }
}

TEST(MeshReport, CountsWhatIsBroken) {
  TriangleMesh mesh = sphere(2, 1);
  const std::uint32_t n = std::uint32_t(mesh.positions.size());
  mesh.positions.push_back(mesh.positions[5]);                                // a duplicate
  mesh.positions.push_back({9, 9, 9});                                        // in no triangle
  mesh.positions.push_back({std::numeric_limits<double>::infinity(), 0, 0});  // not finite, in no triangle
  mesh.triangles.push_back({5, n, 7});                                        // collapsed by the duplicate
  mesh.triangles.erase(mesh.triangles.begin() + 10);                          // a hole of three edges
  std::swap(mesh.triangles[100][0], mesh.triangles[100][1]);  // three edges with inconsistent winding
  const MeshReport report = inspect(mesh);
  EXPECT_EQ(report.duplicate_vertices, (std::vector<std::uint32_t>{n}));
  EXPECT_EQ(report.unreferenced_vertices, (std::vector<std::uint32_t>{n + 1, n + 2}));
  EXPECT_EQ(report.non_finite_vertices, (std::vector<std::uint32_t>{n + 2}));
  EXPECT_EQ(report.collapsed_triangles,
            (std::vector<std::uint32_t>{std::uint32_t(mesh.triangles.size()) - 1}));
  EXPECT_EQ(report.open_edges.size(), 3u);
  EXPECT_EQ(report.inconsistent_edges.size(), 3u);
  EXPECT_FALSE(report.is_closed);
  EXPECT_EQ(describe(report).size(), 6u);
  EXPECT_EQ(describe(report)[2].substr(0, 40), "1 vertex coincides with an earlier one (");
  const std::string text = error_of([&] { require_closed(report, "duck.obj"); });
  EXPECT_EQ(text.find("duck.obj: a closed surface is needed here, but 1 vertex is not finite"), 0u) << text;
  expect_words(text, {"3 edges are open (the first is between vertices"});
}

// Tetrahedra that are inside out, in rows; every tenth one in a box, as the wall of a cavity.
TEST(MeshReport, ManyPiecesTakeTimeInProportion) {
  const auto seconds_for = [](int count) {
    TriangleMesh mesh;
    const auto add = [&](const Vec3d& at, double size, bool inside_out) {
      const std::uint32_t first = std::uint32_t(mesh.positions.size());
      for (const Vec3d& p : {Vec3d{0, 0, 0}, Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}})
        mesh.positions.push_back(at + p * size);
      for (const auto& [a, b, c] :
           {Triangle{0, 2, 1}, Triangle{0, 1, 3}, Triangle{0, 3, 2}, Triangle{1, 2, 3}})
        mesh.triangles.push_back({first + a, first + (inside_out ? c : b), first + (inside_out ? b : c)});
    };
    for (int i = 0; i < count; ++i) {
      const Vec3d at = Vec3d{double(i % 50), double(i / 50 % 50), double(i / 2500)} * 8;
      add(at, 1, true);
      if (i % 10 == 0) add(at - Vec3d{1, 1, 1}, 5, false);
    }
    const auto start = std::chrono::steady_clock::now();
    const RepairedSurface repaired = repair(mesh);
    EXPECT_EQ(repaired.sentences, (std::vector<std::string>{"Reversed " + std::to_string(count - count / 10) +
                                                            " closed pieces to face outward."}));
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  const double tenth = seconds_for(10000), all = seconds_for(100000);
  EXPECT_LT(all, 30 * tenth + 0.5);
}

TEST(MeshReport, NonManifoldEdgesAndZeroArea) {
  TriangleMesh book;
  book.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {2, 0, 0}};
  book.triangles = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}, {0, 1, 5}};
  const MeshReport report = inspect(book);
  EXPECT_EQ(report.non_manifold_edges, (std::vector<Edge>{{0, 1}}));
  EXPECT_EQ(report.zero_area_triangles, (std::vector<std::uint32_t>{3}));
  EXPECT_EQ(repair(book).triangles.size(), 3u);
  book.triangles.push_back({0, 1, 77});
  EXPECT_THROW(inspect(book), Error);
  EXPECT_THROW(repair(book), Error);
}

TEST(Repair, TurnsTheFewAndTheClosedOutward) {
  const TriangleMesh ball = sphere(3, 1);
  TriangleMesh mixed = ball;
  for (std::size_t t = 0; t < mixed.triangles.size(); t += 5)
    std::swap(mixed.triangles[t][0], mixed.triangles[t][1]);
  const RepairedSurface repaired = repair(mixed);
  EXPECT_TRUE(check::is_watertight(repaired.triangles));
  EXPECT_NEAR(enclosed_volume(mixed.positions, repaired.triangles), check::volume(ball), 1e-12);
  ASSERT_EQ(repaired.sentences.size(), 1u);
  EXPECT_EQ(repaired.sentences[0], "Reversed 256 triangles to match the winding of the others.");

  TriangleMesh inward = ball;
  for (Triangle& t : inward.triangles) std::swap(t[0], t[1]);
  EXPECT_NEAR(enclosed_volume(ball.positions, repair(inward).triangles), check::volume(ball), 1e-12);
  EXPECT_EQ(repair(inward).sentences, (std::vector<std::string>{"Reversed 1 closed piece to face outward."}));
  // An open sheet has no outside: its winding is unchanged.
  TriangleMesh sheet = grid(4, 4, 1);
  for (Triangle& t : sheet.triangles) std::swap(t[0], t[1]);
  EXPECT_EQ(repair(sheet).triangles, sheet.triangles);
}

TEST(Repair, LeavesAMoebiusStripAndSaysSo) {
  // A ring of five triangles, the last reversed relative to the first.
  TriangleMesh strip;
  for (int i = 0; i < 5; ++i) strip.positions.push_back({double(i % 3), double(i), double(i * i)});
  for (std::uint32_t i = 0; i < 5; ++i) strip.triangles.push_back({i, (i + 1) % 5, (i + 2) % 5});
  const RepairedSurface surface = repair(strip);
  EXPECT_EQ(surface.triangles, strip.triangles);
  ASSERT_EQ(surface.sentences.size(), 1u);
  EXPECT_NE(surface.sentences[0].find("Moebius"), std::string::npos);
}

TEST(Repair, DropsWhatCannotMove) {
  TriangleMesh mesh = grid(3, 3, 1);
  const std::size_t good = mesh.triangles.size();
  mesh.positions.push_back({std::numeric_limits<double>::quiet_NaN(), 0, 0});
  mesh.triangles.push_back({0, 1, 9});
  mesh.triangles.push_back({0, 1, 2});  // on a line
  mesh.triangles.push_back({3, 3, 4});
  mesh.triangles.push_back({mesh.triangles[0][1], mesh.triangles[0][0], mesh.triangles[0][2]});
  const RepairedSurface surface = repair(mesh);
  EXPECT_EQ(surface.triangles.size(), good);
  for (std::size_t t = 0; t < good; ++t) EXPECT_EQ(surface.source[t], t);
  EXPECT_EQ(surface.sentences.size(), 4u);
}

TEST(Repair, ZeroAreaTrianglesOfAClosedSurfaceStay) {
  // A tetrahedron with one face split at the midpoint of an edge on one side only: the needle closes it.
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.5, 0, 0}};
  mesh.triangles = {{0, 2, 4}, {4, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}, {0, 4, 1}};
  EXPECT_TRUE(inspect(mesh).is_closed);
  EXPECT_EQ(inspect(mesh).zero_area_triangles.size(), 1u);
  EXPECT_TRUE(check::is_watertight(repair(mesh).triangles));
}

TEST(Repair, OfRandomTrianglesIsSound) {
  check::Random random(2);
  const double strange[] = {std::numeric_limits<double>::quiet_NaN(),
                            std::numeric_limits<double>::infinity(),
                            1e308,
                            -1e308,
                            5e-324,
                            0.0};
  for (int round = 0; round < 500; ++round) {
    TriangleMesh mesh;
    const std::size_t vertices = 3 + random.bits() % 8, triangles = random.bits() % 30;
    for (std::size_t v = 0; v < vertices; ++v) {
      mesh.positions.push_back(random.vector());
      if (random.bits() % 8 == 0) mesh.positions.back().y = strange[random.bits() % 6];
      if (random.bits() % 4 == 0) mesh.positions.back() = mesh.positions[random.bits() % (v + 1)];
    }
    const auto corner = [&] { return std::uint32_t(random.bits() % vertices); };
    for (std::size_t t = 0; t < triangles; ++t) {
      const std::uint32_t a = corner(), b = corner(), c = corner();
      mesh.triangles.push_back({a, b, c});
    }
    const MeshReport report = inspect(mesh);
    for (const std::string& line : describe(report)) EXPECT_FALSE(line.empty());
    const RepairedSurface surface = repair(mesh);
    ASSERT_EQ(surface.triangles.size(), surface.source.size());
    for (const Triangle& t : surface.triangles) {
      ASSERT_TRUE(t[0] != t[1] && t[1] != t[2] && t[2] != t[0]);
      for (const std::uint32_t v : t) {
        ASSERT_LT(v, surface.weld.size());
        ASSERT_TRUE(is_finite(mesh.positions[surface.weld.to_vertex[v]]));
      }
    }
    // A repaired mesh needs no further repair.
    TriangleMesh again;
    again.positions = gather<Vec3d>(surface.weld, mesh.positions);
    again.triangles = surface.triangles;
    EXPECT_EQ(repair(again, 0).triangles, surface.triangles) << "round " << round;
  }
}

/// A ball without its triangles above a height.
TriangleMesh open_ball(double height) {
  TriangleMesh ball = sphere(4, 1);
  std::erase_if(ball.triangles, [&](const Triangle& t) {
    return (ball.positions[t[0]].y + ball.positions[t[1]].y + ball.positions[t[2]].y) / 3 > height;
  });
  return ball;
}

TEST(Holes, AreFoundWhereTheyAre) {
  const TriangleMesh ball = open_ball(0.8);
  const std::vector<Hole> holes = find_holes(ball.positions, ball.triangles);
  ASSERT_EQ(holes.size(), 1u);
  EXPECT_NEAR(length(holes[0].center - Vec3d{0, 0.8, 0}), 0, 0.05);
  EXPECT_NEAR(holes[0].width, 1.2, 0.12);
  EXPECT_NEAR(holes[0].area, std::acos(-1.0) * 0.36, 0.2);
  EXPECT_TRUE(find_holes(sphere(3, 1).positions, sphere(3, 1).triangles).empty());
}

// Volume of a unit ball below y = h: pi (2/3 + h - h^3 / 3).
TEST(Holes, ClosedTheyBoundTheVolume) {
  const ClosedSurface ball = closed_surface(open_ball(0.8), "ball");
  EXPECT_EQ(ball.holes.size(), 1u);
  const MeshReport report = inspect(ball.mesh, 0);
  EXPECT_TRUE(report.is_closed);
  EXPECT_TRUE(report.inconsistent_edges.empty());
  const double expected = std::acos(-1.0) * (2.0 / 3 + 0.8 - 0.8 * 0.8 * 0.8 / 3);
  EXPECT_NEAR(report.signed_volume, expected, 0.03 * expected);
}

// Two holes that touch at a vertex are two loops.
TEST(Holes, ThatShareAVertexAreTwo) {
  TriangleMesh sheet = grid(6, 6, 1);
  const std::uint32_t middle = 2 * 6 + 2;
  std::erase_if(sheet.triangles, [&](const Triangle& t) {
    Vec3d c{};
    for (const std::uint32_t v : t) c += sheet.positions[v] / 3;
    const Vec3d d = c - sheet.positions[middle];
    return std::abs(d.x) < 0.2 && std::abs(d.z) < 0.2 && d.x * d.z > 0;
  });
  const std::vector<Hole> holes = find_holes(sheet.positions, sheet.triangles);
  EXPECT_EQ(holes.size(), 3u);  // and the rim of the sheet
  for (const Hole& hole : holes) EXPECT_GE(hole.loop.size(), 4u);
}

TEST(Lattice, FillsASurfaceWithSmallHoles) {
  // 0.13 of a ball's area, and turned inside out: open pieces have no outside until they are closed.
  TriangleMesh ball = open_ball(0.8);
  for (Triangle& t : ball.triangles) std::swap(t[1], t[2]);
  const Lattice lattice = build_lattice(ball, {.cell_size = 0.2}, "head");
  const double expected = std::acos(-1.0) * (2.0 / 3 + 0.8 - 0.8 * 0.8 * 0.8 / 3);
  EXPECT_NEAR(lattice.surface_volume, expected, 0.03 * expected);
  ASSERT_EQ(lattice.sentences.size(), 1u);
  EXPECT_EQ(lattice.sentences[0].find("Closed 1 hole (1."), 0u) << lattice.sentences[0];
  // The tets reach no further through the hole than through the surface.
  for (const Vec3d& x : lattice.mesh.positions) EXPECT_LT(x.y, 0.8 + 0.25);
  EXPECT_GT(lattice.inner, 0u);
}

TEST(Lattice, NamesTheHolesOfABowlAndWhatClosesThem) {
  expect_error([] { build_lattice(open_ball(0), {.cell_size = 0.2}, "bowl"); },
               {"1 hole (", "m wide at (", "Remesh"});
}

}  // namespace souple::test_geometry_mesh_report
