#pragma once

#include "souple/objects/tie_options.h"
#include "souple/solver/facets.h"
#include "souple/state/rigid_bodies.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace souple {

class SavedBytes;
class SavedBytesWriter;

/// A side of a tie: a weighted sum of particles, a point of a rigid body, or a point that other code moves.
struct TieEnd {
  enum class Kind : std::uint8_t { particles, body, target };
  struct Part {
    std::uint32_t particle = 0;  ///< within the object
    double weight = 1;
  };
  Kind kind = Kind::target;
  std::optional<ObjectId> object;
  std::optional<ColliderId> collider;
  std::vector<Part> parts;  ///< of particles
  bool loose = false;       ///< particles without constraints of their own: grains
  Vec3d local{};            ///< in the frame of the body or collider, or in the world [m]
};

/// A tie without its state.
struct Tie {
  TieId id;
  std::string name;
  TieEnd a, b;
  double rest_length = 0;  ///< m
  double compliance = 0;   ///< m/N
  double breaking_force = 0, breaking_strain = 0;
  std::vector<std::uint32_t> chain;  ///< particles of b that it slides along; empty: it does not slide
  double friction = 0;
};

/// State that one step passes to the next.
struct TieState {
  std::uint32_t segment = 0, broken = 0;
  double along = 0;  ///< position on the segment, in [0, 1]
  Vec3d force{};     ///< on b, mean over the last step [N]
};

/// Index and inverse mass of an object's side of a tie in a step.
struct TieNumber {
  std::uint32_t index = 0;  ///< of the object's first particle, or of the body
  double inverse_mass = 0;  ///< of a body; W of a sum of particles [1/kg]
  Vec3d inverse_inertia{};  ///< of a body, about its principal axes [1/(kg m^2)]
};

/// The ties of a world. A tie holds the points p_a and p_b at a rest length l (XPBD, Macklin 2016, eq. 18):
///
///   C = p_a - p_b  (three rows) for l = 0,   C = |p_a - p_b| - l  otherwise,   alpha~ = alpha / h^2
///   dlambda = -(W_a + W_b + alpha~)^-1 (C + alpha~ lambda)
///
/// For a weighted sum of particles W = sum w_i^2 / m_i, and each particle gets the part w_i of the impulse. For a point
/// of a rigid body W = 1/m - [r] I^-1 [r] (Müller et al. 2020). lambda lasts one substep, over all projections.
///
/// Loads. A sweep moves light particles instead of a heavy body that is tied to them: light cloth would carry only
/// about its own mass. So particles show the mass of the tied side as a load while the solver moves them:
///
///   1. `begin` projects the ties and adds the loads, m_i + mu w_i. Sweeps, levels, eliminations and contacts count them.
///   2. The solver moves the particles. A particle's motion times mu w_i is the impulse on the tied side at that point.
///   3. `end` applies these impulses and removes the loads.
///   4. `project_all` projects the tied points onto each other, in turns with joints and contacts of bodies.
///
/// Loads are a rigid body, a grain, a target or much heavier particles, tied with l = 0. Momentum and angular momentum
/// are conserved to rounding, for any mu. If mu is too small by a factor n, g h^2 (n - 1) remains in equilibrium: 0.03
/// mm times n - 1 at 600 substeps a second. K ties of a body have 1 / mu = K s / m + alpha~ (uniform mass splitting,
/// Tonge et al. 2012). The factor s makes this stable: masses m / (K s) at the tied points never have more kinetic
/// energy than the body. s is the largest eigenvalue of B, see Crowding in ties.cpp.
///
/// A tie that slides holds the point of the chain that is closest to p_a. Its impulse is perpendicular to the chain,
/// except for Coulomb's friction and at the ends of the chain.
///
/// As a Projector, in the solver's sweeps, it projects ties between particles alone.
class Ties final : public Projector, public MemoryFacet {
 public:
  bool empty() const { return records_.empty(); }
  std::size_t count() const { return records_.size(); }
  const Tie& tie(std::size_t index) const { return records_[index].tie; }
  const TieState& state(std::size_t index) const { return records_[index].state; }
  void add(Tie tie, const TieState& state);
  void remove(std::span<const IndexRange> ties);

  /// Calls number(end) for each side of an object, which returns a TieNumber. Returns whether the masses that particles
  /// show have changed; then the solver must be prepared again.
  template <class Number>
  bool list(const Number& number) {
    for (Record& record : records_) {
      if (record.tie.a.object) record.a = number(record.tie.a);
      if (record.tie.b.object) record.b = number(record.tie.b);
    }
    return find_loads();
  }
  /// Adds the loads to inverse masses (w lanes) that particles have without them.
  void add_loads(std::span<Vec4f> position) const;
  bool holds_bodies() const { return holds_bodies_; }
  /// Calls f(body) for the rigid bodies that ties hold.
  template <class Function>
  void for_each_body(const Function& f) const {
    for (const Record& record : records_) {
      if (record.state.broken != 0) continue;
      if (record.tie.a.kind == TieEnd::Kind::body) f(record.a.index);
      if (record.tie.b.kind == TieEnd::Kind::body) f(record.b.index);
    }
  }

  /// Begins a step with substeps of h seconds. Call before `list`.
  void begin_step(double h);
  /// Sets the point of a collider or of the world at the end of the substep.
  void set_target(std::size_t index, bool of_b, const Vec3d& target);
  /// Call after the prediction. `position`: of the particles, for its w lanes.
  void begin(const ParticleView& particles, RigidBodies& bodies, std::span<Vec4f> position,
             const Substep& substep);
  /// Call after the solver.
  void end(const ParticleView& particles, RigidBodies& bodies, std::span<Vec4f> position);
  /// Projects all ties, in order, or those that take turns with contacts: of bodies, and of what they are tied to.
  void project_all(const ParticleView& particles, RigidBodies& bodies, bool in_turns_only = false);
  /// Reports forces, and breaks ties.
  void end_substep(const ParticleView& particles, const RigidBodies& bodies);
  /// Indices of the ties that broke since begin_step.
  std::span<const std::uint32_t> broken() const { return broken_; }

  void keep();
  void undo();
  /// State that one step passes to the next.
  void save(SavedBytesWriter& out) const;
  /// Reads a saved state. Throws Error if it is none of these ties.
  std::vector<TieState> read(SavedBytes& in) const;
  void set(std::span<const TieState> states);

  std::string_view kind() const override { return "tie"; }
  std::size_t size() const override;
  /// All are solved on one thread, in order.
  Facets facets() override { return {.grain = std::numeric_limits<std::size_t>::max(), .memory = this}; }
  void prepare(std::size_t) override {}
  int color_count() const override { return 1; }
  std::size_t color_size(int) const override { return between_particles_.size(); }
  std::uint32_t particle_of(int, std::size_t index, const ParticleView& particles) const override;
  using Projector::project;
  void project(int color, std::size_t begin, std::size_t end, const ParticleView& particles,
               const Substep& substep) override;
  /// The residual of the last substep.
  Residual residual(const ParticleView& particles, Threads* = nullptr) const override;
  void visit(const ParticleView& particles, const ConstraintVisitor& visitor) const override;
  std::size_t bytes() const override;
  /// The world removes ties together with their objects, and lists them again.
  void erase_particles(std::uint32_t, std::uint32_t) override {}

 private:
  /// The side whose particles carry the mass of the other side.
  enum class Carrier : std::uint8_t { none, a, b };
  struct Record {
    Tie tie;
    Carrier carrier = Carrier::none;
    TieState state, kept;
    TieNumber a, b;
    bool in_turns = false;
    Vec3d target_a{}, target_b{};    ///< m
    Vec3d lambda{};                  ///< positional impulse on a in this substep [kg m]
    double friction = 0;             ///< its part by friction, along the chain
    std::uint32_t held_segment = 0;  ///< of the chain, where the substep began
    double held_along = 0;
    Vec3d force_sum{};    ///< on b, of the substeps of a step [N]
    double residual = 0;  ///< m
    bool solved = false;  ///< a side moves; otherwise the force stays
  };
  /// Mass that a particle carries for a tie.
  struct Load {
    std::uint32_t particle = 0, record = 0;
    double mass = 0;  ///< kg; infinite: of a target
    bool operator==(const Load&) const = default;
  };
  /// A body, or a loose particle, and a tie by which it is held.
  struct HeavyKey {
    std::uint32_t object = 0, particle = 0, record = 0;
  };
  struct Point;
  class Sides;

  double softness(const Record& record) const;  ///< alpha~ [1/kg]
  bool find_loads();
  void find_turns();
  void find_loads_of(std::uint32_t record, double w);
  static std::pair<const TieEnd&, const TieNumber&> heavy_side(const Record& record);
  static Carrier carrier_of(const Record& record);
  std::size_t sharing_of(const Record& record) const;
  double inverse_mass_of(const HeavyKey* first, const HeavyKey* last) const;
  /// After a tie broke.
  void drop_loads(std::uint32_t record);
  void project_one(Record& record, const Sides& sides) const;
  void project_row(Record& record, const Sides& sides, const Vec3d& d) const;
  static void rub(Record& record, const Sides& sides);

  std::vector<Record> records_;      // ascending by id
  std::vector<Load> loads_;          // ascending by particle
  std::vector<Load> fresh_loads_;    // work space of find_loads
  std::vector<HeavyKey> keys_;       // work space: what each heavy side is tied by, sorted
  std::vector<std::uint32_t> held_;  // work space: ids of the objects of ties that hold bodies, sorted
  std::vector<std::uint32_t>
      shared_;                   // work space: particles whose mass others carry, once for each tie, sorted
  std::vector<Vec3f> reached_;   // per load: `moving` of its particle when the solver began
  std::vector<double> carried_;  // per load [kg]
  std::vector<float> own_;       // per load: inverse mass of its particle without loads
  std::vector<std::uint32_t> between_particles_;  // records
  std::vector<std::uint32_t> broken_;
  bool holds_bodies_ = false;
  bool carrying_ = false;  // particles show their loads
  double h_ = 0;
  std::size_t substeps_ = 0;  // of the current step so far
};

}  // namespace souple
