#pragma once

#include "souple/collision/contact.h"
#include "souple/collision/contact_arrays.h"
#include "souple/collision/contact_material.h"
#include "souple/collision/element_pairs.h"
#include "souple/solver/projector.h"
#include "souple/solver/threads.h"

#include <array>
#include <span>
#include <vector>

namespace souple {

/// Surfaces against surfaces: a vertex against a triangle, an edge against an edge, of two objects or of one;
/// and a ball against the edge of a rope, as an edge of no length.
///
///   C = n . sum_k c_k p_k - d >= 0,   sum_k c_k = 0
///
/// c_k are the weights of the two nearest points (1 and minus barycentric for a vertex and a triangle), n the
/// unit vector between them and d the distance that thickness asks for. Both are found once a substep: where
/// the motion x -> p leads, or, when it would bring the two through each other, just before they touch
/// (continuous.h). So n always points to the side that the features came from. Corrections w_k c_k n keep
/// momentum. Friction, restitution and the slow release of an old overlap are those of ParticleContacts.
///
/// A vertex that is nearest to a side or a corner of a triangle, and over none of the triangles around it,
/// touches all of these: one contact is made of them, with the first that the mesh has there. Where it is
/// over one of them, that one alone counts: the normal from the side would brake what slides across. Edges
/// whose nearest point is an end are left to that vertex and the triangles, unless one of them is a rope's.
///
/// A contact has to be there before the solver brings the two too near, or it comes and goes from one substep
/// to the next: what lies still would tremble. Where bodies are stiff or heavy, the solver first moves them
/// into each other by much more than they move in a substep, and contacts push them back. So contacts near
/// a particle that was pushed begin as much earlier as it was pushed, in this and in some substeps after.
///
/// After the solver, `keep_apart` looks along the way of everything once more. Pairs that would pass through
/// each other all the same are pushed some more; where that does not settle it either (something is squeezed
/// between walls), ways are shortened: what was not tangled never becomes so.
class SurfaceContacts final : public Projector {
 public:
  /// What can touch, anew when objects came, went or changed.
  void set_surfaces(std::vector<ContactSurface> surfaces);
  /// The loose particles of a surface end here from the next step on, at most at its reserved end.
  void set_end(std::size_t surface, std::uint32_t end) { pairs_.set_end(surface, end); }
  /// Pairs of particles that are tied together: features that have one each never touch.
  void exclude(std::vector<std::array<std::uint32_t, 2>> pairs) { pairs_.exclude(std::move(pairs)); }
  /// Whose tangles may pass; none: all are held. It must live as long as this is used.
  void set_untangling(const Untangling* untangling) { pairs_.set_untangling(untangling); }

  /// `surfaces` and `radius` as for ParticleContacts; contact_margin[i]: how far contacts pushed particle i
  /// of late [m], which this keeps up to date. All must live until the step ends.
  void begin_step(const ParticleView& particles, std::span<const Vec4f> velocity,
                  std::span<const float> radius, std::span<float> contact_margin,
                  const ContactMaterialTable& matrix, const ContactStep& step, Threads& threads);
  /// After prediction: the contacts of this substep.
  void refresh(const ParticleView& particles, const Substep& substep, Threads& threads);
  /// After the solver, before velocities are taken. Returns how often a way was shortened.
  std::size_t keep_apart(const ParticleView& particles, const Substep& substep, Threads& threads);
  void apply_restitution(const ParticleView& particles, std::span<Vec4f> velocity, const Substep& substep,
                         Threads& threads);

  ContactReport report() const;
  void events(const ParticleView& particles, std::vector<ContactPush>& out) const;

  std::string_view kind() const override { return "surface contact"; }
  std::size_t size() const override { return contacts_.size(); }
  void prepare(std::size_t) override {}
  int color_count() const override { return static_cast<int>((begin_.size() - 1) / 2); }
  std::size_t color_size(int color) const override {
    const auto c = static_cast<std::size_t>(color);
    return begin_[2 * c + 2] - begin_[2 * c];
  }
  std::size_t grain() const override { return 256; }
  using Projector::project;
  void project(int color, std::size_t begin, std::size_t end, const ParticleView& particles,
               const Substep& substep) override;
  Residual residual(const ParticleView& particles) const override;
  void visit(const ParticleView& particles, const ConstraintVisitor& visitor) const override;
  std::size_t bytes() const override;
  void erase_particles(std::uint32_t begin, std::uint32_t end) override;

 private:
  /// A pair that makes a contact in this substep, where this part of its way has led it.
  struct Touch {
    std::uint32_t pair;
    float part;
  };
  /// A pair whose particles must not go all their way.
  using Cut = Touch;
  /// What was found among the pairs of a chunk.
  struct Found {
    std::vector<Touch> touches;
    std::size_t place = 0;
  };

  void forget_contacts();
  void renew_colors_from(std::size_t renewed_from);
  void renew_colors();
  void find_sides();
  bool is_owner(const NearPair& pair, unsigned on_border, const ParticleView& particles) const;
  bool is_owner_of_side(const NearPair& pair, std::size_t corner, const ParticleView& particles) const;
  bool is_owner_of_corner(const NearPair& pair, std::size_t corner, const ParticleView& particles) const;
  template <class Function>
  void find(std::vector<Touch>& found, Threads& threads, const Function& of_range);
  void find_touching(std::size_t chunk, const ParticleView& particles, std::vector<Touch>& found);
  void find_passing(std::size_t chunk, const ParticleView& particles, bool all, std::vector<Cut>& found);
  void find_cuts(const ParticleView& particles, Threads& threads);
  void find_cuts_again(const ParticleView& particles, const Substep& substep, Threads& threads);
  bool is_contact(std::uint32_t pair, unsigned classification, const ParticleView& particles,
                  float& part) const;
  std::uint16_t color_of(const NearPair& pair, const ParticleView& particles);
  void sort_touches(const ParticleView& particles);
  void describe(bool edges, std::size_t begin, std::size_t end, const ParticleView& particles,
                const std::vector<std::uint32_t>& pairs, const std::vector<float>& parts,
                const kernels::ContactColumns& out);
  void describe_touches(const ParticleView& particles, Threads& threads);
  void push_cuts(const ParticleView& particles);
  void shorten_ways(const ParticleView& particles);
  void remember_pushes();

  ElementPairs pairs_;
  /// A side of a triangle, by one of its ends.
  struct Side {
    std::uint32_t other, third;  ///< its other end, and the corner across
  };
  /// Those of vertex i begin at side_begin_[i], by their other ends and then in the order of triangles.
  std::vector<std::uint32_t> side_begin_;
  std::vector<Side> sides_;
  std::vector<std::array<std::uint32_t, 3>> owner_of_vertex_;  // the first triangle that has it

  std::span<float> contact_margin_;
  const ContactMaterialTable* matrix_ = nullptr;
  ContactStep step_;
  kernels::ContactLimits limits_{};
  std::vector<Found> found_;    // of each chunk
  std::vector<Touch> touches_;  // in order of pairs
  /// Of each pair that has made a contact since all pairs were found: its color. A pair keeps it until they
  /// are found again.
  std::vector<std::uint16_t> color_;
  /// Which colors the contacts of each particle have; 64 to a word, all particles of one word in a row.
  std::vector<std::uint64_t> used_;
  std::vector<std::uint32_t> pair_;  // of each contact
  std::vector<float> part_;
  /// Contacts of color c: vertices against triangles begin at begin_[2 c], edges at begin_[2 c + 1].
  std::vector<std::size_t> begin_{0}, next_place_;
  ContactArrays contacts_;
  kernels::ContactColumns columns_{};  // of contacts_
  std::vector<float> left_of_way_;     // to each particle, in keep_apart
  std::vector<Cut> cuts_;
  std::vector<std::uint32_t> cut_pair_;
  std::vector<float> cut_part_;
  std::vector<std::uint32_t> cut_particles_;  // that a pass of keep_apart has moved
  ContactArrays rescues_;                     // what the solver left undone
};

}  // namespace souple
