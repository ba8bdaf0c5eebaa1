#pragma once

#include "souple/math/lists.h"
#include "souple/multilevel/hierarchical_levels.h"
#include "souple/multilevel/pieces.h"
#include "souple/multilevel/tied_particles.h"
#include "souple/solver/kernels/links.h"
#include "souple/solver/projector.h"
#include "souple/threads/threads.h"

#include <span>
#include <vector>

namespace souple {

/// More sweeps of the finest links that levels and one sweep of all constraints leave stretched. Stress may change from
/// one link to the next: on a box's corner, at a ball's rim, at a mesh's short edge, in a gust. Levels do not see that,
/// and one sweep leaves such links stretched by tens of percent.
///
/// The sweeps shorten links to the strain above which they count as stretched. A link that begins to be stretched is thus
/// corrected gently; with a lower goal, cloth trembles. Contacts with colliders are projected
/// between the sweeps: without, the cloth is pulled into the collider and pushed back, and nothing is gained.
///
/// Particles that touch cloth, fluids or other bodies take no part: the sweeps would pull layers into each other. Nor
/// do tied or attached ones. A piece is not swept while its old overlaps with colliders are removed or one of its links is
/// torn. Otherwise a collider that jumps into a sheet would throw it.
///
/// Which links are swept depends on the state of the substep and of their piece alone.
class StretchedLinks {
 public:
  /// After the stiffness of the links changed and nothing else about them.
  void take_stiffness(std::span<const Link> links);
  /// Finds the links that are stretched now and sweeps those around them.
  /// `links`: of the finest level, always the same; ends are the world's particles. `pieces`: theirs.
  void sweep(std::span<const Link> links, const TiedParticles& tied, const ActivePieces& pieces,
             std::span<Projector* const> projectors, const ParticleView& particles, const Substep& substep,
             Threads& threads);

 private:
  /// A particle at the other end of a link, and the place of the link in links_.
  struct Neighbor {
    std::uint32_t particle, link;
  };
  /// Rounds of sweeps, each followed by the contacts. A link is lengthened to no more than `shortest_part` of the length it
  /// is shortened to.
  struct Rounds {
    int count, sweeps;
    int radius;  ///< links from a stretched link to the farthest chosen particles
    float shortest_part;
  };
  static const Rounds with_contacts, without_contacts;
  /// A link that sweeps can correct.
  struct Swept {
    std::uint32_t a, b;  ///< 4 times the end
    float longest;       ///< the length it is shortened to [m]
    float compliance;    ///< [m/N]
    float inverse_mass;  ///< sum of its ends' [1/kg]
    std::uint32_t link;  ///< its place among the links of the level
  };
  /// The chosen links as kernels take them, color after color, each color padded to whole registers.
  struct Region {
    std::vector<std::uint32_t> a, b;
    std::vector<float> longest, compliance, inverse_mass;
    std::vector<float> x, y, z, min_length, max_length, gain;
    std::vector<std::size_t> color_begin;

    std::size_t size() const { return color_begin.back(); }
    void resize(std::size_t slots);
    void set(std::size_t slot, const Swept& link);
    kernels::LinkArrays arrays();
  };

  void prepare_search(std::span<const Link> of_level);
  void build(std::span<const Link> of_level, const TiedParticles& tied, const ParticleView& particles);
  void stop_overlapping(std::span<Projector* const> projectors);
  bool find_stretched(std::span<const Link> of_level, const ParticleView& particles, Threads& threads);
  void leave_out_stopped(std::span<const Link> of_level);
  bool is_torn(const Link& link, const ParticleView& particles) const;
  void bar(std::span<Projector* const> projectors, const ParticleView& particles);
  void choose(std::uint32_t particle);
  template <class Chooses>
  bool choose_particles(std::span<const Link> of_level, float h2, int radius, const Chooses& chooses);
  void sweep_pieces(std::span<const Link> of_level, bool touching, std::span<Projector* const> projectors,
                    const ParticleView& particles, const Substep& substep, Threads& threads);
  void mark_links();
  void gather_links();
  void measure_links(const Rounds& rounds, float h, Threads& threads);
  ParticleView load(const ParticleView& particles, bool all);
  void store(const ParticleView& particles) const;

  // Per link of the level, in blocks of 16: ends, and the length above which the link is stretched.
  std::vector<std::uint32_t> search_a_, search_b_;
  std::vector<float> search_longest_;
  std::vector<float> counted_;  ///< sum of the ends' inverse masses [1/kg]; 0: does not count as stretched
  std::vector<Swept> links_;    ///< color after color
  std::vector<std::size_t> color_begin_;  ///< in links_
  Lists<Neighbor> neighbors_;             ///< of each particle
  // Data of the current substep:
  std::vector<std::uint16_t> stretched_;  ///< per block of links of the level: a bit for each
  std::vector<std::uint32_t> found_;      ///< stretched links of the level
  std::vector<std::uint8_t> barred_;      ///< per particle of the world: takes no part
  std::vector<std::uint32_t> chosen_;     ///< particles near stretched links
  std::vector<std::uint32_t> number_;     ///< per particle of the world: index in chosen_, or unchosen
  std::vector<std::uint64_t> marked_;     ///< a bit per entry of links_: between chosen particles
  ActivePieces pieces_;                   ///< those that are swept
  std::vector<std::uint32_t> touched_;    ///< particles whose contacts with colliders are projected too
  std::vector<std::uint8_t> touches_;     ///< per piece: it has such particles
  Region region_;
  /// Per particle of the world, and a fixed one, those of chosen particles: moving_.w = inverse mass.
  std::vector<Vec4f> position_, moving_;
};

}  // namespace souple
