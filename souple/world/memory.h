#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace souple {

/// Heap memory of a world by purpose. Among colliders only signed distance fields are counted; a field that several
/// colliders share counts once for each. Keyframes and users' callbacks are not counted.
struct MemoryReport {
  struct Part {
    std::string name;  ///< "particles", "distance", ...
    std::size_t bytes = 0;
  };
  std::vector<Part> simulation;  ///< data that steps read and write: particles, constraints, contacts
  std::vector<Part> objects;     ///< data of objects and of users' views: meshes, maps, mirrors
  std::size_t particles = 0;     ///< number of particles

  static std::size_t total(const std::vector<Part>& parts) {
    std::size_t sum = 0;
    for (const Part& part : parts) sum += part.bytes;
    return sum;
  }
};

}  // namespace souple
