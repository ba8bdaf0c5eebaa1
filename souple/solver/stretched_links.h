#pragma once

#include "souple/solver/hierarchical_levels.h"
#include "souple/solver/level_links.h"
#include "souple/solver/projector.h"
#include "souple/solver/threads.h"
#include "souple/solver/tied_particles.h"

#include <span>
#include <vector>

namespace souple {

/// More sweeps of the finest links where cloth that touches a collider is stretched. At a box's corner, or along the
/// line where cloth leaves a ball, stress changes from one link to the next. Levels do not see that, and one sweep
/// leaves such links stretched by tens of percent.
///
/// The sweeps alternate with the contacts of their particles: without, the cloth is pulled into the collider and
/// pushed back, and nothing is gained. They shorten links to half a percent above rest at least, and lengthen none.
/// So a link that begins to be stretched is corrected gently; with rest length itself as the goal, cloth trembles.
///
/// Particles that touch cloth, fluids or other bodies take no part: the sweeps would pull layers into each other. Nor
/// do tied or attached ones. There are no sweeps while old overlaps with colliders are removed or a link is torn: a
/// collider that jumps into a sheet would throw it.
///
/// Which links are swept depends on the state of the substep alone.
class StretchedLinks {
 public:
  /// Finds the links that are stretched now and sweeps those around them, if anything touches a collider.
  /// `links`: of the finest level, always the same; ends are the world's particles.
  void sweep(std::span<const Link> links, const TiedParticles& tied, std::span<Projector* const> projectors,
             const ParticleView& particles, const Substep& substep, Threads& threads);

 private:
  /// A particle at the other end of a link.
  struct Neighbor {
    std::uint32_t particle, link;
  };

  void build(std::span<const Link> links, const TiedParticles& tied, const ParticleView& particles);
  bool find_stretched(const ParticleView& particles, Threads& threads);
  bool choose_particles(float h2);
  void bar(std::span<Projector* const> projectors, const ParticleView& particles);
  void choose(std::uint32_t particle);
  void gather_links(const ParticleView& particles, float h2);
  void append(std::uint32_t link, const ParticleView& particles, float h2);
  void find_contacts(std::span<Projector* const> projectors);
  void project_contacts(std::span<Projector* const> projectors, const ParticleView& particles,
                        const Substep& substep, bool again) const;
  void load(const ParticleView& particles);
  void store(const ParticleView& particles) const;

  std::vector<Link> links_;           ///< color after color
  std::vector<float> inverse_mass_;   ///< per link: sum of its ends' [1/kg]
  std::vector<std::uint32_t> color_;  ///< per link
  std::vector<Neighbor> neighbors_;   ///< of particle i: from neighbors_begin_[i] to neighbors_begin_[i + 1]
  std::vector<std::uint32_t> neighbors_begin_;
  // Of the current substep:
  std::vector<std::uint8_t> stretched_;  ///< per link
  std::vector<std::uint8_t> barred_;     ///< per particle of the world: takes no part
  std::vector<std::uint32_t> chosen_;    ///< particles at most `radius` links from a stretched link
  std::vector<std::uint32_t> number_;    ///< per particle of the world: index in chosen_, or unchosen
  std::vector<std::vector<std::uint32_t>> chosen_links_;  ///< per color: links between chosen particles
  std::vector<std::vector<std::uint32_t>> contacts_;      ///< per projector: its contacts of chosen particles
  std::vector<Vec4f> moving_;  ///< per chosen particle, and a fixed one: displacement [m]; w = inverse mass
  LevelLinks swept_;           ///< the chosen links, between indices in chosen_
};

}  // namespace souple
