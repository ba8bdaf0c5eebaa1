#pragma once

#include "souple/fluid/emitter.h"

#include <cstdint>

namespace souple {

/// An emitter of a world.
struct EmitterRecord {
  EmitterId id;
  std::uint32_t fluid = 0;  ///< object id
  Emitter emitter;
  std::uint64_t layers = 0;  ///< number of layers that were added or held back
  bool stalled = false;      ///< during this step: the pressure is too high
};

/// A drain of a world.
struct DrainRecord {
  DrainId id;
  Drain drain;
  double credit = 0;  ///< particles that the drain may remove
};

}  // namespace souple
