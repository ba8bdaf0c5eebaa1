#pragma once

#include "souple/solver/projector.h"
#include "souple/state/particles.h"

#include <cstdint>
#include <memory>
#include <span>

namespace souple {

struct Object;

/// The objects of a world and their particles, as the stages of a step see them.
struct ObjectsView {
  Particles& particles;
  std::span<const std::unique_ptr<Object>> objects;  ///< ascending by id
  std::span<const std::uint32_t> object_of;          ///< per particle: index into `objects`

  ParticleView view() const { return {particles.position, particles.offset, particles.start}; }
};

}  // namespace souple
