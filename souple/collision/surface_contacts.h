#pragma once

#include "souple/collision/contact.h"
#include "souple/collision/near_pairs.h"
#include "souple/collision/surface.h"
#include "souple/solver/projector.h"
#include "souple/solver/threads.h"

#include <array>
#include <span>
#include <vector>

namespace souple {

class Untangling;

/// What an object shows to others: triangles, loose edges and loose vertices over its particles. Spans live
/// as long as the projector uses them.
struct ContactSurface {
  std::uint32_t begin = 0, end = 0;                           ///< particles [begin, end)
  std::span<const std::array<std::uint32_t, 3>> triangles{};  ///< of particles, counted from `begin`
  std::span<const Edge> edges{};
  bool loose_particles = false;   ///< grains: every particle is a ball of its radius
  bool meets_itself = false;      ///< triangles and edges of this object against each other
  std::uint32_t groups = 1;       ///< two objects meet when a.groups & b.meets and b.groups & a.meets
  std::uint32_t meets = ~0u;      ///< are both non-zero
  std::span<const Vec3d> rest{};  ///< of its particles: features near at rest may stay as near
};

/// Surfaces against surfaces: a vertex against a triangle, an edge against an edge, of two objects or of one.
///
///   C = n . sum_k c_k p_k - d >= 0,   sum_k c_k = 0
///
/// c_k are the weights of the two nearest points (1 and minus barycentric for a vertex and a triangle), n the
/// unit vector between them and d the distance that thickness asks for. Both are found once a substep: where
/// the motion x -> p leads, or, when it would bring the two through each other, just before they touch
/// (continuous.h). So n always points to the side that the features came from. Corrections w_k c_k n keep
/// momentum. Friction, restitution and the slow release of an old overlap are those of ParticleContacts.
///
/// After the solver, `keep_apart` looks along the way of everything once more. Pairs that would pass through
/// each other all the same are pushed some more; where that does not settle it either (something is squeezed
/// between walls), ways are shortened: what was not tangled never becomes so.
///
/// Near pairs are found once per step from boxes swept by the velocities (near_pairs.h), those of one object
/// relative to its mean velocity; and again when a particle leaves its box.
class SurfaceContacts final : public Projector {
 public:
  SurfaceContacts() = default;

  /// What can touch, anew when objects came, went or changed. `surfaces` and `radius` as for
  /// ParticleContacts.
  void set_surfaces(std::vector<ContactSurface> surfaces);
  /// Pairs of particles that are tied together: features that have one each never touch.
  void exclude(std::vector<std::array<std::uint32_t, 2>> pairs);

  /// Whose tangles may pass; none: all are held. It must live as long as this is used.
  void set_untangling(const Untangling* untangling) { untangling_ = untangling; }

  void begin_step(const ParticleView& particles, std::span<const Vec4f> velocity,
                  std::span<const float> radius, const SurfaceMatrix& matrix, const ContactStep& step,
                  Threads& threads);
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
  int colour_count() const override { return static_cast<int>(colour_begin_.size()) - 1; }
  std::size_t colour_size(int colour) const override {
    const auto c = static_cast<std::size_t>(colour);
    return colour_begin_[c + 1] - colour_begin_[c];
  }
  std::size_t grain() const override { return 64; }
  using Projector::project;
  void project(int colour, std::size_t begin, std::size_t end, const ParticleView& particles,
               const Substep& substep) override;
  Residual residual(const ParticleView& particles) const override;
  void visit(const ParticleView& particles, const ConstraintVisitor& visitor) const override;
  std::size_t bytes() const override;
  void erase_particles(std::uint32_t begin, std::uint32_t end) override;

 private:
  /// Two features that may touch before pairs are looked for again.
  struct Candidate {
    std::uint32_t particle[4];
    float thickness;  // [m]
    float known;      // they were at least so far apart when the substep began [m]
  };
  struct Contact {
    std::uint32_t particle[4];
    float c[4];
    Vec3f normal;
    float thickness;
    float allowed;       // C may stay this negative: an old overlap leaves slowly [m]
    float inverse_mass;  // sum_k w_k c_k^2 [1/kg]
    SurfacePair surface;
    Vec3f predicted;    // motion of the first feature relative to the second before any projection [m]
    float pushed = 0;   // sum of normal corrections of the distance [m]
    Vec3f rubbed{};     // sum of tangential corrections of the distance [m]
    float bounced = 0;  // relative normal velocity added by apply_restitution [m/s]
    float depth = 0;    // what is left of the overlap of one that pushed [m]
  };
  /// A candidate whose particles must not go all their way.
  struct Cut {
    std::uint32_t candidate;
    float part;
  };
  /// What was found among some neighbouring candidates.
  struct Chunk {
    std::vector<Candidate> candidates;
    std::vector<Contact> contacts;
    std::vector<Cut> cuts;
  };
  using ParticlePairs = std::vector<std::array<std::uint32_t, 2>>;
  explicit SurfaceContacts(ParticlePairs excluded) : excluded_(std::move(excluded)) {}

  bool is_active(std::size_t surface) const;
  bool meet(std::size_t a, std::size_t b) const;
  bool is_excluded(const NearPair& pair, bool edges) const;
  void make_chunks(std::size_t count);
  void find_frames(const ParticleView& particles, std::span<const Vec4f> velocity);
  void find_boxes(const ParticleView& particles, std::span<const Vec4f> velocity, float dt, Threads& threads);
  void find_pairs(const ParticleView& particles, std::span<const Vec4f> velocity, float dt, Threads& threads);
  void find_again(const ParticleView& particles, float h, Threads& threads);
  void find_crossing();
  void add_candidates(std::span<const NearPair> pairs, bool edges, const ParticleView& particles,
                      Threads& threads);
  float thickness_of(const NearPair& pair, bool edges) const;
  bool left_boxes(const ParticleView& particles, Threads& threads);
  bool contact_of(Candidate& candidate, bool edges, const ParticleView& particles, float h,
                  Contact& contact) const;
  bool is_end(const Contact& contact) const;
  float safe_part(Candidate& candidate, bool edges, const ParticleView& particles) const;
  void find_cuts(const ParticleView& particles, Threads& threads);
  void push_cuts(const ParticleView& particles, float h);
  void shorten_ways(const ParticleView& particles);
  void colour_found(const ParticleView& particles);
  void project_one(Contact& contact, const ParticleView& particles) const;
  void restore_speed(Contact& contact, const ParticleView& particles, std::span<Vec4f> velocity,
                     float h) const;
  void forget_contacts();

  std::vector<ContactSurface> surfaces_;
  ParticlePairs excluded_;                 // both ways, sorted
  std::vector<std::uint32_t> surface_of_;  // of each particle; none where it has none
  SurfaceElements own_, crossing_;  // of those that meet themselves; of those that may meet another now
  std::vector<Bounds> surface_bounds_;
  std::vector<std::uint8_t> crosses_now_, crosses_;  // which those are
  ObjectMatrix own_matrix_, crossing_matrix_;
  bool any_pair_ = false;  // of surfaces that could meet

  const Untangling* untangling_ = nullptr;
  std::span<const float> radius_;
  const SurfaceMatrix* matrix_ = nullptr;
  ContactStep step_;
  float elapsed_ = 0;              // since pairs were found [s]
  float covered_ = 0;              // how long they were found for [s]
  float last_h_ = 0;               // [s]
  std::vector<Vec3f> frame_;       // mean velocity of each surface when pairs were found [m/s]
  std::vector<Bounds> boxes_;      // of particles, swept in the world
  std::vector<Bounds> own_boxes_;  // and relative to the frame of their surface
  std::vector<float> travel_;      // how far each may go relative to that frame [m]
  NearPairFinder own_finder_, crossing_finder_;
  NearPairs own_pairs_, crossing_pairs_;
  std::vector<Candidate> candidates_;  // vertices against triangles, then edges against edges
  std::size_t first_edges_ = 0;        // of candidates_
  std::vector<std::uint8_t> chunk_flags_;
  std::vector<Chunk> chunks_;
  std::vector<Vec4f> velocity_now_, before_;  // when pairs are found within a step
  std::vector<float> part_;                   // of each particle's way that is left to it in keep_apart
  std::vector<std::uint64_t> used_;           // of each particle: colours of its contacts
  std::vector<std::uint32_t> waiting_, colour_of_;
  std::vector<Cut> cuts_;
  std::vector<Contact> rescues_;           // what the solver left undone
  std::vector<Contact> found_, contacts_;  // in order of candidates; sorted by colour
  std::vector<std::uint32_t> colour_begin_{0}, next_place_;
};

}  // namespace souple
