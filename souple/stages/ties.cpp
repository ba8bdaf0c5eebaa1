#include "souple/stages/ties.h"

#include "souple/rigid/impulse.h"
#include "souple/state/bytes.h"
#include "souple/state/saved_bytes.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace souple {
namespace {

/// Largest carried mass, relative to the particle's own: practically rigid, without a division by zero.
constexpr double heaviest = 1e6;

void move(const ParticleView& particles, std::size_t i, const Vec3d& change) {
  particles.moving[i].set_xyz(Vec3f(Vec3d(particles.moving[i].xyz()) + change));
}

bool is_heavy(const TieEnd& end) {
  return end.kind != TieEnd::Kind::particles || end.loose;
}

bool has_body(const Tie& tie) {
  return tie.a.kind == TieEnd::Kind::body || tie.b.kind == TieEnd::Kind::body;
}

/// Largest eigenvalue, at most 12 % too large, of
///
///   B = m / K sum_k M^-1/2 [1 [r_k]^T; [r_k] [r_k][r_k]^T] M^-1/2,   M = diag(m, m, m, I)
///
/// for K points r_k of a body, in its frame. Masses m / K at these points have at most this many times the kinetic
/// energy of the body, in any motion. The estimate is trace(B^16)^(1/16).
class Crowding {
 public:
  Crowding(double inverse_mass, const Vec3d& inverse_inertia)
      : gyration_{std::sqrt(inverse_inertia.x / inverse_mass), std::sqrt(inverse_inertia.y / inverse_mass),
                  std::sqrt(inverse_inertia.z / inverse_mass)} {}
  void add(const Vec3d& r) {
    ++count_;
    const double cross[3][3] = {{0, -r.z, r.y}, {r.z, 0, -r.x}, {-r.y, r.x, 0}};
    double J[6][3] = {};  // how the velocity along each axis follows from the body's, both scaled
    for (std::size_t i = 0; i < 3; ++i) {
      J[i][i] = 1;
      for (std::size_t j = 0; j < 3; ++j) J[3 + i][j] = cross[i][j] * gyration_[i];
    }
    for (std::size_t i = 0; i < 6; ++i)
      for (std::size_t j = 0; j < 6; ++j)
        for (std::size_t axis = 0; axis < 3; ++axis) product_[i][j] += J[i][axis] * J[j][axis];
  }
  double value() {
    double trace = 0;
    for (std::size_t i = 0; i < 6; ++i) trace += product_[i][i];
    for (auto& row : product_)
      for (double& x : row) x /= trace;
    for (int squaring = 0; squaring < 4; ++squaring) square();
    double sum = 0;
    for (std::size_t i = 0; i < 6; ++i) sum += product_[i][i];
    for (int root = 0; root < 4; ++root) sum = std::sqrt(sum);
    return sum * trace / static_cast<double>(count_);
  }

 private:
  using Matrix = std::array<std::array<double, 6>, 6>;
  void square() {
    Matrix result{};
    for (std::size_t i = 0; i < 6; ++i)
      for (std::size_t j = 0; j < 6; ++j)
        for (std::size_t k = 0; k < 6; ++k) result[i][j] += product_[i][k] * product_[k][j];
    product_ = result;
  }

  std::array<double, 3> gyration_;  // sqrt(m / I) [1/m]
  Matrix product_{};                // K B / m
  std::size_t count_ = 0;
};

/// Moves the point of a chain that is closest to p from a segment on to its neighbors. x(k): of its vertices.
template <class Position>
void follow_chain(std::uint32_t segments, const Position& x, const Vec3d& p, std::uint32_t& segment,
                  double& along) {
  for (std::uint32_t step = 0; step <= segments; ++step) {
    const Vec3d from = x(segment), d = x(segment + 1) - from;
    const double square = length_squared(d);
    const double t = square > 0 ? dot(p - from, d) / square : 0;
    along = std::clamp(t, 0.0, 1.0);
    // On to a neighbor, unless the corner itself is closest.
    if (t > 1 && segment + 1 < segments && dot(p - x(segment + 1), x(segment + 2) - x(segment + 1)) > 0) {
      ++segment;
    } else if (t < 0 && segment > 0 && dot(p - from, x(segment - 1) - from) > 0) {
      --segment;
    } else {
      return;
    }
  }
}

}  // namespace

/// A side of a tie while it is projected.
struct Ties::Point {
  const TieEnd* end = nullptr;
  TieNumber number;
  Vec3d target{};
  std::span<const std::uint32_t> chain{};  ///< of a side on which the tie slides
  std::uint32_t segment = 0;
  double along = 0;
};

/// Reads and moves both sides of a tie.
class Ties::Sides {
 public:
  /// Without bodies, ties of bodies cannot be read.
  Sides(const ParticleView& particles, RigidBodies* bodies) : particles_(particles), bodies_(bodies) {}

  static Point a_of(const Record& r) { return {&r.tie.a, r.a, r.target_a, {}, 0, 0}; }
  static Point b_of(const Record& r) {
    return {&r.tie.b, r.b, r.target_b, r.tie.chain, r.state.segment, r.state.along};
  }
  /// Calls f(particle, weight).
  template <class Function>
  static void for_each_part(const Point& point, const Function& f) {
    if (!point.chain.empty()) {
      f(point.number.index + point.chain[point.segment], 1 - point.along);
      f(point.number.index + point.chain[point.segment + 1], point.along);
    } else {
      for (const TieEnd::Part& part : point.end->parts) f(point.number.index + part.particle, part.weight);
    }
  }
  Vec3d at(const Point& point) const {
    if (point.end->kind == TieEnd::Kind::target) return point.target;
    if (is_body(point)) return bodies_->pose[point.number.index].point(point.end->local);
    Vec3d sum;
    for_each_part(point,
                  [&](std::uint32_t i, double weight) { sum += particles_.exact_position(i) * weight; });
    return sum;
  }
  Vec3d of_chain(const Point& point, std::uint32_t k) const {
    return particles_.exact_position(point.number.index + point.chain[k]);
  }
  /// W of the point [1/kg].
  Mat3d inverse_mass(const Point& point) const {
    if (point.end->kind == TieEnd::Kind::target) return {};
    if (is_body(point)) return inverse_mass_at(*bodies_, point.number.index, arm(point));
    double sum = 0;
    for_each_part(point, [&](std::uint32_t i, double weight) {
      sum += weight * weight * static_cast<double>(particles_.inverse_mass(i));
    });
    return Mat3d::diagonal({sum, sum, sum});
  }
  void push(const Point& point, const Vec3d& impulse) const {
    if (point.end->kind == TieEnd::Kind::target) return;
    if (is_body(point)) return souple::push(*bodies_, point.number.index, arm(point), impulse);
    for_each_part(point, [&](std::uint32_t i, double weight) {
      const auto w = static_cast<double>(particles_.inverse_mass(i));
      if (w > 0) move(particles_, i, impulse * (w * weight));
    });
  }

 private:
  static bool is_body(const Point& point) { return point.end->kind == TieEnd::Kind::body; }
  Vec3d arm(const Point& point) const {
    return bodies_->pose[point.number.index].direction(point.end->local);
  }

  const ParticleView& particles_;
  RigidBodies* bodies_;
};

// --- the list

void Ties::add(Tie tie, const TieState& state) {
  Record record;
  record.tie = std::move(tie);
  record.state = record.kept = state;
  record.target_a = record.tie.a.local, record.target_b = record.tie.b.local;
  records_.push_back(std::move(record));
}

void Ties::remove(std::span<const IndexRange> ties) {
  erase_ranges(records_, ties);
  loads_.clear(), between_particles_.clear(), broken_.clear();
}

std::size_t Ties::size() const {
  return static_cast<std::size_t>(
      std::count_if(records_.begin(), records_.end(), [](const Record& r) { return r.state.broken == 0; }));
}

/// w: inverse mass of the heavy side for this tie [1/kg].
void Ties::find_loads_of(std::uint32_t k, double w) {
  const Record& record = records_[k];
  const bool by_a = record.carrier == Carrier::a;
  const TieEnd& light = by_a ? record.tie.a : record.tie.b;
  const std::uint32_t first = (by_a ? record.a : record.b).index;
  const double sum = w + softness(record);
  double positive = 0;
  for (const TieEnd::Part& part : light.parts) positive += max(part.weight, 0.0);
  for (const TieEnd::Part& part : light.parts)
    if (part.weight > 0)
      fresh_loads_.push_back(
          {first + part.particle, k,
           sum > 0 ? part.weight / (positive * sum) : std::numeric_limits<double>::infinity()});
}

// Inverse mass that each of K ties shows: K s / m for a body, K / m for a loose particle.
double Ties::inverse_mass_of(const HeavyKey* first, const HeavyKey* last) const {
  const TieNumber& number = heavy_side(records_[first->record]).second;
  const double w = number.inverse_mass * static_cast<double>(last - first);
  if (!(w > 0) || heavy_side(records_[first->record]).first.kind != TieEnd::Kind::body) return w;
  Crowding crowding(number.inverse_mass, number.inverse_inertia);
  for (const HeavyKey* key = first; key != last; ++key)
    crowding.add(heavy_side(records_[key->record]).first.local);
  return w * crowding.value();
}

double Ties::softness(const Record& record) const {
  return record.tie.compliance > 0 ? record.tie.compliance / (h_ * h_) : 0;
}

std::pair<const TieEnd&, const TieNumber&> Ties::heavy_side(const Record& record) {
  if (record.carrier == Carrier::a) return {record.tie.b, record.b};
  return {record.tie.a, record.a};
}

// Particles of an object carry bodies and loose particles, and much heavier particles of another object.
Ties::Carrier Ties::carrier_of(const Record& record) {
  constexpr double much = 30;
  const Tie& tie = record.tie;
  if (record.state.broken != 0 || tie.rest_length > 0 || !tie.chain.empty()) return Carrier::none;
  if (is_heavy(tie.a) && is_heavy(tie.b)) return Carrier::none;
  if (is_heavy(tie.a)) return Carrier::b;
  if (is_heavy(tie.b) || record.a.inverse_mass > much * record.b.inverse_mass) return Carrier::a;
  return record.b.inverse_mass > much * record.a.inverse_mass ? Carrier::b : Carrier::none;
}

// The largest number of ties that share a particle of the heavy side.
std::size_t Ties::sharing_of(const Record& record) const {
  const auto& [end, number] = heavy_side(record);
  std::ptrdiff_t most = 1;
  for (const TieEnd::Part& part : end.parts) {
    const auto [first, last] = std::equal_range(shared_.begin(), shared_.end(), number.index + part.particle);
    most = std::max(most, last - first);
  }
  return static_cast<std::size_t>(most);
}

void Ties::find_turns() {
  held_.clear();
  for (const Record& record : records_)
    for (const TieEnd* const end : {&record.tie.a, &record.tie.b})
      if (has_body(record.tie) && end->object) held_.push_back(end->object->value);
  std::sort(held_.begin(), held_.end());
  const auto is_held = [&](const TieEnd& end) {
    return end.object && std::binary_search(held_.begin(), held_.end(), end.object->value);
  };
  for (Record& record : records_) record.in_turns = is_held(record.tie.a) || is_held(record.tie.b);
}

bool Ties::find_loads() {
  find_turns();
  holds_bodies_ = false;
  keys_.clear(), fresh_loads_.clear(), between_particles_.clear(), shared_.clear();
  for (std::uint32_t k = 0; k < records_.size(); ++k) {
    Record& record = records_[k];
    record.carrier = carrier_of(record);
    if (record.state.broken != 0) continue;
    holds_bodies_ = holds_bodies_ || has_body(record.tie);
    if (record.carrier == Carrier::none) {
      if (!has_body(record.tie)) between_particles_.push_back(k);
      continue;
    }
    const auto& [heavy, number] = heavy_side(record);
    if (is_heavy(heavy)) {
      keys_.push_back(
          {heavy.object ? heavy.object->value : 0, heavy.loose ? heavy.parts.front().particle : 0, k});
    } else {
      for (const TieEnd::Part& part : heavy.parts) shared_.push_back(number.index + part.particle);
    }
  }
  std::sort(shared_.begin(), shared_.end());
  for (std::uint32_t k = 0; k < records_.size(); ++k)
    if (records_[k].carrier != Carrier::none && !is_heavy(heavy_side(records_[k]).first))
      find_loads_of(
          k, heavy_side(records_[k]).second.inverse_mass * static_cast<double>(sharing_of(records_[k])));
  const auto of = [](const HeavyKey& key) { return std::pair(key.object, key.particle); };
  std::sort(keys_.begin(), keys_.end(), [&](const HeavyKey& a, const HeavyKey& b) {
    return std::tuple(of(a), a.record) < std::tuple(of(b), b.record);
  });
  for (std::size_t first = 0, next = 0; first < keys_.size(); first = next) {
    for (next = first; next < keys_.size() && of(keys_[next]) == of(keys_[first]);) ++next;
    const double w = inverse_mass_of(&keys_[first], keys_.data() + next);
    for (std::size_t k = first; k < next; ++k) find_loads_of(keys_[k].record, w);
  }
  std::sort(fresh_loads_.begin(), fresh_loads_.end(), [](const Load& a, const Load& b) {
    return std::tuple(a.particle, a.record) < std::tuple(b.particle, b.record);
  });
  const bool changed = fresh_loads_ != loads_;
  std::swap(loads_, fresh_loads_);
  reached_.resize(loads_.size()), carried_.resize(loads_.size()), own_.resize(loads_.size());
  return changed;
}

void Ties::drop_loads(std::uint32_t record) {
  std::erase_if(loads_, [record](const Load& load) { return load.record == record; });
  std::erase(between_particles_, record);
}

// --- loads

namespace {

/// Inverse mass of a particle that carries more.
float loaded(float inverse_mass, double carried) {
  return inverse_mass > 0 ? static_cast<float>(1 / (1 / static_cast<double>(inverse_mass) + carried)) : 0;
}

double limited(float inverse_mass, double load) {
  return inverse_mass > 0 ? std::min(load, heaviest / static_cast<double>(inverse_mass)) : 0;
}

}  // namespace

void Ties::add_loads(std::span<Vec4f> position) const {
  for (std::size_t first = 0, next = 0; first < loads_.size(); first = next) {
    float& w = position[loads_[first].particle].w;
    double carried = 0;
    for (next = first; next < loads_.size() && loads_[next].particle == loads_[first].particle; ++next)
      carried += limited(w, loads_[next].mass);
    w = loaded(w, carried);
  }
}

void Ties::begin_step(double h) {
  h_ = h;
  broken_.clear();
  substeps_ = 0;
  for (Record& record : records_) record.force_sum = {};
}

void Ties::set_target(std::size_t index, bool of_b, const Vec3d& target) {
  (of_b ? records_[index].target_b : records_[index].target_a) = target;
}

void Ties::begin(const ParticleView& particles, RigidBodies& bodies, std::span<Vec4f> position,
                 const Substep& substep) {
  h_ = static_cast<double>(substep.h);
  for (Record& record : records_) {
    record.lambda = {}, record.friction = 0, record.solved = false;
    record.held_segment = record.state.segment, record.held_along = record.state.along;
  }
  project_all(particles, bodies);
  for (std::size_t l = 0; l < loads_.size(); ++l) {
    own_[l] = position[loads_[l].particle].w;
    carried_[l] = limited(own_[l], loads_[l].mass);
    reached_[l] = particles.moving[loads_[l].particle].xyz();
  }
  add_loads(position);
  carrying_ = true;
}

void Ties::end(const ParticleView& particles, RigidBodies& bodies, std::span<Vec4f> position) {
  if (!carrying_) return;
  carrying_ = false;
  for (std::size_t l = 0; l < loads_.size(); ++l) position[loads_[l].particle].w = own_[l];
  for (std::size_t l = 0; l < loads_.size(); ++l) {
    const std::uint32_t i = loads_[l].particle;
    const Vec3d impulse = Vec3d(particles.moving[i].xyz() - reached_[l]) * carried_[l];
    if (impulse == Vec3d{}) continue;
    Record& record = records_[loads_[l].record];
    const bool by_a = record.carrier == Carrier::a;
    const Point heavy = by_a ? Sides::b_of(record) : Sides::a_of(record);
    record.lambda += by_a ? -impulse : impulse;
    if (heavy.end->kind == TieEnd::Kind::body) {
      const std::uint32_t body = heavy.number.index;
      souple::push(bodies, body, particles.exact_position(i) - bodies.pose[body].position, impulse);
    } else {
      Sides(particles, &bodies).push(heavy, impulse);
    }
  }
}

// --- projection

void Ties::project_all(const ParticleView& particles, RigidBodies& bodies, bool in_turns_only) {
  const Sides sides(particles, &bodies);
  for (Record& record : records_)
    if (record.state.broken == 0 && (record.in_turns || !in_turns_only)) project_one(record, sides);
}

void Ties::project(int, std::size_t begin, std::size_t end, const ParticleView& particles, const Substep&) {
  const Sides sides(particles, nullptr);
  for (std::size_t k = begin; k < end; ++k) project_one(records_[between_particles_[k]], sides);
}

std::uint32_t Ties::particle_of(int, std::size_t index, const ParticleView& particles) const {
  const Record& record = records_[between_particles_[index]];
  std::uint32_t found = no_particle;
  const auto look = [&](std::uint32_t i, double) {
    if (found == no_particle && particles.inverse_mass(i) > 0) found = i;
  };
  Sides::for_each_part(Sides::a_of(record), look), Sides::for_each_part(Sides::b_of(record), look);
  return found;
}

void Ties::project_one(Record& record, const Sides& sides) const {
  const Point a = Sides::a_of(record);
  Point b = Sides::b_of(record);
  if (!b.chain.empty()) {
    follow_chain(
        static_cast<std::uint32_t>(b.chain.size() - 1), [&](std::uint32_t k) { return sides.of_chain(b, k); },
        sides.at(a), record.state.segment, record.state.along);
    b = Sides::b_of(record);
  }
  const Vec3d d = sides.at(a) - sides.at(b);
  if (record.tie.rest_length > 0 || !b.chain.empty()) {
    project_row(record, sides, d);
    if (record.tie.friction > 0) rub(record, sides);
    return;
  }
  const double alpha = softness(record);
  const Mat3d W = sides.inverse_mass(a) + sides.inverse_mass(b) + Mat3d::diagonal({alpha, alpha, alpha});
  if (!(W.column[0].x > 0) || !(W.column[1].y > 0) || !(W.column[2].z > 0)) return;  // nothing moves
  const Vec3d change = inverse(W) * (d + record.lambda * alpha) * -1.0;
  record.lambda += change, record.solved = true;
  sides.push(a, change), sides.push(b, -change);
}

// C = |d| - l along d.
void Ties::project_row(Record& record, const Sides& sides, const Vec3d& d) const {
  const double distance = length(d);
  if (!(distance > 0)) return;
  const Vec3d n = d / distance;
  const Point a = Sides::a_of(record), b = Sides::b_of(record);
  const double alpha = softness(record);
  const double w = dot(n, (sides.inverse_mass(a) + sides.inverse_mass(b)) * n) + alpha;
  if (!(w > 0)) return;
  const double change = -(distance - record.tie.rest_length + alpha * dot(record.lambda, n)) / w;
  record.lambda += n * change, record.solved = true;
  sides.push(a, n * change), sides.push(b, n * -change);
}

// Coulomb's friction holds the chain's point of the substep's start. Its force is at most `friction` times the force
// across the chain.
void Ties::rub(Record& record, const Sides& sides) {
  const Point a = Sides::a_of(record), b = Sides::b_of(record);
  Point held = b;
  held.segment = record.held_segment, held.along = record.held_along;
  const Vec3d edge = sides.of_chain(b, b.segment + 1) - sides.of_chain(b, b.segment);
  const double l = length(edge);
  if (!(l > 0)) return;
  const Vec3d t = edge / l;
  const double w = dot(t, (sides.inverse_mass(a) + sides.inverse_mass(b)) * t);
  if (!(w > 0)) return;
  const double across = length(record.lambda - t * dot(record.lambda, t));
  const double limit = record.tie.friction * across;
  const double wanted = record.friction - dot(sides.at(a) - sides.at(held), t) / w;
  const double change = std::clamp(wanted, -limit, limit) - record.friction;
  record.friction += change, record.lambda += t * change;
  sides.push(a, t * change), sides.push(b, t * -change);
}

void Ties::end_substep(const ParticleView& particles, const RigidBodies& bodies) {
  ++substeps_;
  RigidBodies& readable = const_cast<RigidBodies&>(bodies);  // NOLINT(cppcoreguidelines-pro-type-const-cast)
  const Sides sides(particles, &readable);
  for (std::uint32_t k = 0; k < records_.size(); ++k) {
    Record& record = records_[k];
    if (record.state.broken != 0 || !record.solved) continue;
    const Vec3d force = record.lambda / -(h_ * h_);
    record.force_sum += force;
    record.state.force = record.force_sum / static_cast<double>(substeps_);
    const double distance = length(sides.at(Sides::a_of(record)) - sides.at(Sides::b_of(record)));
    record.residual = abs(distance - record.tie.rest_length);
    const double strain = record.tie.rest_length > 0 ? distance / record.tie.rest_length - 1 : 0;
    if (length(force) <= record.tie.breaking_force && strain <= record.tie.breaking_strain) continue;
    record.state.broken = 1, record.state.force = force;
    broken_.push_back(k);
    drop_loads(k);
  }
}

Residual Ties::residual(const ParticleView&, Threads*) const {
  Residual result;
  for (const Record& record : records_) {
    if (record.state.broken != 0) continue;
    const double C = record.residual;
    const double energy = record.tie.compliance > 0 ? C * C / (2 * record.tie.compliance) : 0;
    result.add({C, C, 1, energy, 0});
  }
  return result;
}

void Ties::visit(const ParticleView&, const ConstraintVisitor& visitor) const {
  std::vector<std::uint32_t> particles;
  for (const Record& record : records_) {
    if (record.state.broken != 0) continue;
    particles.clear();
    const auto add = [&](std::uint32_t i, double) { particles.push_back(i); };
    Sides::for_each_part(Sides::a_of(record), add), Sides::for_each_part(Sides::b_of(record), add);
    visitor({particles, 0, 0, static_cast<float>(record.residual)});
  }
}

// --- state

void Ties::keep() {
  for (Record& record : records_) record.kept = record.state;
}

void Ties::undo() {
  for (Record& record : records_) record.state = record.kept;
}

void Ties::save(SavedBytesWriter& out) const {
  static_assert(sizeof(TieState) == 40, "without padding");
  for (const Record& record : records_) out.put(record.state);
}

std::vector<TieState> Ties::read(SavedBytes& in) const {
  std::vector<TieState> states = in.get_list<TieState>(records_.size());
  in.require_end();
  for (std::size_t k = 0; k < states.size(); ++k) {
    const TieState& state = states[k];
    const std::size_t segments = std::max<std::size_t>(records_[k].tie.chain.size(), 2) - 1;
    in.require(state.broken <= 1 && state.segment < segments && state.along >= 0 && state.along <= 1 &&
               all_finite(state.force));
  }
  return states;
}

void Ties::set(std::span<const TieState> states) {
  for (std::size_t k = 0; k < records_.size(); ++k) records_[k].state = states[k];
}

std::size_t Ties::bytes() const {
  return bytes_of(records_, loads_, reached_, carried_, own_, between_particles_, broken_);
}

}  // namespace souple
