#pragma once

#include "souple/constraints/column.h"
#include "souple/constraints/constraint.h"

#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

namespace souple {

/// Data of many constraints of one kind, sorted by color, as a structure of arrays. Each number of a constraint has its
/// array, so that the numbers of neighboring constraints load as one register.
template <class Kind>
struct ConstraintSet {
  using Params = typename Kind::template Params<float>;
  using Indices = std::array<std::uint32_t, Kind::arity>;
  using Compliance = std::array<float, compliance_size<Kind>>;
  static constexpr std::size_t arity = Kind::arity;
  static constexpr std::size_t rows = rows_of<Kind>;
  /// Number of floats in Params.
  static constexpr std::size_t param_count = sizeof(Params) / sizeof(float);
  static_assert(std::is_trivially_copyable_v<Params> && sizeof(Params) % sizeof(float) == 0,
                "Params<T> has members of type T only");

  /// records[k][i] is 4 times the k-th particle of constraint i: the index of its record's first float, so
  /// that kernels need not multiply.
  std::array<std::vector<std::uint32_t>, arity> records;
  std::array<Column, param_count> parameters;             ///< [float in Params]: rest lengths, ...
  std::array<Column, compliance_size<Kind>> compliances;  ///< alpha, packed; unit: (unit of C)^2 / J
  Column damping_times;                                   ///< tau [s]: damping coefficient is tau / alpha
  Column stiffnesses;                                     ///< PBD mode only: k in [0, 1]
  std::array<std::vector<float>, rows> multipliers;       ///< lambda of the substep; empty if not stored
  std::vector<std::uint32_t> color_begin;                 ///< color c is [color_begin[c], color_begin[c + 1])

  std::size_t size() const { return records[0].size(); }
  std::size_t color_count() const { return color_begin.empty() ? 0 : color_begin.size() - 1; }

  Indices indices(std::size_t i) const {
    Indices result;
    for (std::size_t k = 0; k < arity; ++k) result[k] = records[k][i] / 4;
    return result;
  }
  /// The particles of all constraints, constraint by constraint.
  std::vector<std::uint32_t> flat_indices() const {
    std::vector<std::uint32_t> flat;
    flat.reserve(size() * arity);
    for (std::size_t i = 0; i < size(); ++i)
      for (const std::uint32_t index : indices(i)) flat.push_back(index);
    return flat;
  }
  Params params(std::size_t i) const {
    float values[param_count];
    for (std::size_t k = 0; k < param_count; ++k) values[k] = parameters[k][i];
    Params result;
    std::memcpy(&result, values, sizeof result);
    return result;
  }
  void set_params(std::size_t i, const Params& params) {
    float values[param_count];
    std::memcpy(values, &params, sizeof params);
    for (std::size_t k = 0; k < param_count; ++k) parameters[k].set(i, values[k]);
  }
  Compliance compliance(std::size_t i) const {
    Compliance result;
    for (std::size_t k = 0; k < result.size(); ++k) result[k] = compliances[k][i];
    return result;
  }
  float damping_time(std::size_t i) const { return damping_times[i]; }
  float stiffness(std::size_t i) const { return stiffnesses[i]; }

  void add(const Indices& indices, const Params& params, const Compliance& compliance, float damping_time,
           float stiffness) {
    float values[param_count];
    std::memcpy(values, &params, sizeof params);
    for (std::size_t k = 0; k < arity; ++k) records[k].push_back(4 * indices[k]);
    for (std::size_t k = 0; k < param_count; ++k) parameters[k].push_back(values[k]);
    for (std::size_t k = 0; k < compliance.size(); ++k) compliances[k].push_back(compliance[k]);
    damping_times.push_back(damping_time);
    stiffnesses.push_back(stiffness);
  }

  /// Adds constraints [begin, end) of another set; the number of each particle plus `shift`, modulo 2^32.
  void append(const ConstraintSet& from, std::size_t begin, std::size_t end, std::uint32_t shift) {
    for (std::size_t k = 0; k < arity; ++k)
      for (std::size_t i = begin; i < end; ++i) records[k].push_back(from.records[k][i] + 4 * shift);
    for (std::size_t k = 0; k < param_count; ++k) parameters[k].append(from.parameters[k], begin, end);
    for (std::size_t k = 0; k < compliances.size(); ++k)
      compliances[k].append(from.compliances[k], begin, end);
    damping_times.append(from.damping_times, begin, end);
    stiffnesses.append(from.stiffnesses, begin, end);
  }

  /// Makes constraint order[k] the k-th; removes constraints that `order` omits. Clears the multipliers and
  /// invalidates the colors.
  void reorder(std::span<const std::uint32_t> order) {
    for (std::vector<std::uint32_t>& index : records) {
      std::vector<std::uint32_t> sorted;
      sorted.reserve(order.size());
      for (const std::uint32_t i : order) sorted.push_back(index[i]);
      index = std::move(sorted);
    }
    for_each_column([order](Column& column) { column.reorder(order); });
    for (std::vector<float>& values : multipliers) values.clear();
  }

  void shrink_to_fit() {
    for (std::vector<std::uint32_t>& index : records) index.shrink_to_fit();
    for_each_column([](Column& column) { column.shrink_to_fit(); });
    color_begin.shrink_to_fit();
  }

  /// Heap memory of the arrays. [bytes]
  std::size_t bytes() const {
    std::size_t sum =
        damping_times.bytes() + stiffnesses.bytes() + color_begin.capacity() * sizeof(std::uint32_t);
    for (const auto& index : records) sum += index.capacity() * sizeof(std::uint32_t);
    for (const Column& column : parameters) sum += column.bytes();
    for (const Column& column : compliances) sum += column.bytes();
    for (const auto& values : multipliers) sum += values.capacity() * sizeof(float);
    return sum;
  }

 private:
  template <class Function>
  void for_each_column(const Function& f) {
    for (Column& column : parameters) f(column);
    for (Column& column : compliances) f(column);
    f(damping_times), f(stiffnesses);
  }
};

}  // namespace souple
