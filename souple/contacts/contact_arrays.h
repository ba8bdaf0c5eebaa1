#pragma once

#include "souple/assert.h"
#include "souple/broad_phase/spatial_hash.h"
#include "souple/contacts/kernels/element_pairs.h"

#include <array>
#include <cstdint>
#include <vector>

namespace souple {

/// Contacts as columns (structure of arrays), the layout that kernels read and write.
class ContactArrays {
 public:
  /// Part of the size that is reserved beyond it: the number of contacts changes fast.
  static constexpr double spare = 1;
  std::size_t size() const { return particle_[0].size(); }
  /// Existing contacts keep their values. A size that was reached before allocates nothing.
  void resize(std::size_t size) {
    for (auto& column : particle_) resize_with_spare(column, size, spare);
    for (auto& column : floats_) resize_with_spare(column, size, spare);
  }
  kernels::ContactColumns columns() {
    kernels::ContactColumns result;
    for (std::size_t k = 0; k < 4; ++k) result.particle[k] = particle_[k].data();
    std::size_t next = 0;
    const auto column = [&] { return floats_[next++].data(); };
    for (float*& c : result.c) c = column();
    for (float*& n : result.normal) n = column();
    result.thickness = column();
    result.slop = column();
    result.inverse_mass = column();
    result.approach = column();
    result.static_friction = column();
    result.kinetic_friction = column();
    result.restitution = column();
    result.normal_sum = column();
    for (float*& tangent_sum : result.tangent_sum) tangent_sum = column();
    result.restitution_velocity = column();
    result.depth = column();
    result.share = column();
    result.rolling_friction = column();
    for (float*& moment_sum : result.moment_sum) moment_sum = column();
    SOUPLE_ASSERT(next == floats_.size(), "one array per column");
    return result;
  }
  std::size_t bytes() const {
    std::size_t sum = 0;
    for (const auto& column : particle_) sum += column.capacity() * sizeof(column[0]);
    for (const auto& column : floats_) sum += column.capacity() * sizeof(column[0]);
    return sum;
  }

 private:
  std::array<std::vector<std::uint32_t>, 4> particle_;
  std::array<std::vector<float>, 25> floats_;
};

}  // namespace souple
