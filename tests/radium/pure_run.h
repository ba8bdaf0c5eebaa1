#pragma once

#include <cstdint>
#include <string>

namespace souple::radium {

/// World::hash of a scene file after some steps of dt [s], without the host layer and without Radium.
std::uint64_t hash_of_pure_run(const std::string& file, int frames, double dt);

}  // namespace souple::radium
