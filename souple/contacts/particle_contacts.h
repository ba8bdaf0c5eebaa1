#pragma once

#include "souple/broad_phase/largest_motion.h"
#include "souple/broad_phase/object_pairs.h"
#include "souple/contacts/anchor.h"
#include "souple/contacts/ball_cells.h"
#include "souple/contacts/contact_law.h"
#include "souple/contacts/contact_projector.h"
#include "souple/math/lists.h"

#include <span>
#include <vector>

namespace souple {

/// Displacements of a pair of particles that friction has not canceled yet [m].
struct FrictionDisplacement {
  Vec3f sliding{};  ///< of i relative to j at the point of contact, since the pair last slid
  Vec3f rolling{};  ///< relative rotation times the moment arm, since the pair last rolled
  bool operator==(const FrictionDisplacement&) const = default;
};

/// Friction state of a pair of particles that is kept from step to step.
struct CachedFriction {
  std::uint32_t i = 0, j = 0;  ///< particles
  FrictionDisplacement displacement{};
};

/// Contacts between particles: grains and the nodes of lattices. Objects with triangles or edges collide as
/// surfaces (surface_contacts.h).
///
///   C = |x_i - x_j| - (r_i + r_j) >= 0
///
/// The broad phase is a uniform grid, filled by counting sort. It runs once per step with a margin for motion relative
/// to the mean. It runs again in the middle of a step when a particle has left its margin.
///
/// The result is that of solving contacts one after another (Gauss-Seidel) in order of (i, j), every second
/// sweep in reverse order. Each substep colors the contacts so that this holds; contacts of one color share
/// no particle that can move. The order depends on positions and indices alone. Corrections are equal and
/// opposite: momentum is conserved to rounding. Friction and restitution follow the law of collider contacts.
/// Balls of objects that roll rotate by friction, and rolling friction resists their relative rotation
/// (contact_law.h); angular momentum including their spin is conserved.
///
/// A pair may be apart before and after a substep and yet collide within it. It is found while both particles
/// are within each other's margin (at most one largest diameter).
class ParticleContacts final : public ContactProjector {
 public:
  /// Keeps the friction state of pairs of particles.
  void build(const ContactGeometry& geometry) override;
  void begin_step(const ContactInput& input, Threads& threads) override;
  void refresh(const ParticleView& particles, const Substep& substep, double time, Threads& threads) override;
  void apply_restitution(const ParticleView& particles, std::span<Vec4f> velocity, const Substep& substep,
                         Threads& threads) override;

  /// Friction state that one step passes to the next, in order of (i, j), and its restoration. erase_particles
  /// drops the entries of erased particles and renumbers the others.
  std::vector<CachedFriction> friction_cache() const;
  void set_friction_cache(std::span<const CachedFriction> cache);

  ContactReport report() const override;
  /// In order of (i, j).
  void events(const ParticleView& particles, std::vector<ContactPush>& out) const override;
  void save(SavedBytesWriter& out) const override;
  void check_saved(SavedBytes in, std::size_t particles) const override;
  void load(SavedBytes in) override;

  std::string_view kind() const override { return "particle contact"; }
  std::size_t size() const override { return contacts_.size(); }
  /// At least the number of contacts in the longest chain (i, j), (j, k), ... of ascending particles.
  int color_count() const override { return static_cast<int>(color_begin_.size()) - 1; }
  std::size_t color_size(int color) const override {
    const Range range = contacts_of(color);
    return range.end - range.begin;
  }
  std::size_t grain() const override { return 32; }
  bool alternates() const override { return true; }
  std::uint32_t particle_of(int color, std::size_t index, const ParticleView& particles) const override;
  using Projector::project;
  void project(int color, std::size_t begin, std::size_t end, const ParticleView& particles,
               const Substep& substep) override;
  void visit(const ParticleView& particles, const ConstraintVisitor& visitor) const override;
  void visit_impulses(const ParticleView& particles, const ImpulseFunction& f) const override;
  std::size_t bytes() const override;
  void clear() override;
  void erase_particles(std::uint32_t begin, std::uint32_t end) override;

 private:
  /// A particle in the broad phase.
  struct Member {
    std::uint32_t particle, object;
  };
  /// Bounds of the motion of objects within the step.
  struct Boxes {
    std::vector<Bounds> bounds;
    std::vector<std::uint32_t> object;   // whose bounds these are: objects of balls
    std::vector<std::uint8_t> are_near;  // per object: those of an object that it interacts with overlap
    BoxSweep sweep;
  };
  /// Members as balls.
  struct Places {
    Vec3f corner{};
    std::vector<Vec3f> place;  // relative to the corner [m]
    std::vector<float> radius, half_margin;
    BallCells cells;
    BallCells::Search search;
  };
  /// Members i < j that may touch before the next broad phase.
  struct Pair {
    std::uint32_t i, j;
  };
  /// How a contact rotates its balls (contact_law.h).
  struct BallRotation {
    float share_i = 0, share_j = 0, arm_i = 0, arm_j = 0;
    float inverse_A = 1, inverse_B = 0, c = 0;  // of RollingResponse
  };
  /// Which balls of a contact rotate. Equal ones have the rotation `equal_balls`.
  enum class Balls : std::uint8_t { none, i, j, both, equal };
  /// The solver reads contacts in order, and they should fit the second-level cache.
  struct Contact {
    std::uint32_t i, j, pair;
    float radius_sum;  // r_i + r_j [m]
    ContactMaterialPair material;
    Balls balls;
    bool fixed_normal;                    // the normal does not change in the substep
    float slop;                           // target of C, at most 0: old overlaps are removed slowly [m]
    Vec3f predicted;                      // motion of i relative to j before any projection [m]
    Vec3f normal;                         // from j to i, of the last projection
    ContactSums<float> sums{};            // of x_i - x_j
    Vec3f moment_sum{};                   // G: sum of rolling friction (contact_law.h) [m]
    FrictionDisplacement displacement{};  // of the pair, at the substep's start
    float restitution_velocity = 0;       // relative normal velocity that apply_restitution added [m/s]
    float depth = 0;                      // remaining overlap, of contacts with a normal impulse [m]
  };
  /// Contacts [begin, end).
  struct Range {
    std::size_t begin, end;
  };
  /// A pair that has a contact in this substep.
  struct ColoredPair {
    std::uint32_t pair, color;
  };

  bool interact(std::uint32_t object_a, std::uint32_t object_b) const;
  void find_boxes(const ParticleView& particles, std::span<const Vec4f> velocity);
  void find_members(const ParticleView& particles, std::span<const Vec4f> velocity);
  void find_pairs(const ParticleView& particles, float wanted_margin);
  void save_friction();
  void restore_friction();
  void sort_into_cells(const ParticleView& particles);
  void list_pairs();
  bool may_touch(std::uint32_t pair, const ParticleView& particles) const;
  void color_contacts(const ParticleView& particles);
  Contact contact_of(std::uint32_t pair, const ParticleView& particles, float h) const;
  void clear_contacts();
  void forget_members();
  Range contacts_of(int color) const;
  float gap(const Contact& contact, const Vec3f& difference, Vec3f& normal) const;
  void project_one(Contact& contact, const ParticleView& particles) const;
  void project_rolling(Contact& contact, float C, const Vec3f& n, const ParticleView& particles) const;
  void apply_restitution_to(Contact& contact, const ParticleView& particles, std::span<Vec4f> velocity,
                            float h);
  void apply_rolling_restitution(Contact& contact, const ParticleView& particles, std::span<Vec4f> velocity,
                                 float h);
  void update_friction_displacement(const Contact& contact, float C, const FrictionDisplacement& change);
  static const BallRotation equal_balls;
  Balls balls_of(const Member& a, const Member& b, const ParticleView& particles) const;
  BallRotation rotation_of(const Contact& contact, const ParticleView& particles) const;
  void turn(const Contact& contact, const BallRotation& balls, const Vec3f& friction,
            const Vec3f& moment) const;

  ParticlePairs joined_;  // never collide
  std::span<const ContactObject> objects_;
  std::span<const float> radius_;
  const ContactMaterialTable* materials_ = nullptr;
  ContactStep step_;
  float last_h_ = 0;  // h of the last refresh [s]
  float largest_diameter_ = 0;
  float margin_ = 0;  // of the last broad phase: how far two members may approach each other [m]
  Boxes boxes_;
  std::vector<Member> members_;
  Places places_;  // of members, in the last broad phase
  std::vector<Pair> pairs_;
  Lists<std::uint32_t> later_;                      // per member: the later ones of its pairs
  std::vector<FrictionDisplacement> displacement_;  // per pair
  std::vector<CachedFriction> friction_cache_;      // from one broad phase to the next
  LargestMotion largest_motion_;                    // of members since the last broad phase
  std::vector<std::uint8_t> is_contact_;            // per pair: 1 when it has a contact in this substep
  std::vector<std::uint32_t> next_color_;           // per member: one above the highest color of its contacts
  std::vector<ColoredPair> colored_pairs_;          // in order of pairs
  std::vector<std::uint32_t> sorted_;               // pairs with a contact, by color
  std::vector<Contact> contacts_;                   // in the order of sorted_
  std::vector<std::uint32_t> color_begin_{0}, next_slot_;  // per color: index in contacts_
};

}  // namespace souple
