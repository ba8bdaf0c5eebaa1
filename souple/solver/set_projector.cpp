#include "souple/solver/set_projector.h"

#include <fmt/core.h>

namespace souple::detail {

void throw_missing_particle(std::string_view kind, std::size_t constraint, std::uint32_t particle,
                            std::size_t particle_count) {
  throw Error(
      fmt::format("{} {} names particle {}, but there are {}", kind, constraint, particle, particle_count));
}

}  // namespace souple::detail
