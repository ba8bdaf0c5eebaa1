#pragma once

#include "souple/broad_phase/contact_surface.h"
#include "souple/contacts/collider.h"
#include "souple/contacts/contact.h"
#include "souple/contacts/contact_material.h"
#include "souple/solver/projector.h"
#include "souple/threads/threads.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

// The interface of all kinds of contacts, and what they read.

namespace souple {

class SavedBytes;
class SavedBytesWriter;

/// A triangle, or an edge that repeats its second corner, that may touch colliders.
struct ContactElement {
  std::array<std::uint32_t, 3> particle;
  std::uint32_t object;  ///< row in the material table
  float radius;          ///< of the smallest circle around it at rest [m]
};

/// Objects, colliders and their materials: what contacts read in each step.
struct ContactTables {
  std::vector<ContactObject> objects;
  std::vector<Collider> colliders;
  std::vector<std::vector<Edge>> rope_edges;  ///< per object; empty except for ropes
  ContactMaterialTable against_colliders;     ///< at(object, collider)
  ContactMaterialTable against_objects;       ///< at(object, object)
};

/// Geometry of all objects, from which contacts are built when an object is added, removed or changed.
struct ContactGeometry {
  std::vector<ContactSurface> surfaces;  ///< per object
  /// Triangles and edges of objects that may touch colliders. Their order determines the order of contacts.
  std::vector<ContactElement> elements;
  ParticlePairs joined;  ///< never collide: distance joints
};

/// Input of contacts when a step begins.
struct ContactInput {
  ParticleView particles;                 ///< as the last substep left them
  std::span<const Vec4f> velocity;        ///< [m/s]
  std::span<const float> radius;          ///< half the thickness [m]
  std::span<const float> element_radius;  ///< see Particles::element_radius [m]
  /// Additional distance at which surface contacts of a particle begin; after_solve updates it [m].
  std::span<float> contact_margin;
  const ContactTables& tables;
  ContactStep step;
};

using ParticleFunction = std::function<void(std::uint32_t)>;
using ImpulseFunction = std::function<void(const ContactImpulse&)>;

/// A kind of contacts: those of particles with colliders, of two particles, of two surfaces, ...
///
/// Calls in a step:
///   begin_step(input)                      once: broad phase, the candidates of the step
///   for each substep, at time t:
///     refresh(view, substep, t)            after prediction: the contacts along x -> p, colliders t -> t + h
///     project(color, view, substep)        each iteration: normal correction, friction
///     after_solve(view, substep)           after the last iteration, before v = (p - x) / h
///     append_impacts(substep)              then the velocities of bodies as a whole change
///     apply_restitution(view, velocities)  after v = (p - x) / h
///   report(), events()
///
/// The input of `begin_step` must live until the step ends, except for the views of particles.
class ContactProjector : public Projector, public ContactFacet {
 public:
  Facets facets() final {
    return {.grain = grain(), .every_round = true, .alternates = alternates(), .contact = this};
  }
  /// See Facets.
  virtual std::size_t grain() const = 0;
  virtual bool alternates() const { return false; }
  virtual std::size_t bytes() const = 0;
  void prepare(std::size_t) final {}

  std::uint32_t particle_of(int color, std::size_t index, const ParticleView& particles) const override = 0;

  /// Replaces all geometry, and drops all contacts: called when objects or colliders are added, removed or changed.
  virtual void build(const ContactGeometry& geometry) = 0;
  /// Sets the end of an object that consists of particles alone, from the next step on: at most its reserved_end.
  virtual void set_end([[maybe_unused]] std::size_t object, [[maybe_unused]] std::uint32_t end) {}
  /// Exceptions of a collider's motion pass through; the contacts are then empty.
  virtual void begin_step(const ContactInput& input, Threads& threads) = 0;
  /// Finds the contacts of the substep [time, time + h]. Exceptions as in begin_step.
  virtual void refresh(const ParticleView& particles, const Substep& substep, double time,
                       Threads& threads) = 0;
  /// Changes what the solver left, where contacts must hold exactly. Returns the number of clamped motions.
  virtual std::size_t after_solve(const ParticleView&, const Substep&, Threads&) { return 0; }
  /// Motions by the last after_solve out of the way of rigid bodies: in order of object and particle, each pair once.
  virtual std::span<const BodyPush> body_pushes() const { return {}; }
  /// Objects between which the last after_solve stopped particles, one of them a rigid body.
  virtual std::span<const Pinch> pinches() const { return {}; }
  /// The inverse masses of particles have changed since `refresh`.
  virtual void update_masses(const ParticleView&) {}
  /// After the solver: chooses the contacts with rigid bodies that push or are violated, and calls f(particle) for the
  /// particles of these bodies.
  virtual void choose_body_contacts(const ParticleView&, [[maybe_unused]] const ParticleFunction& f) {}
  /// Projects the chosen contacts, one after the other.
  virtual void project_body_contacts(const ParticleView&) {}
  /// Calls f for those of the chosen contacts that pushed.
  virtual void visit_body_impulses([[maybe_unused]] const ImpulseFunction& f) const {}
  /// Appends the impacts of the substep that are faster than the threshold of restitution.
  virtual void append_impacts(const Substep&, [[maybe_unused]] std::vector<Impact>& out) const {}
  /// For contacts with a normal impulse: sets v_n, the normal velocity relative to the other side. It becomes e times
  /// the approach speed if that was above 2 |g| h, else 0. The approach speed is that of the predicted motion. Velocity
  /// that came from removing an overlap is removed, but never more than the contact itself added. Friction follows the
  /// change of the normal impulse. `velocity`: per particle [m/s].
  virtual void apply_restitution(const ParticleView& particles, std::span<Vec4f> velocity,
                                 const Substep& substep, Threads& threads) = 0;

  /// Sums what `visit` visits.
  Residual residual(const ParticleView& particles, Threads* = nullptr) const final {
    Residual result;
    visit(particles, [&result](const ConstraintState& state) {
      result.largest = max(result.largest, static_cast<double>(state.residual));
      result.sum += static_cast<double>(state.residual);
      ++result.count;
    });
    return result;
  }
  /// Its residual is max(0, -C).
  void visit(const ParticleView& particles, const ConstraintVisitor& visitor) const override = 0;
  /// Calls f for the contacts that pushed in this substep.
  virtual void visit_impulses(const ParticleView& particles, const ImpulseFunction& f) const = 0;
  virtual ContactReport report() const = 0;
  /// The fastest motion that was shortened in this step; speed 0: none.
  virtual ShortenedMotion shortened() const { return {}; }
  /// Appends the contacts with a normal impulse in the last substep.
  virtual void events(const ParticleView& particles, std::vector<ContactPush>& out) const = 0;

  /// State that one step passes to the next, for snapshots; the default has none.
  virtual void save([[maybe_unused]] SavedBytesWriter& out) const {}
  /// Throws Error if `in` is not what `save` wrote, for a world of so many particles.
  virtual void check_saved(SavedBytes in, std::size_t particles) const;
  /// Restores what was checked.
  virtual void load(SavedBytes in);
  /// Drops geometry and contacts.
  virtual void clear() = 0;
  /// The particles [begin, end) cease to exist; `build` follows. The default drops everything.
  void erase_particles([[maybe_unused]] std::uint32_t begin, [[maybe_unused]] std::uint32_t end) override {
    clear();
  }
};

}  // namespace souple
