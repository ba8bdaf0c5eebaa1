#include "souple/world/joints/ties.h"

#include "souple/collision/nearest.h"
#include "souple/geometry/closest_point.h"
#include "souple/objects/collider_record.h"
#include "souple/objects/object.h"
#include "souple/stages/rigid_stage.h"
#include "souple/stages/sleeping.h"
#include "souple/stages/ties.h"
#include "souple/world/add.h"
#include "souple/world/call_scope.h"
#include "souple/world/impl.h"
#include "souple/world/registry.h"
#include "souple/world/sleeping.h"
#include "souple/world/world.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include <fmt/core.h>

namespace souple {
namespace {

/// Points closer than this part of an object's size coincide.
constexpr double coincident = 1e-5;

std::size_t index_of(const WorldState& world, TieId id) {
  if (const std::optional<std::size_t> index = world.registry->ties.find(id.value)) return *index;
  throw_stale("tie", id.value);
}

BodyPose pose_of(const ColliderRecord& record, double t) {
  const Transform pose = record.options.motion.at(t);
  return {pose.translation, pose.rotation};
}

const ColliderRecord& collider_of(const WorldState& world, ColliderId id) {
  return world.colliders[*world.registry->colliders.find(id.value)];
}

// --- where a side is

Vec3d sum_of(const WorldState& world, const TieEnd& end) {
  const std::uint32_t begin = world.object(*end.object).begin;
  Vec3d sum;
  for (const TieEnd::Part& part : end.parts)
    sum += world.particles.exact_position(begin + part.particle) * part.weight;
  return sum;
}

Vec3d place_of(const WorldState& world, const TieEnd& end) {
  if (end.kind == TieEnd::Kind::particles) return sum_of(world, end);
  if (end.kind == TieEnd::Kind::body) return world.rigid->pose(end.object->value)->point(end.local);
  return end.collider ? pose_of(collider_of(world, *end.collider), world.time).point(end.local) : end.local;
}

/// b's side, where it has slid to.
Vec3d place_of_b(const WorldState& world, const Tie& tie, const TieState& state) {
  if (tie.chain.empty()) return place_of(world, tie.b);
  const std::uint32_t begin = world.object(*tie.b.object).begin;
  const Vec3d from = world.particles.exact_position(begin + tie.chain[state.segment]);
  return from + (world.particles.exact_position(begin + tie.chain[state.segment + 1]) - from) * state.along;
}

// --- a side of a new tie

/// Collects what a user asks for, and throws Error in the name of the tie.
class NewTie {
 public:
  NewTie(WorldState& world, const TieOptions& options) : world_(world), options_(options) {
    tie_.name = options.name.empty() ? "tie" : options.name;
    tie_.rest_length = options.rest_length.value_or(0);
    tie_.compliance = options.compliance;
    tie_.breaking_force = options.breaking_force, tie_.breaking_strain = options.breaking_strain;
    require_values();
  }

  using FindPoint = std::function<SurfacePoint(ObjectId, const Vec3d&)>;

  Tie make(const TieSide& a, const TieSide& b, const FindPoint& find) {
    const Vec3d point_b = options_.point_b.value_or(options_.point);
    tie_.a = end_of(a, options_.point, find), tie_.b = end_of(b, point_b, find);
    require_sides();
    if (options_.slide) slide(point_b);
    if (!options_.rest_length && !options_.slide) lie_as_they_are();
    require_breaking();
    return std::move(tie_);
  }
  const TieState& state() const { return state_; }

 private:
  template <class... Values>
  [[noreturn]] void fail(fmt::format_string<Values...> text, Values&&... values) const {
    throw Error(fmt::format("tie '{}': {}", tie_.name, fmt::format(text, std::forward<Values>(values)...)));
  }

  void require_values() const {
    const auto require = [this](double value, bool valid, const char* what, const char* expected) {
      if (!valid) fail("{} is {}, expected {}", what, value, expected);
    };
    const double l = options_.rest_length.value_or(0);
    require(l, l >= 0 && std::isfinite(l), "rest_length", "a finite length >= 0 [m]");
    const double alpha = options_.compliance;
    require(alpha, alpha >= 0 && std::isfinite(alpha), "compliance", "a finite number >= 0 [m/N]");
    require(options_.breaking_force, options_.breaking_force > 0, "breaking_force", "a force above 0 [N]");
    require(options_.breaking_strain, options_.breaking_strain > 0, "breaking_strain", "a strain above 0");
    if (!is_finite(options_.point) || !is_finite(options_.point_b.value_or(Vec3d{})))
      fail("its point is not finite");
    if (!options_.slide) return;
    const double friction = options_.slide->friction;
    require(friction, friction >= 0 && std::isfinite(friction), "friction", "a finite number >= 0");
  }

  TieEnd end_of(const TieSide& side, const Vec3d& point, const FindPoint& find) const {
    TieEnd end;
    if (side.collider()) {
      end.collider = *side.collider();
      end.local = pose_of(world_.collider(*side.collider()), world_.time).local_point(point);
    } else if (side.object()) {
      const Object& object = world_.object(*side.object());
      require_permanent_particles(object, "add_tie");
      end.object = object.id;
      take_point(object, side.point() ? *side.point() : find(object.id, point), end);
    } else {
      end.local = point;
    }
    return end;
  }

  void take_point(const Object& object, const SurfacePoint& point, TieEnd& end) const {
    end.kind = TieEnd::Kind::particles;
    end.loose = object.traits().shape == ObjectShape::balls;
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double weight = point.weights[k];
      if (!(weight >= 0 && weight <= 2))
        fail("weight {} of the point of {} is {}, expected 0 to 1", k, object.name, weight);
      if (weight > 0 && point.vertices[k] >= object.vertex_count())
        fail("{} has {} vertices, got vertex {}", object.name, object.vertex_count(), point.vertices[k]);
      sum += weight;
    }
    if (!(std::abs(sum - 1) < 1e-4))
      fail("the weights of the point of {} sum to {:g}, expected 1", object.name, sum);
    for (std::size_t k = 0; k < 3; ++k)
      if (point.weights[k] > 0) add_vertex(object, point.vertices[k], point.weights[k] / sum, end.parts);
    if (!object.traits().rigid) return;
    end.kind = TieEnd::Kind::body;
    end.local = world_.rigid->pose(object.id.value)->local_point(sum_of(world_, end));
    end.parts.clear();
  }

  static void add_vertex(const Object& object, std::uint32_t vertex, double weight,
                         std::vector<TieEnd::Part>& parts) {
    const auto add = [&parts](std::uint32_t particle, double w) {
      const auto same = std::find_if(parts.begin(), parts.end(),
                                     [particle](const TieEnd::Part& p) { return p.particle == particle; });
      same == parts.end() ? parts.push_back({particle, w}) : void(same->weight += w);
    };
    if (!object.embedding) return add(object.particle_of[vertex], weight);
    for (std::size_t k = 0; k < 4; ++k)
      add(object.embedding->vertices[vertex][k], weight * object.embedding->weights[vertex][k]);
  }

  bool can_move(const TieEnd& end) const { return end.object && !world_.object(*end.object).traits().driven; }

  void require_sides() const {
    if (!tie_.a.object && !tie_.b.object) fail("neither side is an object");
    if (!can_move(tie_.a) && !can_move(tie_.b)) fail("neither side can move");
    if (tie_.a.object != tie_.b.object) return;
    const auto same = [](const TieEnd::Part& p, const TieEnd::Part& q) {
      return p.particle == q.particle && p.weight == q.weight;
    };
    const auto &a = tie_.a.parts, &b = tie_.b.parts;
    if (tie_.a.kind == TieEnd::Kind::body || std::equal(a.begin(), a.end(), b.begin(), b.end(), same))
      fail("it ties {} to itself at one place; name two places", world_.object(*tie_.a.object).name);
  }

  /// Without a rest length, the tie holds its sides as they lie: a body, a collider or the world takes over the other
  /// side's point.
  void lie_as_they_are() {
    const Vec3d a = place_of(world_, tie_.a), b = place_of(world_, tie_.b);
    if (tie_.b.kind != TieEnd::Kind::particles) return hold(tie_.b, a);
    if (tie_.a.kind != TieEnd::Kind::particles) return hold(tie_.a, b);
    const double distance = length(a - b), size = std::min(size_of(tie_.a), size_of(tie_.b));
    tie_.rest_length = distance > coincident * size ? distance : 0;
  }

  void hold(TieEnd& end, const Vec3d& point) const {
    if (end.kind == TieEnd::Kind::body)
      end.local = world_.rigid->pose(end.object->value)->local_point(point);
    else if (end.collider)
      end.local = pose_of(world_.collider(*end.collider), world_.time).local_point(point);
    else
      end.local = point;
  }

  /// Size of the box around an object; a particle's diameter.
  double size_of(const TieEnd& end) const {
    const Object& object = world_.object(*end.object);
    Vec3d lo = world_.particles.exact_position(object.begin), hi = lo;
    for (std::uint32_t i = object.begin; i < object.end; ++i) {
      const Vec3d x = world_.particles.exact_position(i);
      lo = {std::min(lo.x, x.x), std::min(lo.y, x.y), std::min(lo.z, x.z)};
      hi = {std::max(hi.x, x.x), std::max(hi.y, x.y), std::max(hi.z, x.z)};
    }
    return length(hi - lo) + 2 * static_cast<double>(particle_radius(object.material));
  }

  void slide(const Vec3d& point) {
    if (!tie_.b.object || tie_.b.kind != TieEnd::Kind::particles)
      fail("it can slide along vertices of cloth, a soft body or a rope; its second side is none of them");
    const Object& object = world_.object(*tie_.b.object);
    if (object.embedding)
      fail("{} is embedded in a lattice, whose vertices nothing slides along", object.name);
    std::vector<std::uint32_t> along = options_.slide->along;
    if (along.empty() && object.traits().shape != ObjectShape::line)
      fail("it slides along {}, which is no rope: name the vertices of `along`", object.name);
    for (std::uint32_t v = 0; options_.slide->along.empty() && v < object.vertex_count(); ++v)
      along.push_back(v);
    if (along.size() < 2) fail("it slides along {} vertices, expected 2 or more", along.size());
    for (const std::uint32_t v : along) {
      if (v >= object.vertex_count())
        fail("{} has {} vertices, got vertex {}", object.name, object.vertex_count(), v);
      const std::uint32_t particle = object.particle_of[v];
      if (!tie_.chain.empty() && tie_.chain.back() == particle)
        fail("vertices of `along` follow each other at one place: vertex {}", v);
      tie_.chain.push_back(particle);
    }
    tie_.friction = options_.slide->friction;
    tie_.b.parts.clear();
    find_place(object, point);
  }

  void find_place(const Object& object, const Vec3d& point) {
    double least = std::numeric_limits<double>::infinity();
    for (std::uint32_t k = 0; k + 1 < tie_.chain.size(); ++k) {
      const Vec3d from = world_.particles.exact_position(object.begin + tie_.chain[k]);
      const Vec3d to = world_.particles.exact_position(object.begin + tie_.chain[k + 1]);
      const double t = nearest_on_edge(point, from, to);
      const double distance = length_squared(from + (to - from) * t - point);
      if (distance < least) least = distance, state_.segment = k, state_.along = t;
    }
  }

  void require_breaking() const {
    if (std::isfinite(tie_.breaking_strain) && !(tie_.rest_length > 0))
      fail("it has no rest length, so it has no strain; give a rest_length, or a breaking_force");
  }

  WorldState& world_;
  const TieOptions& options_;
  Tie tie_;
  TieState state_;
};

void wake_ends(WorldState& world, const Tie& tie) {
  for (const TieEnd* const end : {&tie.a, &tie.b})
    if (end->object) wake_island(world, world.object(*end->object));
}

TieId add(WorldState& world, Tie tie, const TieState& state) {
  Ties& ties = *world.constraints.ties;
  tie.id = {world.registry->next_id};
  const TieId id = tie.id;
  wake_ends(world, tie);
  world.registry->ties.add(id.value);
  try {
    ties.add(std::move(tie), state);
  } catch (...) {
    world.registry->ties.remove_last(id.value);
    throw;
  }
  ++world.registry->next_id;
  world.dirty.solver = world.dirty.tables = true;  // contacts exclude what is tied
  return id;
}

void remove_ties(WorldState& world, std::span<const IndexRange> ranges) {
  Ties& ties = *world.constraints.ties;
  if (ranges.empty()) return;
  for (const IndexRange& range : ranges)
    for (std::size_t k = range.begin; k < range.end; ++k) wake_ends(world, ties.tie(k));
  ties.remove(ranges);
  world.registry->ties.reset(ties.count(), [&](std::size_t k) { return ties.tie(k).id.value; });
  world.dirty.solver = world.dirty.masses = world.dirty.tables = true;
}

// --- the closest point

struct Closest {
  double least = std::numeric_limits<double>::infinity();
  SurfacePoint point;

  void take(const Vec3d& p, std::span<const Vec3f> x, const std::array<std::uint32_t, 3>& vertices,
            const std::array<double, 3>& weights) {
    Vec3d at;
    for (std::size_t k = 0; k < 3; ++k) at += Vec3d(x[vertices[k]]) * weights[k];
    const double distance = length_squared(at - p);
    if (distance < least) least = distance, point.vertices = vertices, point.weights = weights;
  }
};

}  // namespace

SurfacePoint World::surface_point(ObjectId id, const Vec3d& p) const {
  const Object& object = state().object(id);
  require_permanent_particles(object, "surface_point");
  if (!is_finite(p)) throw Error("surface_point: the point is not finite");
  const std::span<const Vec3f> x = positions(id);
  Closest closest;
  for (const Triangle& t : triangles(id)) {
    const TrianglePoint at = closest_on_triangle(p, Vec3d(x[t[0]]), Vec3d(x[t[1]]), Vec3d(x[t[2]]));
    closest.take(p, x, {t[0], t[1], t[2]}, {at.a, at.b, at.c});
  }
  const bool is_line = object.traits().shape == ObjectShape::line;
  for (std::uint32_t v = 0; is_line && v + 1 < x.size(); ++v) {
    const double t = nearest_on_edge(p, Vec3d(x[v]), Vec3d(x[v + 1]));
    closest.take(p, x, {v, v + 1, v}, {1 - t, t, 0});
  }
  for (std::uint32_t v = 0; !std::isfinite(closest.least) && v < x.size(); ++v)
    closest.take(p, x, {v, v, v}, {1, 0, 0});
  if (triangles(id).empty() && !is_line)
    for (std::uint32_t v = 0; v < x.size(); ++v) closest.take(p, x, {v, v, v}, {1, 0, 0});
  closest.point.object = id;
  return closest.point;
}

TieId World::add_tie(const TieSide& a, const TieSide& b, const TieOptions& options) {
  WorldState& world = state();
  const CallScope call(*world.calls, "add_tie");
  NewTie made(world, options);
  Tie tie = made.make(a, b, [this](ObjectId id, const Vec3d& p) { return surface_point(id, p); });
  return add(world, std::move(tie), made.state());
}

std::vector<TieId> World::stitch(ObjectId a, const Selector& selector, ObjectId b, double distance,
                                 const TieOptions& options) {
  WorldState& world = state();
  const CallScope call(*world.calls, "stitch");
  if (!(distance >= 0))
    throw Error(fmt::format("stitch: the distance is {} m, expected 0 or more", distance));
  if (a == b) throw Error("stitch: " + name(a) + " is stitched to itself; name two objects");
  std::vector<std::pair<Tie, TieState>> made;
  const std::span<const Vec3f> x = positions(a), y = positions(b);
  for (const std::uint32_t vertex : select(a, selector)) {
    TieOptions of_vertex = options;
    of_vertex.point = Vec3d(x[vertex]), of_vertex.point_b.reset();
    const SurfacePoint at = surface_point(b, of_vertex.point);
    Vec3d closest;
    for (std::size_t k = 0; k < 3; ++k) closest += Vec3d(y[at.vertices[k]]) * at.weights[k];
    if (length(closest - of_vertex.point) > distance) continue;
    NewTie one(world, of_vertex);
    Tie tie = one.make(SurfacePoint{a, {vertex, vertex, vertex}, {1, 0, 0}}, at, {});
    made.emplace_back(std::move(tie), one.state());
  }
  if (made.empty())
    throw Error(fmt::format("stitch: no selected vertex of {} is within {:g} m of {}; raise the distance",
                            name(a), distance, name(b)));
  std::vector<TieId> ids;
  ids.reserve(made.size());
  for (auto& [tie, state] : made) ids.push_back(add(world, std::move(tie), state));
  return ids;
}

void World::remove(TieId id) {
  WorldState& world = state();
  const CallScope call(*world.calls, "remove(TieId)");
  const std::size_t index = index_of(world, id);
  remove_ties(world, std::array{IndexRange{index, index + 1}});
}

TieReport World::tie_report(TieId id) const {
  const WorldState& world = state();
  const QueryScope query(*world.calls, "tie_report");
  const Ties& ties = *world.constraints.ties;
  const std::size_t index = index_of(world, id);
  const Tie& tie = ties.tie(index);
  const TieState& now = ties.state(index);
  return {tie.name,  place_of(world, tie.a), place_of_b(world, tie, now),
          now.force, tie.rest_length,        now.segment,
          now.along, now.broken != 0};
}

std::vector<TieId> World::ties() const {
  const Ties& ties = *state().constraints.ties;
  std::vector<TieId> ids;
  for (std::size_t k = 0; k < ties.count(); ++k) ids.push_back(ties.tie(k).id);
  return ids;
}

// --- in a step

void list_ties(WorldState& world) {
  Ties& ties = *world.constraints.ties;
  if (ties.empty()) return;
  const auto number = [&world](const TieEnd& end) -> TieNumber {
    const Object& object = world.object(*end.object);
    if (end.kind == TieEnd::Kind::particles) {
      double w = 0;
      for (const TieEnd::Part& part : end.parts)
        w += part.weight * part.weight *
             static_cast<double>(inverse_mass_awake(world.particles, object, part.particle));
      return {object.begin, w, {}};
    }
    const TieNumber driven{world.rigid->index(object.id.value), 0, {}};
    if (world.rigid->is_kinematic(object.id.value)) return driven;
    const RigidDefinition& body = *world.rigid->definition(object.id.value);
    const Vec3d& I = body.inertia;
    return {driven.index, 1 / body.mass, {1 / I.x, 1 / I.y, 1 / I.z}};
  };
  if (ties.list(number)) world.dirty.masses = true;
}

void drive_ties(WorldState& world, double t) {
  Ties& ties = *world.constraints.ties;
  for (std::size_t k = 0; k < ties.count(); ++k)
    for (const bool of_b : {false, true}) {
      const TieEnd& end = of_b ? ties.tie(k).b : ties.tie(k).a;
      if (!end.collider) continue;
      world.warnings.guarded("a collider's motion", [&] {
        ties.set_target(k, of_b, pose_of(collider_of(world, *end.collider), t).point(end.local));
      });
    }
}

void list_tied(const WorldState& world, JoinedObjects& joined) {
  const Ties& ties = *world.constraints.ties;
  const auto moves = [&world](const TieEnd& end) {
    if (end.collider) return !collider_of(world, *end.collider).options.motion.is_static();
    return end.object && world.object(*end.object).is_driven();
  };
  const auto row_of = [&world](const TieEnd& end) {
    return static_cast<std::uint32_t>(*world.registry->objects.find(end.object->value));
  };
  for (std::size_t k = 0; k < ties.count(); ++k) {
    if (ties.state(k).broken != 0) continue;
    const TieEnd &a = ties.tie(k).a, &b = ties.tie(k).b;
    if (a.object && b.object && !moves(a) && !moves(b))
      joined.pairs.emplace_back(row_of(a), row_of(b));
    else if (moves(a) && b.object)
      joined.driven.push_back(row_of(b));
    else if (moves(b) && a.object)
      joined.driven.push_back(row_of(a));
  }
}

void remove_ties_if(WorldState& world, const std::function<bool(const TieEnd&)>& holds) {
  const Ties& ties = *world.constraints.ties;
  remove_ties(world, ranges_where(ties.count(), [&](std::size_t k) {
                return holds(ties.tie(k).a) || holds(ties.tie(k).b);
              }));
}

void report_ties(WorldState& world) {
  const Ties& ties = *world.constraints.ties;
  world.report.broken_ties = ties.broken().size();
  const auto what = [&world](const TieEnd& end) -> std::string {
    if (end.object) return world.object(*end.object).name;
    return end.collider ? collider_of(world, *end.collider).options.name : "the world";
  };
  for (const std::uint32_t k : ties.broken()) {
    world.warnings.log_info(ties.tie(k).name,
                            {fmt::format("the tie of {} and {} broke at {:.4g} N", what(ties.tie(k).a),
                                         what(ties.tie(k).b), length(ties.state(k).force))});
    world.dirty.masses = world.dirty.tables = true;
  }
}

}  // namespace souple
