#pragma once

#include <cstddef>
#include <cstdint>

namespace souple {

/// By how much fluid is around a foam particle.
enum class FoamKind : std::uint8_t { spray, foam, bubble };

/// What is below the first counts nothing, what is above the second counts in full.
struct FoamRange {
  float low = 0, high = 1;
  friend bool operator==(const FoamRange&, const FoamRange&) = default;
};

/// How fluids foam; see foam.h for the letters.
struct FoamParameters {
  std::size_t max_particles = 100000;  ///< particles; above, what is new is thinned out
  float trapped_air_rate = 2000;       ///< particles a fluid's particle makes at most, by trapping air [1/s]
  float wave_crest_rate = 2000;        ///< and at a wave's crest [1/s]
  FoamRange trapped_air{7, 25};        ///< sum over neighbors of how fast they come closer [m/s]
  FoamRange wave_crest{2, 8};          ///< sum over neighbors of 1 - cos of the angle between normals [-]
  FoamRange energy{0.3f, 4};           ///< v^2 / 2 [m^2/s^2]: speeds of 0.8 to 2.8 m/s
  FoamRange life{0.5f, 2.5f};          ///< of foam: of what little made it, and of what much did [s]
  float longest_life = 5;              ///< of spray and bubbles too [s]
  float buoyancy = 2;                  ///< of bubbles, over gravity
  float drag = 60;                     ///< of bubbles: how quickly they take the fluid's velocity [1/s]
  int spray_neighbors = 6;             ///< fewer fluid particles than these around: spray
  int bubble_neighbors = 20;           ///< more than these: a bubble
  friend bool operator==(const FoamParameters&, const FoamParameters&) = default;
};

}  // namespace souple
