#pragma once

#include "souple/rigid/body_matrix.h"
#include "souple/rigid/contact_block.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace souple {

/// Newton's method for all contacts of an island at once, in place of the many sweeps that a stack needs: a sweep passes
/// a force on from body to body, and errors of a tower's tilt shrink by a part of 1 / bodies^4.
///
/// With the rows that push as equations, impulses p and motions q satisfy
///   J q + softness p = -gap,   q = M^-1 J^T p.
/// Without p that is (M + J^T J / softness) dq = -J^T residual / softness: one block of 6 x 6 for each pair that touches.
class ContactNewton {
 public:
  /// The contacts of an island are blocks[i] for i in `island`. `local`: per body, scratch memory.
  void prepare(std::span<const ContactBlock> blocks, std::span<const std::uint32_t> island,
               std::span<std::uint32_t> local);
  /// Multiplications of a step, approximately; infinite if the island is too large.
  double cost() const { return cost_; }
  /// One step, shortened until the energy falls. Else restores what was, and returns false.
  bool step(std::span<ContactBlock> blocks, std::span<const std::uint32_t> island,
            std::span<const std::uint32_t> local, std::span<ContactBody> states);
  std::size_t bytes() const;

 private:
  /// What a row's impulse was, and the step's change of it.
  struct Change {
    ContactVector before{}, step{};
  };

  void assemble(std::span<const ContactBlock> blocks, std::span<const std::uint32_t> island,
                std::span<const std::uint32_t> local, std::span<const ContactBody> states);
  void add_row(const ContactBlock& block, const ContactRow& row, std::span<const std::uint32_t> local,
               std::span<const ContactBody> states);
  void find_changes(std::span<const ContactBlock> blocks, std::span<const std::uint32_t> island,
                    std::span<const std::uint32_t> local, std::span<const ContactBody> states);
  double apply(double part, std::span<ContactBlock> blocks, std::span<const std::uint32_t> island,
               std::span<ContactBody> states) const;

  std::vector<std::uint32_t> bodies_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs_, last_pairs_;
  std::size_t last_bodies_ = 0;
  double cost_ = 0;
  BodyMatrix matrix_;
  std::vector<Mat3d> inertia_;   // per body
  std::vector<double> motion_;   // six numbers a body
  std::vector<Change> changes_;  // four a contact
};

}  // namespace souple
