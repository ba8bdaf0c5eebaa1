#include "souple/error.h"
#include "souple/files/file.h"
#include "souple/mesh_files/mesh_bytes.h"
#include "souple/mesh_files/mesh_parse.h"
#include "souple/mesh_files/tet_builder.h"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/core.h>

namespace souple {

namespace {

using mesh_detail::ByteScanner;
using mesh_detail::NumberType;
using mesh_detail::quoted;
using mesh_detail::TextScanner;

using TypeName = std::pair<std::string_view, NumberType>;
constexpr std::array<TypeName, 13> vtk_types = {{{"unsigned_char", NumberType::uint8},
                                                 {"char", NumberType::int8},
                                                 {"unsigned_short", NumberType::uint16},
                                                 {"short", NumberType::int16},
                                                 {"unsigned_int", NumberType::uint32},
                                                 {"int", NumberType::int32},
                                                 {"unsigned_long", NumberType::uint64},
                                                 {"long", NumberType::int64},
                                                 {"vtkidtype", NumberType::int32},
                                                 {"vtktypeint64", NumberType::int64},
                                                 {"vtktypeuint8", NumberType::uint8},
                                                 {"float", NumberType::float32},
                                                 {"double", NumberType::float64}}};

constexpr std::int64_t vtk_tet = 10;

// Points, lines and surfaces, which a volume does not need.
bool is_flat_cell(std::int64_t type) {
  return (type >= 0 && type <= 9) || type == 21 || type == 22 || type == 23 || type == 28 || type == 30 ||
         type == 34 || type == 35 || type == 36;
}

class VtkReader {
 public:
  VtkReader(std::string_view bytes, const std::string& name)
      : bytes_(bytes), name_(name), scanner_(bytes, name, {}) {}

  TetMesh read() {
    read_header();
    while (cell_types_.empty()) {
      const std::string_view keyword = scanner_.word_on_any_line();
      const std::string section = lower_case(keyword);
      if (section == "points")
        read_points();
      else if (section == "cells")
        read_cells();
      else if (section == "cell_types")
        read_cell_types();
      else if (section == "metadata")
        skip_metadata();
      else if (section == "field")
        skip_field();
      else
        scanner_.fail(scanner_.found(keyword), "POINTS, CELLS and CELL_TYPES");
    }
    // The rest (POINT_DATA, CELL_DATA) is not needed.
    build();
    return std::move(mesh_);
  }

 private:
  void read_header() {
    const std::string_view first = scanner_.rest_of_line();
    constexpr std::string_view magic = "# vtk DataFile Version";
    if (lower_case(first.substr(0, magic.size())) != lower_case(magic)) {
      scanner_.fail(scanner_.found(first), "\"# vtk DataFile Version\", with which a legacy VTK file begins");
    }
    scanner_.next_line();  // skips the title
    scanner_.next_line();
    const std::string_view encoding = scanner_.word_on_any_line();
    if (lower_case(encoding) == "binary")
      is_binary_ = true;
    else if (lower_case(encoding) != "ascii")
      scanner_.fail(scanner_.found(encoding), "ASCII or BINARY");
    const std::string_view dataset = scanner_.word_on_any_line();
    if (lower_case(dataset) != "dataset") scanner_.fail(scanner_.found(dataset), "DATASET");
    const std::string_view kind = scanner_.word();
    if (lower_case(kind) != "unstructured_grid") scanner_.fail(scanner_.found(kind), "UNSTRUCTURED_GRID");
  }

  NumberType type_from(std::string_view word) const {
    for (const auto& [name, type] : vtk_types)
      if (name == lower_case(word.substr(0, 16))) return type;
    scanner_.fail(scanner_.found(word), "a type such as float, double, int or vtktypeint64");
  }

  /// Passes `count` numbers of a type to `take`; text or big-endian bytes, depending on the file.
  template <class Take>
  void read_numbers(std::size_t count, NumberType type, const char* what, Take take) {
    if (!is_binary_) {
      scanner_.require_room(count, 2, what);
      for (std::size_t i = 0; i < count; ++i) {
        const std::string_view word = scanner_.word_on_any_line();
        if (is_integer(type))
          take(0.0, scanner_.integer_from(word, what));
        else
          take(scanner_.coordinate_from(word, what), std::int64_t(0));
      }
      return;
    }
    scanner_.next_line();
    const std::size_t first = scanner_.offset();
    ByteScanner numbers(bytes_.substr(first), name_, true, first);
    numbers.require_room(count, size_of(type), what);
    for (std::size_t i = 0; i < count; ++i) {
      if (is_integer(type))
        take(0.0, numbers.integer(type, what));
      else
        take(type == NumberType::float32 ? double(numbers.real32(what)) : numbers.real64(what),
             std::int64_t(0));
    }
    // The text continues after the numbers, where line numbers are meaningless.
    const std::size_t end = first + count * size_of(type);
    scanner_ = TextScanner(bytes_.substr(end), name_, {.bytes_in_errors = true}, scanner_.line(), end);
  }

  // POINTS COUNT TYPE
  void read_points() {
    if (!mesh_.positions.empty()) scanner_.fail("a second POINTS", "one");
    const std::size_t count = scanner_.count("number of points", 3);
    const NumberType type = type_from(scanner_.word());
    if (count == 0 || count >= 0xffffffff) scanner_.fail(fmt::format("{} points", count), "4 to 2^32 - 2");
    mesh_.positions.reserve(count);
    std::array<double, 3> point{};
    std::size_t filled = 0;
    read_numbers(3 * count, type, "coordinate of a point", [&](double real, std::int64_t integer) {
      point[filled++] = real + double(integer);
      if (filled < 3) return;
      mesh_.positions.emplace_back(point[0], point[1], point[2]);
      filled = 0;
    });
  }

  // Until 5.0: CELLS COUNT SIZE, then for each cell its number of points and the points (SIZE numbers in
  // all). Since 5.1: CELLS COUNT + 1 SIZE, then OFFSETS TYPE, where each cell begins, and CONNECTIVITY TYPE,
  // all their points.
  void read_cells() {
    if (!offsets_.empty()) scanner_.fail("a second CELLS", "one");
    const std::size_t count = scanner_.count("number of cells", 1);
    const std::size_t size = scanner_.count("size of the cells", 1);
    const TextScanner before = scanner_;
    const std::string_view keyword = scanner_.word_on_any_line();
    if (lower_case(keyword.substr(0, 16)) != "offsets") {
      scanner_ = before;
      return read_classic_cells(count, size);
    }
    const NumberType offset_type = integer_type(scanner_.word());
    read_numbers(count, offset_type, "offset of a cell",
                 [&](double, std::int64_t value) { offsets_.push_back(value); });
    const std::string_view second = scanner_.word_on_any_line();
    if (lower_case(second) != "connectivity") scanner_.fail(scanner_.found(second), "CONNECTIVITY");
    const NumberType type = integer_type(scanner_.word());
    read_numbers(size, type, "point of a cell",
                 [&](double, std::int64_t value) { connectivity_.push_back(value); });
    check_offsets();
  }

  NumberType integer_type(std::string_view word) const {
    const NumberType type = type_from(word);
    if (!is_integer(type)) scanner_.fail(quoted(word), "an integer type");
    return type;
  }

  void check_offsets() const {
    if (offsets_.empty() || offsets_.front() != 0 || offsets_.back() != std::int64_t(connectivity_.size()) ||
        !std::is_sorted(offsets_.begin(), offsets_.end())) {
      scanner_.fail("OFFSETS that do not ascend from 0 to the length of CONNECTIVITY", "such offsets");
    }
  }

  void read_classic_cells(std::size_t count, std::size_t size) {
    std::int64_t left_in_cell = 0;
    offsets_.push_back(0);
    read_numbers(size, NumberType::int32, "cell", [&](double, std::int64_t value) {
      if (left_in_cell > 0) {
        connectivity_.push_back(value);
        if (--left_in_cell == 0) offsets_.push_back(std::int64_t(connectivity_.size()));
        return;
      }
      if (value <= 0) scanner_.fail(fmt::format("a cell of {} points", value), "one or more");
      left_in_cell = value;
    });
    if (left_in_cell > 0 || offsets_.size() != count + 1) {
      scanner_.fail(fmt::format("{} whole cells in {} numbers", offsets_.size() - 1, size),
                    fmt::format("{} cells", count));
    }
  }

  // CELL_TYPES COUNT
  void read_cell_types() {
    const std::size_t count = scanner_.count("number of cell types", 1);
    if (count == 0 || count + 1 != offsets_.size()) {
      scanner_.fail(fmt::format("{} cell types", count),
                    fmt::format("one for each of the cells, which stand before ({})",
                                offsets_.empty() ? 0 : offsets_.size() - 1));
    }
    read_numbers(count, NumberType::int32, "type of a cell",
                 [&](double, std::int64_t value) { cell_types_.push_back(value); });
  }

  // A block that ends at an empty line.
  void skip_metadata() {
    while (scanner_.next_line()) {
      if (scanner_.rest_of_line().empty()) return;
    }
  }

  // FIELD NAME COUNT, then arrays: NAME COMPONENTS TUPLES TYPE and their numbers
  void skip_field() {
    scanner_.word();
    const std::size_t arrays = scanner_.count("number of arrays", 8);
    for (std::size_t i = 0; i < arrays; ++i) {
      std::string_view name = scanner_.word_on_any_line();
      if (lower_case(name) == "metadata") {
        skip_metadata();
        name = scanner_.word_on_any_line();
      }
      const std::size_t components = scanner_.count("components of an array", 1);
      const std::size_t tuples = scanner_.count("tuples of an array", 1);
      if (tuples != 0 && components > scanner_.remaining() / tuples) {
        scanner_.fail("an array " + quoted(name) + " longer than the file", "a shorter one");
      }
      read_numbers(components * tuples, type_from(scanner_.word()), "number of a field",
                   [](double, std::int64_t) {});
    }
  }

  void build() {
    const auto points = std::int64_t(mesh_.positions.size());
    for (std::size_t cell = 0; cell < cell_types_.size(); ++cell) {
      if (is_flat_cell(cell_types_[cell])) continue;
      const auto fail_cell = [&](const std::string& found, const char* expected) {
        fail(fmt::format("cell {}{}", cell, found), expected);
      };
      if (cell_types_[cell] != vtk_tet) {
        fail_cell(fmt::format(" of type {}", cell_types_[cell]), "tets of four points only (type 10)");
      }
      const auto begin = std::size_t(offsets_[cell]);
      if (offsets_[cell + 1] - offsets_[cell] != 4) fail_cell(", a tet without four points", "four points");
      Tet tet{};
      for (std::size_t i = 0; i < 4; ++i) {
        const std::int64_t point = connectivity_[begin + i];
        if (point < 0 || point >= points) {
          fail_cell(fmt::format(" with point {}", point), "points from 0 to one less than POINTS counts");
        }
        tet[i] = std::uint32_t(point);
      }
      if (!mesh_detail::append_oriented(mesh_, tet)) fail_cell(", a flat tet", "a tet with a volume");
    }
    if (mesh_.tets.empty()) fail("no tet in the whole file", "at least one cell of type 10");
  }

  [[noreturn]] void fail(const std::string& found, const std::string& expected) const {
    throw Error(name_ + ": found " + found + ", expected " + expected);
  }

  std::string_view bytes_;
  std::string name_;
  TextScanner scanner_;
  bool is_binary_ = false;
  TetMesh mesh_;
  std::vector<std::int64_t> offsets_;  ///< where each cell begins in connectivity_, and the end
  std::vector<std::int64_t> connectivity_;
  std::vector<std::int64_t> cell_types_;
};

}  // namespace

TetMesh parse_vtk(std::string_view bytes, const std::string& name) {
  return VtkReader(bytes, name).read();
}

}  // namespace souple
