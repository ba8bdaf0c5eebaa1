#pragma once

#include "souple/broad_phase/contact_surface.h"
#include "souple/broad_phase/near_pair.h"
#include "souple/math/vec4.h"

#include <cstdint>
#include <span>
#include <vector>

namespace souple {

inline constexpr std::uint32_t no_surface = ~0u;

/// The surfaces whose elements may come into contact, and what does not change while they exist.
class ElementSurfaces {
 public:
  ElementSurfaces() = default;
  /// `joined`: elements with a particle each of such a pair get no contact.
  ElementSurfaces(std::vector<ContactSurface> surfaces, ParticlePairs joined);
  /// Sets the end of a surface that consists of particles alone: at most its reserved_end.
  void set_end(std::size_t surface, std::uint32_t end);

  /// Whether any surface may collide with another one or with itself.
  bool any() const { return any_; }
  std::size_t size() const { return surfaces_.size(); }
  const ContactSurface& operator[](std::size_t index) const { return surfaces_[index]; }
  bool collides_with_other(std::uint32_t a, std::uint32_t b) const {
    return a != b && may_collide(surfaces_, a, b);
  }
  std::size_t particle_count() const { return surface_of_.size(); }
  /// The surface of a particle, or no_surface.
  std::uint32_t of(std::uint32_t particle) const { return surface_of_[particle]; }
  /// Mean length of a surface's edges, or sides of its triangles, at rest [m]; 0 if it has none.
  float mean_edge(std::size_t surface) const { return mean_edge_[surface]; }
  bool are_joined(const NearPair& pair, bool edges) const;
  /// Whether a particle is joined to any of another surface.
  bool is_joined_to(std::uint32_t particle, std::uint32_t surface) const;
  /// Limits the thickness of pairs of one surface: contacts keep them no farther apart than at rest.
  void limit_to_rest_distance(std::span<const NearPair> pairs, bool edges, float* thickness) const;
  /// Calls f(particle) for evenly spaced particles of a surface, which stand for all of them in a mean.
  template <class Function>
  void for_each_sample(std::size_t surface, const Function& f) const {
    constexpr std::uint32_t max_samples = 512;
    const ContactSurface& one = surfaces_[surface];
    const std::uint32_t stride = (one.end - one.begin) / max_samples + 1;
    for (std::uint32_t i = one.begin; i < one.end; i += stride) f(i);
  }
  std::size_t bytes() const;

 private:
  static constexpr std::size_t rest_batch = 128;  // pairs that one call of a kernel limits

  void limit_some_to_rest_distance(std::span<const NearPair> pairs, bool edges, float* thickness) const;

  std::vector<ContactSurface> surfaces_;
  ParticlePairs joined_;
  std::vector<std::uint32_t> surface_of_;  // per particle: its surface, or no_surface
  std::vector<Vec4f> rest_;          // per particle: rest position relative to its surface's first one [m]
  std::vector<float> longest_edge_;  // per surface: longest edge at rest [m]
  std::vector<float> mean_edge_;     // per surface [m]
  bool any_ = false;
};

}  // namespace souple
