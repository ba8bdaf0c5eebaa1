#pragma once

#include "souple/contacts/contact.h"
#include "souple/queries/query.h"

#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

namespace souple {

struct WorldState;

/// Pairs of bodies in contact from step to step: World::contact_pairs.
class ContactTracker {
 public:
  void track(bool on) { tracks_ = on; }
  /// After a substep: notes the contacts that pushed.
  void end_substep(WorldState& world);
  /// After a step: compares with the pairs of the step before, which a failed step keeps.
  void end_step(WorldState& world, bool valid);
  std::span<const ContactPair> pairs() const { return pairs_; }

 private:
  /// Bodies of a pair, in the order of the result.
  struct Key {
    std::uint32_t object = 0;
    bool is_collider = false;
    std::uint32_t other = 0;
    friend bool operator==(const Key&, const Key&) = default;
    friend bool operator<(const Key& a, const Key& b) {
      return std::tie(a.object, a.is_collider, a.other) < std::tie(b.object, b.is_collider, b.other);
    }
  };
  struct Touch {
    Key key;
    std::uint32_t order = 0;  ///< of the contact in the step, which sums follow
    bool is_sensor = false;
    float impulse = 0, largest = 0;  ///< N s
    Vec3f point{}, normal{};         ///< of the largest impulse

    void absorb(const Touch& other) {
      impulse += other.impulse;
      if (other.largest > largest) largest = other.largest, point = other.point, normal = other.normal;
    }
  };

  void add_pushes(const WorldState& world);
  void add(const Touch& touch);
  void add_sensors(const WorldState& world);
  void keep_sleepers(const WorldState& world);
  void merge();
  void compare_with_last();

  bool tracks_ = false;
  std::vector<ContactPush> pushes_;
  std::vector<Touch> touching_,
      last_;  // of this step and the one before; between substeps sorted, one for each pair
  std::vector<ContactPair> pairs_;
};

}  // namespace souple
