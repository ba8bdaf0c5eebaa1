#pragma once

#include "souple/contacts/contact_arrays.h"
#include "souple/contacts/contact_projector.h"
#include "souple/contacts/element_pairs.h"
#include "souple/contacts/path_crossing.h"

#include <array>
#include <span>
#include <vector>

namespace souple {

/// Contacts between surfaces: a vertex and a triangle, or two edges, of two objects or of one. A ball and the
/// edge of a rope are two edges, the ball's of zero length.
///
///   C = n . sum_k c_k p_k - d >= 0,   sum_k c_k = 0
///
/// c_k are the weights of the two nearest points (1 and minus barycentric for a vertex and a triangle), n the
/// unit vector between them, and d the distance that the thickness requires. Both are computed once a
/// substep, at the end of the motion x -> p. If the motion would bring the two elements through each other,
/// they are computed just before the impact (continuous.h). So n always points to the side where the elements
/// started. Corrections w_k c_k n conserve momentum. Friction, restitution and the slow release of an old
/// overlap are as in ParticleContacts.
///
/// A vertex may be nearest to an edge or a corner of a triangle, and over none of the triangles around it. It
/// then makes one contact with all of them, through the first triangle of the mesh there. If it is over one
/// of them, only that triangle makes a contact: the normal from the edge would brake sliding vertices. Pairs
/// of edges whose nearest point is an end make no contact, unless one is a rope's: the vertex at that end
/// makes it with the triangles.
///
/// A contact must exist before the solver brings two elements too near. Otherwise it is present in one
/// substep and absent in the next, and resting objects would tremble. Where bodies are stiff or heavy, the
/// solver first moves them into each other by much more than their motion in a substep, and contacts push
/// them back. So contacts of a particle that was pushed back start earlier by that correction, in this
/// substep and some following ones.
///
/// With discrete detection only a vertex whose path crosses a triangle gets a contact, at the crossing and
/// along the triangle's normal (path_crossing.h).
///
/// After the solver, `after_solve` tests all motions again. Pairs that would still pass through each other
/// receive correction contacts. If these do not suffice (an object is squeezed between walls), motions are
/// clamped. So objects without intersections never start to intersect.
class SurfaceContacts final : public ContactProjector {
 public:
  /// Contacts ignore the pairs that the resolver exempts; null: none. It must outlive this object.
  explicit SurfaceContacts(const IntersectionResolver* intersection_resolver = nullptr) {
    pairs_.set_intersection_resolver(intersection_resolver);
  }

  /// No contact between an element of one particle of a joined pair and an element of the other particle.
  void build(const ContactGeometry& geometry) override;
  void set_end(std::size_t object, std::uint32_t end) override { pairs_.set_end(object, end); }
  void begin_step(const ContactInput& input, Threads& threads) override;
  void refresh(const ParticleView& particles, const Substep& substep, double time, Threads& threads) override;
  /// Prevents intersections. Returns the number of clamps.
  std::size_t after_solve(const ParticleView& particles, const Substep& substep, Threads& threads) override;
  void apply_restitution(const ParticleView& particles, std::span<Vec4f> velocity, const Substep& substep,
                         Threads& threads) override;
  void append_impacts(const Substep& substep, std::vector<Impact>& out) const override;
  ContactReport report() const override;
  void events(const ParticleView& particles, std::vector<ContactPush>& out) const override;

  std::string_view kind() const override { return "surface contact"; }
  std::size_t size() const override { return contacts_.size(); }
  int color_count() const override { return static_cast<int>((begin_.size() - 1) / 2); }
  std::size_t color_size(int color) const override {
    const auto c = static_cast<std::size_t>(color);
    return begin_[2 * c + 2] - begin_[2 * c];
  }
  std::size_t grain() const override { return 256; }
  using Projector::project;
  void project(int color, std::size_t begin, std::size_t end, const ParticleView& particles,
               const Substep& substep) override;
  void visit(const ParticleView& particles, const ConstraintVisitor& visitor) const override;
  std::size_t bytes() const override;
  void clear() override { set_surfaces({}); }

 private:
  /// A contact or a TOI violation: an index in pairs_, and the part of the motion at which its nearest points
  /// count. This is its time of impact, or 1 without impact.
  struct PairToi {
    std::uint32_t pair;
    float toi;
  };
  /// Contacts or violations in a chunk of pairs.
  struct ChunkResult {
    std::vector<PairToi> pairs;
    std::size_t offset = 0;  // in the list of all chunks
  };

  void set_surfaces(std::vector<ContactSurface> surfaces);
  void clear_contacts();
  void reset_colors_from(std::size_t first_new);
  void reset_colors();
  void build_vertex_edges();
  bool is_owner(const NearPair& pair, unsigned on_border, const ParticleView& particles) const;
  bool is_owner_of_edge(const NearPair& pair, std::size_t corner, const ParticleView& particles) const;
  bool is_owner_of_corner(const NearPair& pair, std::size_t corner, const ParticleView& particles) const;
  template <class Function>
  void find(std::vector<PairToi>& found, Threads& threads, const Function& of_chunk);
  void find_chunk_contacts(std::size_t chunk, const ParticleView& particles, std::vector<PairToi>& found);
  void find_chunk_violations(std::size_t chunk, const ParticleView& particles, bool all,
                             std::vector<PairToi>& found);
  void find_violations(const ParticleView& particles, Threads& threads);
  void refind_violations(const ParticleView& particles, const Substep& substep, Threads& threads);
  void find_chunk_crossings(std::size_t chunk, const ParticleView& particles, std::vector<PairToi>& found);
  PathCrossing path_crossing_of(std::uint32_t pair, const ParticleView& particles);
  void describe_crossing(std::uint32_t pair, std::size_t contact, const ParticleView& particles);
  bool is_contact(std::uint32_t pair, unsigned classification, const ParticleView& particles,
                  float& toi) const;
  std::uint16_t color_of(const NearPair& pair, const ParticleView& particles);
  void sort_by_color(const ParticleView& particles);
  bool colors_are_independent(const ParticleView& particles) const;
  void describe(bool edges, std::size_t begin, std::size_t end, const ParticleView& particles,
                const std::vector<std::uint32_t>& pairs, const std::vector<float>& tois,
                const kernels::ContactColumns& out);
  void describe_contacts(const ParticleView& particles, Threads& threads);
  void solve_corrections(const ParticleView& particles);
  void clamp_to_toi(const ParticleView& particles);
  void update_contact_margins();

  ElementPairs pairs_;
  /// An edge of a triangle, listed at one of its ends.
  struct VertexEdge {
    std::uint32_t other, opposite;  ///< the other end of the edge, and the opposite corner of the triangle
  };
  /// Edges of vertex i begin at vertex_edges_begin_[i], sorted by their other ends, then in the order of
  /// triangles.
  std::vector<std::uint32_t> vertex_edges_begin_;
  std::vector<VertexEdge> vertex_edges_;
  std::vector<std::array<std::uint32_t, 3>> owner_of_vertex_;  // per particle: its first triangle

  std::span<float> contact_margin_;
  const ContactMaterialTable* materials_ = nullptr;
  ContactStep step_;
  kernels::ContactLimits limits_{};
  std::vector<ChunkResult> chunk_results_;  // per chunk
  std::vector<PairToi> contact_pairs_;      // in order of pairs
  /// Per pair that has made a contact since the last search of all pairs: its color. It keeps the color until
  /// the next such search.
  std::vector<std::uint16_t> color_;
  /// Bits of the colors that contacts of each particle have: a word of 64 colors for all particles, then the
  /// next 64.
  std::vector<std::uint64_t> used_;
  std::vector<std::uint32_t> pair_;  // per contact: index in pairs_
  std::vector<float> toi_;           // per contact
  /// Contacts of color c: vertices against triangles begin at begin_[2 c], edges at begin_[2 c + 1].
  std::vector<std::size_t> begin_{0}, next_slot_;
  ContactArrays contacts_;
  kernels::ContactColumns columns_{};  // of contacts_
  std::vector<float> clamp_toi_;       // per particle, in after_solve: part of the motion that remains
  std::vector<PairToi> violations_;
  std::vector<std::uint32_t> correction_pair_;
  std::vector<float> correction_toi_;
  std::vector<std::uint32_t> corrected_particles_;  // moved by the last pass of after_solve
  ContactArrays corrections_;                       // correction contacts, of correction_pair_
};

}  // namespace souple
