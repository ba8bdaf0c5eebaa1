#pragma once

#include "souple/broad_phase/object_pairs.h"
#include "souple/rigid/rigid_contact.h"
#include "souple/rigid/rigid_shape.h"
#include "souple/threads/threads.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

namespace souple {

class SavedBytes;
class SavedBytesWriter;

/// Materials of contacts, and which bodies may collide.
class RigidMaterials {
 public:
  virtual ~RigidMaterials() = default;
  virtual bool collide(std::uint32_t a, std::uint32_t b) const = 0;
  virtual ContactMaterialPair at(std::uint32_t a, std::uint32_t b) const = 0;
};

/// Finds the contacts of rigid bodies once a step, and those of fast bodies in each substep. A contact that was there in
/// the last step keeps its impulses and the anchors of its friction.
class ContactFinder {
 public:
  /// `shapes`: per body. `dt`: length of the step [s]; `part`: length of a substep relative to it; `gravity`: its
  /// magnitude [m/s^2].
  void begin_step(const RigidBodies& bodies, std::span<const RigidShape> shapes,
                  const RigidMaterials& materials, double dt, double part, double gravity, Threads& threads);
  /// Call at the start of a substep. Finds again the contacts of pairs that move far within a step.
  void refresh(const RigidBodies& bodies, std::span<const RigidShape> shapes, Threads& threads);
  /// Contacts, in an order that depends on the bodies alone.
  std::span<RigidContact> contacts() { return contacts_; }
  std::span<const RigidContact> contacts() const { return contacts_; }
  /// The state that one step passes to the next.
  struct Saved;
  void save(SavedBytesWriter& out) const;
  /// Reads a saved state. Throws Error if it is none of contacts of so many bodies.
  static Saved read(SavedBytes& in, std::size_t bodies);
  void set(Saved saved);
  /// Forgets all contacts.
  void clear();
  std::size_t bytes() const;

 private:
  /// Two parts whose boxes overlap.
  struct Pair {
    std::uint32_t a = 0, part_a = 0, b = 0, part_b = 0;
    std::uint32_t manifold = 0;  ///< index, if the pair has several (signed distance fields, meshes)
    bool fast = false;           ///< moves far in a step
    double moved = 0;            ///< upper limit of the relative motion since the last search [m]
    double clear = 0;            ///< least distance at the last search [m]
    AxisCache axis{};
    auto key() const { return std::tuple(a, b, part_a, part_b, manifold); }
  };
  void find_pairs(const RigidBodies& bodies, std::span<const RigidShape> shapes,
                  const RigidMaterials& materials, double dt, double gravity);
  double relative_motion(const Pair& pair, const RigidBodies& bodies) const;
  PairMotion motion_ahead(const Pair& pair, const RigidBodies& bodies) const;
  void append_pairs(std::uint32_t a, std::uint32_t b, std::span<const RigidShape> shapes);
  void take_over(std::size_t pair);
  template <class AnyPair, class AnyContact, class Function>
  static void for_each_field(AnyPair& pair, AnyContact& contact, const Function& f);
  double margin_of(const Pair& pair) const;
  void search(std::size_t pair, const RigidBodies& bodies, std::span<const RigidShape> shapes);
  void find_contact(std::size_t pair, const RigidBodies& bodies, std::span<const RigidShape> shapes,
                    double margin, double reach);

  BoxSweep sweep_;
  std::vector<Bounds> boxes_;   // per body, of its motion in the step
  std::vector<double> motion_;  // per body: largest path of its points in the step [m]
  std::vector<double> inner_;   // per body: inner radius [m]
  std::vector<double> turn_;    // per body: path of its points by its spin in the step [m]
  double dt_ = 0;               // of the step [s]
  double part_ = 1;             // of a step that a substep is
  std::vector<Pair> pairs_, last_pairs_;
  std::vector<RigidContact> contacts_, last_contacts_;  // one per pair
};

struct ContactFinder::Saved {
  std::vector<Pair> pairs;
  std::vector<RigidContact> contacts;  ///< one per pair
};

}  // namespace souple
