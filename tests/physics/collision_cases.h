#pragma once

#include "souple/souple.h"
#include "tests/intersections/crossings.h"

#include <vector>

// Scenes of the collision tests at any size: small for every day, large under the label slow.

namespace souple::test {

/// Results of a run.
struct Watched {
  std::size_t crossings = 0;   ///< edges through triangles, summed over all checked frames
  int first_crossed = -1;      ///< frame
  double largest_strain = 0;   ///< maximum over all frames
  std::size_t kept_apart = 0;  ///< number of motions that were stopped
  bool ok = true;              ///< no non-finite value
};

/// Runs frames of 1/60 s and counts crossings after each `every`-th, until the first crossing.
Watched run_without_crossings(World& world, int frames, int every = 1);

/// Speed of the fastest vertex of an object [m/s].
double top_speed(const World& world, ObjectId object);

// --- cloth

enum class Support { ball, ring, corner };
const char* support_name(Support support);

/// A square cloth of 1 m, n x n vertices, falls on a support above the floor. A bar under its left part lifts
/// it from `fold_at` on and lays it over the right part.
struct DrapeAndFold {
  World world;
  ObjectId cloth;
  double fold_at, end;  // s
};
DrapeAndFold drape_and_fold(int n, Support support);

/// A square cloth of 2 m, n x n vertices, stands on its edge, leans a little and falls into folds.
struct Heap {
  World world;
  ObjectId cloth;
};
Heap sheet_on_edge(int n);

/// A tube of cloth with driven rims; the upper rim turns `turns` times and approaches the lower one.
struct TwistedTube {
  World world;
  ObjectId tube;
  double end;  // s
};
TwistedTube twisted_tube(int around, double turns, double seconds);

/// Two strips tied in a reef knot. Springs pull at the ends with up to `pull` newtons per strip end.
struct Knot {
  World world;
  ObjectId left, right;
};
Knot reef_knot(int across, double pull);

// --- soft bodies

/// An open cup with thick walls around the Y axis: a closed mesh that stands on y = 0.
TriangleMesh glass_mesh(double radius, double height, double wall, int segments);

/// Balls of tets of 5 cm, in layers, fall into a glass.
struct Glass {
  World world;
  TetMesh ball;
  std::vector<ObjectId> balls;
  double radius, height;  ///< of the interior [m]
};
Glass balls_in_glass(int count,
                     const Settings& settings = {.substeps = 20, .iterations = 2, .mode = Mode::xpbd});

/// Fraction of the bodies' volume that also lies inside another body, by sample points in every tet. All
/// `bodies` have the tets of `mesh`.
double shared_volume(const World& world, const std::vector<ObjectId>& bodies, const TetMesh& mesh);

// --- shots

enum class ShotAt { cloth, layer };

/// A ball of grains flies from above at a target that is pinned along its rim in the plane y = 0.
struct Shot {
  World world;
  ObjectId target, grains;
};
Shot shot_at(ShotAt what, int n, int grains, double speed);
/// Number of grains below the target.
std::size_t grains_that_passed(const Shot& shot);

// --- sand

/// H / R of a cone with the center of mass and spread of grains on y = 0: the tangent of the angle of repose.
double slope_of_heap(const World& world, ObjectId grains, double radius);

}  // namespace souple::test
