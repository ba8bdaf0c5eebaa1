#pragma once

#include "souple/contacts/contact_projector.h"
#include "souple/intersections/intersecting_pair.h"

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace souple {

class IntersectionResolver;

/// All contacts of a world, and the resolution of intersections. ContactProjector explains the calls.
class Contacts {
 public:
  Contacts();
  ~Contacts();
  Contacts(const Contacts&) = delete;
  Contacts& operator=(const Contacts&) = delete;

  void build(const ContactGeometry& geometry);
  void set_end(std::size_t object, std::uint32_t end);
  /// `search_intersections`: in all objects; else only between those that had some at the last search.
  void begin_step(const ContactInput& input, bool search_intersections, Threads& threads);
  /// Separates what intersects, then finds the contacts.
  void refresh(const ParticleView& particles, const Substep& substep, double time, Threads& threads);
  std::size_t after_solve(const ParticleView& particles, const Substep& substep, Threads& threads);
  /// See ContactProjector.
  std::span<const BodyPush> body_pushes() const;
  std::span<const Pinch> pinches() const;
  void update_masses(const ParticleView& particles);
  void choose_body_contacts(const ParticleView& particles, const ParticleFunction& f);
  void project_body_contacts(const ParticleView& particles);
  void visit_body_impulses(const ImpulseFunction& f) const;
  void append_impacts(const Substep& substep, std::vector<Impact>& out) const;
  void apply_restitution(const ParticleView& particles, std::span<Vec4f> velocity, const Substep& substep,
                         Threads& threads);

  void visit_impulses(const ParticleView& particles, const ImpulseFunction& f) const;

  ContactReport report() const;
  /// The fastest motion that was shortened in this step; speed 0: none.
  ShortenedMotion shortened() const;
  /// Appends the contacts with a normal impulse in the last substep: first those with colliders.
  void events(const ParticleView& particles, std::vector<ContactPush>& out) const;
  /// The kinds in order of solution. The last ones keep objects out of colliders.
  std::span<const std::unique_ptr<ContactProjector>> kinds() const { return kinds_; }

  /// Calls f(particle) for those that `refresh` separates in this step.
  void visit_separated(const ParticleFunction& f) const;
  /// Intersecting pairs of objects that begin_step found.
  std::span<const IntersectingPair> intersecting_pairs() const;
  /// Number of layer violations that begin_step found.
  std::size_t layer_violations() const;

  /// State that one step passes to the next.
  void save(SavedBytesWriter& out) const;
  /// Throws Error if `in` is not what `save` wrote, for a world of so many particles.
  void check_saved(SavedBytes in, std::size_t particles) const;
  /// Restores what was checked.
  void load(SavedBytes in);
  void erase_particles(std::uint32_t begin, std::uint32_t end);
  std::size_t bytes() const;

 private:
  template <class Function>
  void guarded_for_each(const Function& f);

  std::unique_ptr<IntersectionResolver> intersection_resolver_;
  std::vector<std::unique_ptr<ContactProjector>> kinds_;
};

}  // namespace souple
