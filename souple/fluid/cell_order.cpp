#include "souple/fluid/cell_order.h"

#include "souple/assert.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace souple {

namespace {

constexpr std::size_t chunk_size = 8192;
constexpr int max_bits = 20;  // bits per coordinate; positions further away share the outermost cells
constexpr int digit_bits = 11;

std::size_t chunks_of(std::size_t n) {
  return (n + chunk_size - 1) / chunk_size;
}

template <class Function>
void for_chunks(std::size_t n, Threads& threads, const Function& f) {
  threads.each(chunks_of(n), 1,
               [&](std::size_t c) { f(c, c * chunk_size, std::min(n, (c + 1) * chunk_size)); });
}

template <class Item>
std::uint64_t key(const Item& item) {
  if constexpr (requires { item.key; })
    return item.key;
  else
    return item >> 32;
}

template <class Item>
std::uint32_t particle(const Item& item) {
  if constexpr (requires { item.particle; })
    return item.particle;
  else
    return static_cast<std::uint32_t>(item);
}

}  // namespace

void CellOrder::build(std::span<const Vec4f> positions, float cell_size, Threads& threads) {
  find_grid(positions, cell_size, threads);
  if (bits_[0] + bits_[1] + bits_[2] <= 32)
    sort(positions, narrow_, threads);
  else
    sort(positions, wide_, threads);
}

void CellOrder::find_grid(std::span<const Vec4f> positions, float cell_size, Threads& threads) {
  constexpr float none = std::numeric_limits<float>::infinity();
  const std::size_t n = positions.size();
  chunk_bounds_.resize(chunks_of(n));
  for_chunks(n, threads, [&](std::size_t c, std::size_t begin, std::size_t end) {
    std::array<float, 6> box{none, none, none, -none, -none, -none};
    for (std::size_t i = begin; i < end; ++i) {
      const Vec4f& p = positions[i];
      if (!is_finite(p.xyz())) continue;
      const float at[3] = {p.x, p.y, p.z};
      for (std::size_t a = 0; a < 3; ++a)
        box[a] = std::min(box[a], at[a]), box[3 + a] = std::max(box[3 + a], at[a]);
    }
    chunk_bounds_[c] = box;
  });
  inverse_ = 1 / static_cast<double>(cell_size);
  for (std::size_t a = 0; a < 3; ++a) {
    float lo = none, hi = -none;
    for (const auto& box : chunk_bounds_) lo = std::min(lo, box[a]), hi = std::max(hi, box[3 + a]);
    if (!(lo <= hi)) lo = hi = 0;
    corner_[a] = lo;
    const double cells = std::min((static_cast<double>(hi) - lo) * inverse_, std::ldexp(1.0, max_bits) - 1);
    bits_[a] = static_cast<int>(std::bit_width(static_cast<std::uint64_t>(cells)));
  }
}

// Cell coordinates grow monotonically with the coordinate. So points within one cell size of a point lie in
// its cell or an adjacent one, also at the grid's border.
std::uint64_t CellOrder::key_of(const Vec4f& position) const {
  const double at[3] = {position.x, position.y, position.z};
  std::uint64_t result = 0;
  for (std::size_t a = 3; a-- > 0;) {
    const double last = static_cast<double>((std::uint64_t{1} << bits_[a]) - 1);
    const double cell = (at[a] - corner_[a]) * inverse_;
    const double kept = cell > 0 ? std::min(cell, last) : 0;  // NaN gives 0
    result = result << bits_[a] | static_cast<std::uint64_t>(kept);
  }
  return result;
}

template <class Item>
void CellOrder::sort(std::span<const Vec4f> positions, std::array<std::vector<Item>, 2>& items,
                     Threads& threads) {
  const std::size_t n = positions.size();
  for (std::vector<Item>& half : items) half.resize(n);
  for_chunks(n, threads, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint64_t k = key_of(positions[i]);
      if constexpr (std::is_same_v<Item, WideItem>)
        items[0][i] = {k, static_cast<std::uint32_t>(i)};
      else
        items[0][i] = k << 32 | i;
    }
  });
  const int bits = bits_[0] + bits_[1] + bits_[2];
  SOUPLE_ASSERT(bits <= 3 * max_bits, "a cell's coordinates fit into a key");
  const int passes = (bits + digit_bits - 1) / digit_bits;
  std::size_t sorted = 0;
  for (int pass = 0, shift = 0; pass < passes; ++pass) {
    const int digit = (bits - shift) / (passes - pass);
    sort_pass(items[sorted], items[1 - sorted], shift, digit, threads);
    sorted = 1 - sorted;
    shift += digit;
  }
  store_order(positions, items[sorted], threads);
  find_cells(items[sorted], threads);
}

template <class Item>
void CellOrder::sort_pass(const std::vector<Item>& from, std::vector<Item>& to, int shift, int bits,
                          Threads& threads) {
  const std::size_t n = from.size(), digits = std::size_t{1} << bits, chunks = chunks_of(n);
  const auto digit_of = [&](const Item& item) { return (key(item) >> shift) & (digits - 1); };
  histogram_.assign(chunks * digits, 0);
  for_chunks(n, threads, [&](std::size_t c, std::size_t begin, std::size_t end) {
    std::uint32_t* count = &histogram_[c * digits];
    for (std::size_t i = begin; i < end; ++i) ++count[digit_of(from[i])];
  });
  std::uint32_t sum = 0;
  for (std::size_t d = 0; d < digits; ++d) {
    for (std::size_t c = 0; c < chunks; ++c) {
      std::uint32_t& slot = histogram_[c * digits + d];
      sum += std::exchange(slot, sum);
    }
  }
  for_chunks(n, threads, [&](std::size_t c, std::size_t begin, std::size_t end) {
    std::uint32_t* next = &histogram_[c * digits];
    for (std::size_t i = begin; i < end; ++i) to[next[digit_of(from[i])]++] = from[i];
  });
}

template <class Item>
void CellOrder::store_order(std::span<const Vec4f> positions, const std::vector<Item>& sorted,
                            Threads& threads) {
  constexpr std::size_t padding = 16;
  const std::size_t n = sorted.size();
  order_.resize(n);
  for (std::vector<float>& component : component_) component.resize(n + padding);
  for_chunks(n, threads, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const std::uint32_t i = particle(sorted[k]);
      const Vec4f& p = positions[i];
      order_[k] = i;
      component_[0][k] = p.x, component_[1][k] = p.y, component_[2][k] = p.z;
    }
  });
}

template <class Item>
void CellOrder::find_cells(const std::vector<Item>& sorted, Threads& threads) {
  const std::size_t n = sorted.size(), chunks = chunks_of(n);
  const auto begins_cell = [&](std::size_t k) { return k == 0 || key(sorted[k]) != key(sorted[k - 1]); };
  const auto begins_row = [&](std::size_t k) {
    return k == 0 || key(sorted[k]) >> bits_[0] != key(sorted[k - 1]) >> bits_[0];
  };
  chunk_first_.resize(chunks);
  for_chunks(n, threads, [&](std::size_t c, std::size_t begin, std::size_t end) {
    std::uint32_t cells = 0, rows = 0;
    for (std::size_t k = begin; k < end; ++k) cells += begins_cell(k) ? 1 : 0, rows += begins_row(k) ? 1 : 0;
    chunk_first_[c] = {cells, rows};
  });
  std::uint32_t cells = 0, rows = 0;
  for (auto& first : chunk_first_)
    cells += std::exchange(first[0], cells), rows += std::exchange(first[1], rows);
  cells_.resize(cells + std::size_t{1});
  rows_.resize(rows + std::size_t{1});
  const auto coordinate = [&](std::uint64_t k, int shift, int axis) {
    return static_cast<std::int32_t>(k >> shift & ((std::uint64_t{1} << bits_[axis]) - 1));
  };
  for_chunks(n, threads, [&](std::size_t c, std::size_t begin, std::size_t end) {
    auto [cell, row] = chunk_first_[c];
    for (std::size_t k = begin; k < end; ++k) {
      if (!begins_cell(k)) continue;
      const std::uint64_t at = key(sorted[k]);
      if (begins_row(k))
        rows_[row++] = {cell, coordinate(at, bits_[0], 1), coordinate(at, bits_[0] + bits_[1], 2)};
      cells_[cell++] = {static_cast<std::uint32_t>(k), coordinate(at, 0, 0)};
    }
  });
  SOUPLE_ASSERT(std::is_sorted(sorted.begin(), sorted.end(),
                               [](const Item& a, const Item& b) { return key(a) < key(b); }),
                "particles are sorted by cells");
  cells_[cells] = {static_cast<std::uint32_t>(n), 0};
  rows_[rows] = {cells, 0, 0};
}

std::size_t CellOrder::bytes() const {
  return bytes_of(narrow_[0], narrow_[1], chunk_bounds_, histogram_, chunk_first_, order_, component_[0],
                  component_[1], component_[2], cells_, rows_) +
         bytes_of(wide_[0], wide_[1]);
}

}  // namespace souple
