#pragma once

#include "souple/host/action_queue.h"
#include "souple/host/grab.h"
#include "souple/host/session.h"

#include <deque>
#include <memory>
#include <mutex>

namespace souple::host {

class Contents;
struct Item;

/// Statistics of the last step and of the current world.
Statistics statistics_of(const World& world, std::uint64_t steps);

struct Session::Impl {
  explicit Impl(const ClockOptions& options);
  ~Impl();

  Handle add(Kind kind, const TriangleSoup& soup, const MeshOptions& options);
  /// Returns false if the step failed: the reason is reported, and the session is paused.
  bool step(double dt);
  /// Releases references to the previous world after a rebuild.
  void begin_again();
  void report(std::string message);
  void report_lines(const std::string& lines);  ///< one message per line
  void take_statistics();
  bool take_hold(const Item& item, std::uint32_t vertex, const Vec3f& point, const Ray& ray,
                 const Vec3f& facing);
  /// The world object's vertex for a render vertex. Throws Error if there is none.
  static std::uint32_t world_vertex(const Item& item, const World& world, std::uint32_t vertex);

  std::unique_ptr<Contents> contents;
  Clock clock;
  ActionQueue<Session> actions;
  std::optional<Grab> hand;
  std::optional<DragPlane> plane;
  bool playing = true, step_requested = false;
  std::uint64_t steps = 0;
  std::uint32_t flags_before = 0;    // flags of the last step: a persisting warning is reported once
  std::uint64_t version_before = 0;  // sum over previous worlds

  mutable std::mutex mutex;  // guards the two members below
  std::deque<std::string> messages;
  Statistics statistics;
};

}  // namespace souple::host
