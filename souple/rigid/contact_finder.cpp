#include "souple/rigid/contact_finder.h"

#include "souple/rigid/impulse.h"
#include "souple/state/bytes.h"
#include "souple/state/saved_bytes.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace souple {
namespace {

// A pair is fast if its sides may move against each other in a step by this part of the smaller side's inner radius.
constexpr double fast_ratio = 0.25;
// A fast pair's contact is found again when its sides may have moved by more than this part of that radius.
constexpr double moved_ratio = 0.02;
// A fast pair without a contact is searched over a distance of this many substeps of motion. It is searched again once
// it has moved that far: without this rule, four of five searches in a heap of boxes found nothing.
constexpr double substeps_ahead = 5;
// Contacts begin at this distance even if nothing moves, as a part of the smaller side's inner radius.
constexpr double margin_ratio = 0.02;

/// An upper bound of the path of a body's points about its center in `dt` seconds [m].
double turn_of(const BodyVelocity& velocity, const RigidShape& shape, double dt) {
  const double speed = length(velocity.angular);
  return speed > 0 ? speed * dt * shape.radius() : 0;
}

/// An upper bound of the path of a body's points in `dt` seconds [m].
double motion_of(const RigidBodies& bodies, std::uint32_t body, const RigidShape& shape, double dt,
                 double gravity) {
  const BodyVelocity& v = bodies.velocity[body];
  const double fall = moves(bodies, body) ? gravity * dt * dt : 0;
  return length(v.linear) * dt + fall + turn_of(v, shape, dt);
}

Bounds box_of(const BodyPose& pose, const RigidShape& shape, double margin) {
  const auto infinity = std::numeric_limits<float>::infinity();
  const double r = shape.radius();
  if (!(r < static_cast<double>(infinity)))
    return {{-infinity, -infinity, -infinity}, {infinity, infinity, infinity}};
  Vec3d lo = pose.position, hi = pose.position;
  const Mat3d R = rotation_matrix(pose.rotation);
  const auto include = [&](const ShapeBounds& bounds) {
    const Vec3d middle = pose.point((bounds.lo + bounds.hi) * 0.5);
    const Vec3d half = (bounds.hi - bounds.lo) * 0.5;
    Vec3d extent;
    for (int row = 0; row < 3; ++row)
      extent[row] =
          std::abs(R(row, 0)) * half.x + std::abs(R(row, 1)) * half.y + std::abs(R(row, 2)) * half.z;
    for (int k = 0; k < 3; ++k)
      lo[k] = min(lo[k], middle[k] - extent[k]), hi[k] = max(hi[k], middle[k] + extent[k]);
  };
  if (shape.mesh) {
    // The mesh may be far from its frame's origin.
    lo = Vec3d(empty_bounds.lo), hi = Vec3d(empty_bounds.hi);
    include(shape.mesh->bounds());
  } else if (shape.parts.empty()) {
    lo -= Vec3d{r, r, r}, hi += Vec3d{r, r, r};
  }
  for (const ConvexShape& part : shape.parts) include(part.bounds);
  const Vec3d grown{margin, margin, margin};
  return {Vec3f(lo - grown), Vec3f(hi + grown)};
}

RigidContact contact_of(const Manifold& manifold, const BodyPose& pose_a, const BodyPose& pose_b) {
  RigidContact contact;
  contact.radius_a = manifold.radius_a, contact.radius_b = manifold.radius_b;
  contact.owner = manifold.owner;
  contact.normal_between_points =
      manifold.owner == NormalOwner::edges && manifold.radius_a + manifold.radius_b > 0;
  const Vec3d n_a = pose_a.local_direction(manifold.normal), n_b = pose_b.local_direction(manifold.normal);
  contact.normal = manifold.owner == NormalOwner::face_of_b ? n_b : n_a;
  contact.count = static_cast<std::uint8_t>(manifold.count);
  for (int k = 0; k < manifold.count; ++k) {
    const ManifoldPoint& found = manifold.points[static_cast<std::size_t>(k)];
    RigidContactPoint& point = contact.points[static_cast<std::size_t>(k)];
    point.core_a = found.on_a + n_a * contact.radius_a, point.core_b = found.on_b - n_b * contact.radius_b;
    point.feature = found.feature;
  }
  return contact;
}

bool is_within(double margin, const Manifold& manifold) {
  const auto end = manifold.points.begin() + manifold.count;
  return std::any_of(manifold.points.begin(), end,
                     [&](const ManifoldPoint& point) { return point.separation <= margin; });
}

/// A part has one manifold with another part or a plane, and up to this number with other shapes.
constexpr std::size_t manifolds_with_field = 4, manifolds_with_mesh = 8;

std::size_t manifolds_with(const RigidShape& shape) {
  if (shape.mesh) return manifolds_with_mesh;
  return shape.collider && !std::holds_alternative<Plane>(*shape.collider) ? manifolds_with_field : 1;
}

/// The contact whose normal is nearest to that of a manifold, or null. With a mesh, manifolds come in any order.
const RigidContact* likest(std::span<const RigidContact> contacts, const Vec3d& normal,
                           const BodyPose& pose_a, const BodyPose& pose_b) {
  const RigidContact* best = nullptr;
  double most = 0;
  for (const RigidContact& contact : contacts) {
    const BodyPose& owner = contact.owner == NormalOwner::face_of_b ? pose_b : pose_a;
    const double product = contact.count > 0 ? dot(owner.direction(contact.normal), normal) : 0;
    if (product > most) most = product, best = &contact;
  }
  return best;
}

/// Points of one feature are the same contact.
void keep_impulses(RigidContact& contact, const RigidContact& last) {
  for (std::uint32_t k = 0; k < contact.count; ++k)
    for (std::uint32_t l = 0; l < last.count; ++l) {
      RigidContactPoint& point = contact.points[k];
      const RigidContactPoint& before = last.points[l];
      if (point.feature != before.feature) continue;
      point.anchor_a = before.anchor_a, point.anchor_b = before.anchor_b;
      point.anchored = before.anchored, point.slid = before.slid;
      point.normal_impulse = before.normal_impulse, point.tangent_impulse = before.tangent_impulse;
      break;
    }
}

}  // namespace

void ContactFinder::append_pairs(std::uint32_t a, std::uint32_t b, std::span<const RigidShape> shapes) {
  if (shapes[a].parts.empty()) std::swap(a, b);
  if (shapes[a].parts.empty()) return;
  Pair pair;
  pair.a = a, pair.b = b;
  pair.fast = motion_[a] + motion_[b] > fast_ratio * min(inner_[a], inner_[b]);
  const std::size_t parts_b = shapes[b].parts.size(), manifolds = manifolds_with(shapes[b]);
  for (pair.part_a = 0; pair.part_a < shapes[a].parts.size(); ++pair.part_a)
    for (pair.part_b = 0; pair.part_b < max(parts_b, std::size_t{1}); ++pair.part_b)
      for (pair.manifold = 0; pair.manifold < manifolds; ++pair.manifold) pairs_.push_back(pair);
}

void ContactFinder::find_pairs(const RigidBodies& bodies, std::span<const RigidShape> shapes,
                               const RigidMaterials& materials, double dt, double gravity) {
  motion_.resize(bodies.size()), boxes_.resize(bodies.size()), inner_.resize(bodies.size());
  turn_.resize(bodies.size());
  for (std::uint32_t i = 0; i < bodies.size(); ++i) {
    motion_[i] = motion_of(bodies, i, shapes[i], dt, gravity);
    inner_[i] = shapes[i].inner_radius(), turn_[i] = turn_of(bodies.velocity[i], shapes[i], dt);
    const double rest = shapes[i].parts.empty() ? 0 : margin_ratio * inner_[i];
    boxes_[i] = box_of(bodies.pose[i], shapes[i], motion_[i] + rest);
  }
  std::swap(pairs_, last_pairs_);
  pairs_.clear();
  for (const auto& [a, b] : sweep_.find(boxes_))
    if ((moves(bodies, a) || moves(bodies, b)) && materials.collide(a, b)) append_pairs(a, b, shapes);
  std::sort(pairs_.begin(), pairs_.end(), [](const Pair& x, const Pair& y) { return x.key() < y.key(); });
}

void ContactFinder::take_over(std::size_t p) {
  Pair& pair = pairs_[p];
  const auto last = std::lower_bound(last_pairs_.begin(), last_pairs_.end(), pair,
                                     [](const Pair& x, const Pair& y) { return x.key() < y.key(); });
  if (last == last_pairs_.end() || last->key() != pair.key()) return;
  pair.axis = last->axis;
  contacts_[p] = last_contacts_[static_cast<std::size_t>(last - last_pairs_.begin())];
}

void ContactFinder::find_contact(std::size_t p, const RigidBodies& bodies, std::span<const RigidShape> shapes,
                                 double margin, double reach) {
  Pair& pair = pairs_[p];
  if (pair.manifold > 0) return;  // the first one finds all
  pair.moved = pair.clear = 0;
  const ConvexShape& a = shapes[pair.a].parts[pair.part_a];
  const BodyPose &pose_a = bodies.pose[pair.a], &pose_b = bodies.pose[pair.b];
  const PairMotion ahead = motion_ahead(pair, bodies);
  const auto set_after = [&](std::size_t at, const Manifold& manifold, const RigidContact* last) {
    if (!is_within(margin, manifold)) {
      contacts_[at].count = 0;
      return;
    }
    RigidContact contact = contact_of(manifold, pose_a, pose_b);
    contact.a = pair.a, contact.b = pair.b, contact.material = contacts_[at].material;
    if (last != nullptr) keep_impulses(contact, *last);
    contacts_[at] = contact;
  };
  const auto set = [&](std::size_t at, const Manifold& manifold) { set_after(at, manifold, &contacts_[at]); };
  if (const Shape* const collider = shapes[pair.b].collider) {
    if (const Plane* const plane = std::get_if<Plane>(collider)) {
      const Manifold found = find_manifold(a, pose_a, *plane, pose_b, reach, pair.axis.points);
      if (found.count == 0) pair.clear = reach;
      set(p, found);
    } else {
      std::array<Manifold, manifolds_with_field> found{};
      const int count = find_manifolds(a, pose_a, *collider, pose_b, margin, found);
      for (std::size_t m = 0; m < found.size(); ++m)
        set(p + m, m < static_cast<std::size_t>(count) ? found[m] : Manifold{});
    }
  } else if (shapes[pair.b].mesh) {
    std::array<Manifold, manifolds_with_mesh> found{};
    std::array<RigidContact, manifolds_with_mesh> last;
    std::copy_n(contacts_.begin() + static_cast<std::ptrdiff_t>(p), last.size(), last.begin());
    const int count = find_manifolds(a, pose_a, *shapes[pair.b].mesh, pose_b, margin, found, ahead);
    for (std::size_t m = 0; m < found.size(); ++m)
      set_after(p + m, m < static_cast<std::size_t>(count) ? found[m] : Manifold{},
                likest(last, found[m].normal, pose_a, pose_b));
  } else {
    const ConvexShape& b = shapes[pair.b].parts[pair.part_b];
    const Manifold found = find_manifold(a, pose_a, b, pose_b, reach, pair.axis, ahead);
    if (found.count == 0 && !found.passes) pair.clear = reach;
    set(p, found);
  }
}

void ContactFinder::begin_step(const RigidBodies& bodies, std::span<const RigidShape> shapes,
                               const RigidMaterials& materials, double dt, double part, double gravity,
                               Threads& threads) {
  dt_ = dt, part_ = part;
  find_pairs(bodies, shapes, materials, dt, gravity);
  std::swap(contacts_, last_contacts_);
  contacts_.assign(pairs_.size(), {});
  threads.each(pairs_.size(), 8, [&](std::size_t p) { take_over(p); });
  threads.each(pairs_.size(), 8, [&](std::size_t p) {
    const Pair& pair = pairs_[p];
    contacts_[p].a = pair.a, contacts_[p].b = pair.b;
    contacts_[p].material = materials.at(pair.a, pair.b);
  });
  threads.each(pairs_.size(), 8, [&](std::size_t p) {
    const Pair& pair = pairs_[p];
    if (pair.fast) {
      search(p, bodies, shapes);
    } else {
      const double margin =
          motion_[pair.a] + motion_[pair.b] + margin_ratio * min(inner_[pair.a], inner_[pair.b]);
      find_contact(p, bodies, shapes, margin, margin);
    }
  });
}

double ContactFinder::relative_motion(const Pair& pair, const RigidBodies& bodies) const {
  const Vec3d u = bodies.velocity[pair.a].linear - bodies.velocity[pair.b].linear;
  return length(u) * dt_ + turn_[pair.a] + turn_[pair.b];
}

// Until the pair is searched again: in the next step, or if it is fast in the substep after this one.
PairMotion ContactFinder::motion_ahead(const Pair& pair, const RigidBodies& bodies) const {
  const double time = pair.fast ? min(2 * part_, 1.0) * dt_ : dt_;
  const BodyVelocity &a = bodies.velocity[pair.a], &b = bodies.velocity[pair.b];
  return {(a.linear - b.at(bodies.pose[pair.a].position - bodies.pose[pair.b].position)) * time,
          (a.angular - b.angular) * time};
}

// Distance within which a contact may push in a substep [m].
double ContactFinder::margin_of(const Pair& pair) const {
  return (motion_[pair.a] + motion_[pair.b]) * 2 * part_ + margin_ratio * min(inner_[pair.a], inner_[pair.b]);
}

void ContactFinder::search(std::size_t p, const RigidBodies& bodies, std::span<const RigidShape> shapes) {
  const Pair& pair = pairs_[p];
  const double margin = margin_of(pair);
  const double ahead = contacts_[p].count > 0 ? 0 : relative_motion(pair, bodies) * part_ * substeps_ahead;
  find_contact(p, bodies, shapes, margin, margin + ahead);
}

void ContactFinder::refresh(const RigidBodies& bodies, std::span<const RigidShape> shapes, Threads& threads) {
  for (std::size_t i = 0; i < bodies.size(); ++i) turn_[i] = turn_of(bodies.velocity[i], shapes[i], dt_);
  threads.for_each(pairs_.size(), 32, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      Pair& pair = pairs_[p];
      if (!pair.fast) continue;
      // The velocities are those at the end of the substep that has passed.
      pair.moved += relative_motion(pair, bodies) * part_;
      if (pair.moved < moved_ratio * min(inner_[pair.a], inner_[pair.b])) continue;
      if (contacts_[p].count > 0 || pair.clear - pair.moved < margin_of(pair)) search(p, bodies, shapes);
    }
  });
}

// Field by field: the bytes between fields are arbitrary.
template <class AnyPair, class AnyContact, class Function>
void ContactFinder::for_each_field(AnyPair& pair, AnyContact& contact, const Function& f) {
  f(pair.a), f(pair.part_a), f(pair.b), f(pair.part_b), f(pair.manifold);
  f(pair.axis.kind), f(pair.axis.a), f(pair.axis.b), f(pair.axis.axis);
  f(pair.axis.points.count), f(pair.axis.points.features), f(pair.axis.points.area);
  f(contact.radius_a), f(contact.radius_b), f(contact.normal), f(contact.owner),
      f(contact.normal_between_points);
  f(contact.count);
  for (auto& point : contact.points) {
    f(point.core_a), f(point.core_b), f(point.anchor_a), f(point.anchor_b), f(point.feature);
    f(point.anchored), f(point.slid), f(point.normal_impulse), f(point.tangent_impulse);
  }
}

void ContactFinder::save(SavedBytesWriter& out) const {
  out.put(std::uint64_t{pairs_.size()});
  for (std::size_t p = 0; p < pairs_.size(); ++p)
    for_each_field(pairs_[p], contacts_[p], [&out](const auto& value) { out.put(value); });
}

ContactFinder::Saved ContactFinder::read(SavedBytes& in, std::size_t bodies) {
  std::uint64_t count = 0;
  in.get(count);
  Saved saved;
  for (std::size_t p = 0; p < count; ++p) {
    Pair& pair = saved.pairs.emplace_back();
    RigidContact& contact = saved.contacts.emplace_back();
    for_each_field(pair, contact, [&in](auto& value) { in.get(value); });
    bool finite = true;
    for_each_field(pair, contact, [&finite](const auto& value) { finite = finite && all_finite(value); });
    const int kept = pair.axis.points.count;
    in.require(finite && pair.a < bodies && pair.axis.kind <= AxisCache::Kind::closest_points &&
               (kept == 0 || kept == 4) && contact.owner <= NormalOwner::edges &&
               contact.count <= contact.points.size() && (p == 0 || saved.pairs[p - 1].key() < pair.key()));
  }
  return saved;
}

void ContactFinder::set(Saved saved) {
  pairs_ = std::move(saved.pairs), contacts_ = std::move(saved.contacts);
}

void ContactFinder::clear() {
  pairs_.clear(), last_pairs_.clear();
  contacts_.clear(), last_contacts_.clear();
}

std::size_t ContactFinder::bytes() const {
  return sweep_.bytes() +
         bytes_of(boxes_, motion_, inner_, turn_, pairs_, last_pairs_, contacts_, last_contacts_);
}

}  // namespace souple
