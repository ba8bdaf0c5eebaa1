#pragma once

#include "souple/queries/mirror.h"
#include "souple/queries/query_index.h"

#include <cstdint>
#include <map>
#include <mutex>

namespace souple {

/// Results that const functions of a world compute on demand, holding the lock. They hold the lock meanwhile.
struct Caches {
  std::map<std::uint32_t, Mirror> mirrors;  ///< by object id
  QueryIndex query_index;
  std::mutex lock;  ///< also of ContactState::events
};

}  // namespace souple
