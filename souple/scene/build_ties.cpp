#include "souple/scene/build_ties.h"

#include "souple/objects/tie_options.h"
#include "souple/world/world.h"

namespace souple {
namespace {

/// The object or collider of a name; none: the world.
TieSide tie_side_of(const World& world, const std::string& name) {
  if (name.empty()) return {};
  for (const ColliderId id : world.colliders())
    if (world.collider_options(id).name == name) return id;
  return world.find_object(name);
}

TieOptions options_of(const TieDescription& tie) {
  TieOptions options{.name = tie.name, .point_b = tie.to_point, .rest_length = tie.rest_length};
  options.compliance = tie.compliance;
  if (tie.point) options.point = *tie.point;
  if (tie.breaking_force) options.breaking_force = *tie.breaking_force;
  if (tie.breaking_strain) options.breaking_strain = *tie.breaking_strain;
  if (tie.slide) options.slide = TieSlide{tie.slide->along, tie.slide->friction};
  return options;
}

}  // namespace

void add_tie(const TieDescription& tie, World& world) {
  if (tie.stitch)
    world.stitch(world.find_object(tie.from), tie.stitch->where, world.find_object(tie.to),
                 tie.stitch->distance, options_of(tie));
  else
    world.add_tie(tie_side_of(world, tie.from), tie_side_of(world, tie.to), options_of(tie));
}

}  // namespace souple
