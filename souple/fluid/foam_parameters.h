#pragma once

#include <cstddef>
#include <cstdint>

namespace souple {

/// Kind of a foam particle, by the number of fluid particles around it.
enum class FoamKind : std::uint8_t { spray, foam, bubble };

/// A ramp: 0 below `low`, 1 above `high`.
struct FoamRange {
  float low = 0, high = 1;
  friend bool operator==(const FoamRange&, const FoamRange&) = default;
};

/// Parameters of spray, foam and bubbles; foam.h has the formulas.
struct FoamParameters {
  std::size_t max_particles = 100000;  ///< limit of all foam particles; new ones beyond it are thinned evenly
  float trapped_air_rate = 2000;       ///< largest emission of a fluid particle by trapped air [1/s]
  float wave_crest_rate = 2000;        ///< largest emission of a fluid particle at wave crests [1/s]
  FoamRange trapped_air{7, 25};        ///< ramp over the closing speed, summed over neighbors [m/s]
  FoamRange wave_crest{2, 8};  ///< ramp over 1 - cos of the angle between normals, summed over neighbors [-]
  FoamRange energy{0.3f, 4};   ///< ramp over v^2 / 2 [m^2/s^2]: speeds of 0.8 to 2.8 m/s
  FoamRange life{0.5f, 2.5f};  ///< life of foam from the weakest and the strongest emission [s]
  float longest_life = 5;      ///< longest life of any kind, spray and bubbles included [s]
  float buoyancy = 2;          ///< upward acceleration of bubbles, over gravity
  float drag = 60;             ///< rate at which bubbles adopt the fluid's velocity [1/s]
  int spray_neighbors = 6;     ///< with fewer fluid particles around: spray
  int bubble_neighbors = 20;   ///< with more fluid particles around: bubble
  friend bool operator==(const FoamParameters&, const FoamParameters&) = default;
};

}  // namespace souple
