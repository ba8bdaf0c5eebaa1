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
  Form form;

  ParticleView view() const {
    return {particles.position, form == Form::plain ? particles.position : particles.offset, particles.start,
            form};
  }
  /// The array that prediction and solver move: `position` in the plain form, `offset` in the displacement form.
  std::vector<Vec4f>& moving() const { return form == Form::plain ? particles.position : particles.offset; }
  /// Position of a particle, including the part beyond float precision [m].
  Vec3d exact_position(std::size_t i) const {
    return Vec3d(particles.position[i].xyz()) + Vec3d(particles.offset[i].xyz());
  }
};

}  // namespace souple
