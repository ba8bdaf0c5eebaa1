#pragma once

#include "souple/host/action_queue.h"
#include "souple/host/grab.h"
#include "souple/host/session.h"
#include "souple/host/session/contents.h"

#include <deque>
#include <mutex>

namespace souple::host {

/// Of the last step, and what there is now.
Statistics statistics_of(const World& world, std::uint64_t steps);

struct Session::Impl {
  explicit Impl(const ClockOptions& options) : clock(options) {}

  Handle add(Kind kind, const TriangleSoup& soup, const MeshOptions& options);
  /// False when the world could not do it: then it has said why, and is paused.
  bool step(double dt);
  /// The world was made anew: what held on to the old one lets go.
  void begin_again();
  void tell(std::string message);
  void tell_lines(const std::string& lines);  ///< each as a message of its own
  void take_statistics();
  bool take_hold(const Item& item, std::uint32_t vertex, const Vec3f& point, const Ray& ray,
                 const Vec3f& facing);
  /// The vertex of the world's object that a render vertex shows. Throws Error when there is none.
  static std::uint32_t world_vertex(const Item& item, const World& world, std::uint32_t vertex);

  Contents contents{[this](std::string message) { tell(std::move(message)); }};
  Clock clock;
  ActionQueue<Session> actions;
  std::optional<Grab> hand;
  std::optional<DragPlane> plane;
  bool playing = true, step_requested = false;
  std::uint64_t steps = 0;
  std::uint32_t flags_before = 0;    // of the last step: a warning is told once, not in each step that has it
  std::uint64_t version_before = 0;  // of the worlds that are gone

  mutable std::mutex mutex;  // of the two below
  std::deque<std::string> messages;
  Statistics statistics;
};

}  // namespace souple::host
