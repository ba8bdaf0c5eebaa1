#pragma once

#include "souple/collision/segment_triangle/segment_triangle.h"
#include "souple/state/particles.h"

#include <cstdint>
#include <memory>
#include <span>

namespace souple {

struct Caches;
struct ColliderRecord;
struct Object;
class Threads;

/// Data that queries read. Several threads may query one view at a time.
struct QueryView {
  const Particles& particles;
  std::span<const std::unique_ptr<Object>> objects;  ///< ascending by id
  std::span<const ColliderRecord> colliders;         ///< ascending by id
  double time;                                       ///< of the colliders [s]
  std::uint64_t version;                             ///< increases whenever positions may have changed
  const CrossingTest& crossing_test;                 ///< of rays against triangles
  Threads* threads;                                  ///< null: the caller's alone
  Caches& caches;
};

}  // namespace souple
