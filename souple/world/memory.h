#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace souple {

/// What a world holds on the heap, by what it is for. Of colliders only signed distance fields are
/// counted, one that several share as often; keyframes and the users' own callbacks are not.
struct MemoryReport {
  struct Part {
    std::string name;  ///< "particles", "distance", ...
    std::size_t bytes = 0;
  };
  std::vector<Part> simulation;  ///< what steps read and write: particles, constraints, contacts
  std::vector<Part> objects;     ///< what objects are made of and what users see: meshes, maps, mirrors
  std::size_t particles = 0;     ///< how many there are

  static std::size_t total(const std::vector<Part>& parts) {
    std::size_t sum = 0;
    for (const Part& part : parts) sum += part.bytes;
    return sum;
  }
};

}  // namespace souple
