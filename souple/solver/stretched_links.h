#pragma once

#include "souple/solver/hierarchical_levels.h"
#include "souple/solver/level_links.h"
#include "souple/solver/projector.h"
#include "souple/solver/threads.h"
#include "souple/solver/tied_particles.h"

#include <span>
#include <vector>

namespace souple {

/// More sweeps of the finest links that levels and one sweep of all constraints leave stretched. On a box's corner, where
/// cloth leaves a ball, at a short edge of an irregular mesh or in a gust, stress changes from one link to the next.
/// Levels do not see that, and one sweep leaves such links stretched by tens of percent.
///
/// The sweeps shorten links to the strain above which they count as stretched, and lengthen none. A link that begins to
/// be stretched is thus corrected gently; with a lower goal, cloth trembles. Contacts with colliders are projected
/// between the sweeps: without, the cloth is pulled into the collider and pushed back, and nothing is gained.
///
/// Around isolated pins a stiff cloth does stretch, and levels sweep more there: links near them do not count.
///
/// Particles that touch cloth, fluids or other bodies take no part: the sweeps would pull layers into each other. Nor
/// do tied or attached ones. There are no sweeps while old overlaps with colliders are removed or a link is torn: a
/// collider that jumps into a sheet would throw it.
///
/// Which links are swept depends on the state of the substep alone.
class StretchedLinks {
 public:
  /// Finds the links that are stretched now and sweeps those around them.
  /// `links`: of the finest level, always the same; ends are the world's particles.
  void sweep(std::span<const Link> links, const TiedParticles& tied, std::span<Projector* const> projectors,
             const ParticleView& particles, const Substep& substep, Threads& threads);

 private:
  /// A particle at the other end of a link.
  struct Neighbor {
    std::uint32_t particle, link;
  };

  void set_counted(std::span<const Link> of_level, const TiedParticles& tied, const ParticleView& particles);
  void build(std::span<const Link> links, const TiedParticles& tied, const ParticleView& particles);
  bool find_stretched(std::span<const Link> links, const ParticleView& particles, Threads& threads);
  bool choose_particles(std::span<const Link> of_level, float h2);
  void bar(std::span<Projector* const> projectors, const ParticleView& particles);
  void choose(std::uint32_t particle);
  void gather_links(const ParticleView& particles, float h2, float n);
  void append(std::uint32_t link, const ParticleView& particles, float h2, float n);
  void find_contacts(std::span<Projector* const> projectors);
  void project_contacts(std::span<Projector* const> projectors, const ParticleView& particles,
                        const Substep& substep, bool again) const;
  void load(const ParticleView& particles);
  void store(const ParticleView& particles) const;

  /// Per link of the level: sum of its ends' inverse masses [1/kg]; 0: does not count as stretched.
  std::vector<float> counted_;
  std::vector<Link> links_;           ///< color after color
  std::vector<float> inverse_mass_;   ///< per link: sum of its ends' [1/kg]
  std::vector<std::uint32_t> color_;  ///< per link
  std::vector<Neighbor> neighbors_;   ///< of particle i: from neighbors_begin_[i] to neighbors_begin_[i + 1]
  std::vector<std::uint32_t> neighbors_begin_;
  // Of the current substep:
  std::vector<std::uint8_t> stretched_;  ///< per link of the level
  std::vector<std::uint8_t> barred_;     ///< per particle of the world: takes no part
  std::vector<std::uint32_t> chosen_;    ///< particles at most `radius` links from a stretched link
  std::vector<std::uint32_t> number_;    ///< per particle of the world: index in chosen_, or unchosen
  std::vector<std::vector<std::uint32_t>> chosen_links_;  ///< per color: links between chosen particles
  std::vector<std::vector<std::uint32_t>> contacts_;      ///< per projector: its contacts of chosen particles
  std::vector<Vec4f> moving_;  ///< per chosen particle, and a fixed one: displacement [m]; w = inverse mass
  LevelLinks swept_;           ///< the chosen links, between indices in chosen_
};

}  // namespace souple
