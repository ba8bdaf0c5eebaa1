#include "souple/error.h"
#include "souple/mesh_files/mesh_bytes.h"
#include "souple/mesh_files/mesh_faces.h"
#include "souple/mesh_files/mesh_parse.h"
#include "souple/mesh_files/mesh_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <utility>

#include <fmt/core.h>

namespace souple {

namespace {

using mesh_detail::ByteScanner;
using mesh_detail::FaceList;
using mesh_detail::NumberType;
using mesh_detail::TextScanner;

enum class PlyFormat { ascii, little_endian, big_endian };

// More than in any real file; limits the comparison of names in pairs.
constexpr std::size_t most_elements = 256;
constexpr std::size_t most_properties = 1024;

/// Meaning of a property of a vertex or a face.
enum class Role { none, x, y, z, red, green, blue, u, v, corners };
constexpr std::size_t role_count = 10;

struct PlyProperty {
  std::string name;
  NumberType type = NumberType::float32;
  bool is_list = false;
  NumberType count_type = NumberType::uint8;
  Role role = Role::none;
};

struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::size_t line = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;
  std::size_t body = 0;       ///< offset of the first byte after the header
  std::size_t body_line = 1;  ///< its line
};

/// Two names of each type.
constexpr std::array<std::pair<NumberType, std::array<std::string_view, 2>>, 8> type_names = {
    {{NumberType::int8, {"char", "int8"}},
     {NumberType::uint8, {"uchar", "uint8"}},
     {NumberType::int16, {"short", "int16"}},
     {NumberType::uint16, {"ushort", "uint16"}},
     {NumberType::int32, {"int", "int32"}},
     {NumberType::uint32, {"uint", "uint32"}},
     {NumberType::float32, {"float", "float32"}},
     {NumberType::float64, {"double", "float64"}}}};

struct RoleName {
  std::string_view name;
  Role role;
};
constexpr std::array<RoleName, 14> vertex_roles = {{{"x", Role::x},
                                                    {"y", Role::y},
                                                    {"z", Role::z},
                                                    {"red", Role::red},
                                                    {"green", Role::green},
                                                    {"blue", Role::blue},
                                                    {"u", Role::u},
                                                    {"v", Role::v},
                                                    {"s", Role::u},
                                                    {"t", Role::v},
                                                    {"texture_u", Role::u},
                                                    {"texture_v", Role::v},
                                                    {"texcoord_u", Role::u},
                                                    {"texcoord_v", Role::v}}};

/// Divisor of a color for the range [0, 1].
float color_divisor(NumberType type) {
  if (type == NumberType::uint8) return 255.0f;
  if (type == NumberType::uint16) return 65535.0f;
  return 1.0f;
}

class HeaderReader {
 public:
  HeaderReader(std::string_view bytes, const std::string& name) : name_(name), scanner_(bytes, name, {}) {}

  PlyHeader read() {
    const std::string_view magic = scanner_.word();
    if (magic != "ply") scanner_.fail(scanner_.found(magic), "\"ply\", with which a PLY file begins");
    read_format();
    while (true) {
      next_line();
      const std::string_view keyword = scanner_.word();
      if (keyword == "end_header") break;
      if (keyword == "element")
        read_element();
      else if (keyword == "property")
        read_property();
      else if (keyword != "comment" && keyword != "obj_info" && !keyword.empty()) {
        scanner_.fail(mesh_detail::quoted(keyword), "element, property, comment or end_header");
      }
    }
    scanner_.next_line();
    header_.body = scanner_.offset();
    header_.body_line = scanner_.line();
    return header_;
  }

 private:
  void next_line() {
    if (!scanner_.next_line()) scanner_.fail("the end of the file", "end_header");
  }

  void read_format() {
    std::string_view keyword;
    do {
      next_line();
      keyword = scanner_.word();
    } while (keyword == "comment" || keyword == "obj_info");
    if (keyword != "format") scanner_.fail(scanner_.found(keyword), "\"format\" as the second line");
    const std::string_view format = scanner_.word();
    if (format == "ascii")
      header_.format = PlyFormat::ascii;
    else if (format == "binary_little_endian")
      header_.format = PlyFormat::little_endian;
    else if (format == "binary_big_endian")
      header_.format = PlyFormat::big_endian;
    else
      scanner_.fail(scanner_.found(format), "ascii, binary_little_endian or binary_big_endian");
    const std::string_view version = scanner_.word();
    if (version != "1.0") scanner_.fail(scanner_.found(version), "version 1.0");
  }

  void read_element() {
    PlyElement element;
    element.name = scanner_.word();
    if (element.name.empty()) scanner_.fail("no name", "\"element NAME COUNT\"");
    for (const PlyElement& other : header_.elements) {
      if (other.name == element.name)
        scanner_.fail("a second element " + mesh_detail::quoted(element.name), "each element once");
    }
    if (header_.elements.size() == most_elements) scanner_.fail("more than 256 elements", "at most 256");
    const std::int64_t count = scanner_.integer_from(scanner_.word(), "count of an element");
    if (count < 0) scanner_.fail(fmt::format("{}", count), "a count >= 0");
    element.count = std::size_t(count);
    element.line = scanner_.line();
    header_.elements.push_back(std::move(element));
  }

  void read_property() {
    if (header_.elements.empty()) scanner_.fail("a property", "an element before it");
    PlyElement& element = header_.elements.back();
    PlyProperty property;
    std::string_view type = scanner_.word();
    if (type == "list") {
      property.is_list = true;
      property.count_type = read_type(scanner_.word());
      if (!is_integer(property.count_type)) scanner_.fail("a list counted by a real", "an integer type");
      type = scanner_.word();
    }
    property.type = read_type(type);
    property.name = scanner_.word();
    if (property.name.empty()) scanner_.fail("no name", "\"property TYPE NAME\"");
    for (const PlyProperty& other : element.properties) {
      if (other.name == property.name)
        scanner_.fail("a second property " + mesh_detail::quoted(property.name), "each once");
    }
    if (element.properties.size() == most_properties)
      scanner_.fail("more than 1024 properties", "at most 1024");
    property.role = role_of(element, property);
    element.properties.push_back(std::move(property));
  }

  NumberType read_type(std::string_view word) {
    for (const auto& [type, names] : type_names)
      if (word == names[0] || word == names[1]) return type;
    scanner_.fail(scanner_.found(word),
                  "a type: char, uchar, short, ushort, int, uint, float, double or int8 to float64");
  }

  Role role_of(const PlyElement& element, const PlyProperty& property) const {
    if (element.name == "face" && (property.name == "vertex_indices" || property.name == "vertex_index")) {
      if (!property.is_list || !is_integer(property.type)) {
        scanner_.fail(mesh_detail::quoted(property.name) + " that is no list of integers",
                      "such as \"list uchar int\"");
      }
      return Role::corners;
    }
    if (element.name != "vertex" || property.is_list) return Role::none;
    for (const RoleName& entry : vertex_roles) {
      if (entry.name == property.name) return entry.role;
    }
    return Role::none;
  }

  std::string name_;
  TextScanner scanner_;
  PlyHeader header_;
};

/// The body's numbers, one by one, as words.
class AsciiBody {
 public:
  AsciiBody(std::string_view bytes, const std::string& name, const PlyHeader& header)
      : scanner_(bytes.substr(header.body), name, {}, header.body_line) {}

  double number(NumberType type, const char* what) {
    return is_integer(type) ? double(scanner_.integer(what)) : scanner_.real(what);
  }
  std::int64_t integer(NumberType, const char* what) { return scanner_.integer(what); }
  void skip(NumberType, const char* what) {
    const std::string_view word = scanner_.word_on_any_line();
    if (word.empty()) scanner_.fail(scanner_.found(word), what);
  }
  void skip_many(NumberType type, std::uint64_t count, const char* what) {
    require_room(count, 2, what);
    for (std::uint64_t i = 0; i < count; ++i) skip(type, what);
  }
  // A number and the blank after it, which the last number may lack.
  static std::size_t smallest(NumberType) { return 2; }
  void require_room(std::uint64_t count, std::size_t bytes_each, const char* what) const {
    scanner_.require_room(count, bytes_each, what);
  }
  [[noreturn]] void fail(std::string_view found, std::string_view expected) const {
    scanner_.fail(found, expected);
  }

 private:
  TextScanner scanner_;
};

/// The body's numbers, one by one, as bytes.
class BinaryBody {
 public:
  BinaryBody(std::string_view bytes, const std::string& name, const PlyHeader& header)
      : scanner_(bytes.substr(header.body), name, header.format == PlyFormat::big_endian, header.body) {}

  double number(NumberType type, const char* what) {
    if (is_integer(type)) return double(integer(type, what));
    const double value =
        type == NumberType::float32 ? double(scanner_.read<float>(what)) : scanner_.read<double>(what);
    if (!std::isfinite(value)) fail(fmt::format("{:g}", value), fmt::format("a finite number ({})", what));
    return value;
  }
  std::int64_t integer(NumberType type, const char* what) { return scanner_.integer(type, what); }
  void skip(NumberType type, const char* what) { scanner_.skip(size_of(type), what); }
  void skip_many(NumberType type, std::uint64_t count, const char* what) {
    require_room(count, size_of(type), what);
    scanner_.skip(std::size_t(count) * size_of(type), what);
  }
  static std::size_t smallest(NumberType type) { return size_of(type); }
  void require_room(std::uint64_t count, std::size_t bytes_each, const char* what) const {
    scanner_.require_room(count, bytes_each, what);
  }
  [[noreturn]] void fail(std::string_view found, std::string_view expected) const {
    scanner_.fail(found, expected);
  }

 private:
  ByteScanner scanner_;
};

template <class Body>
class BodyReader {
 public:
  BodyReader(const PlyHeader& header, Body body) : header_(header), body_(std::move(body)) {}

  TriangleMesh read(const std::string& name) {
    for (const PlyElement& element : header_.elements) read_element(element);
    if (mesh_.positions.empty())
      throw Error(name + ": found no vertex, expected at least one (element vertex)");
    if (largest_corner_ >= mesh_.positions.size() && !faces_.ends.empty()) {
      throw Error(fmt::format(
          "{}: face {}: found vertex index {}, expected at most {}, since the file lists {} vertices from 0",
          name, largest_corner_face_, largest_corner_, mesh_.positions.size() - 1, mesh_.positions.size()));
    }
    // Converts UVs per vertex to UVs per corner.
    if (!mesh_.uvs.empty()) faces_.corner_uvs = faces_.corners;
    faces_.store(mesh_);
    return std::move(mesh_);
  }

 private:
  void read_element(const PlyElement& element) {
    if (element.properties.empty()) return;
    std::size_t smallest = 0;
    for (const PlyProperty& property : element.properties) {
      smallest += Body::smallest(property.is_list ? property.count_type : property.type);
    }
    body_.require_room(element.count, smallest, element.name.c_str());
    if (element.name == "vertex") return read_vertices(element);
    if (element.name == "face") return read_faces(element);
    for (std::size_t i = 0; i < element.count; ++i) {
      for (const PlyProperty& property : element.properties) skip(property);
    }
  }

  void skip(const PlyProperty& property) {
    if (!property.is_list) return body_.skip(property.type, property.name.c_str());
    body_.skip_many(property.type, list_size(property), property.name.c_str());
  }

  std::uint64_t list_size(const PlyProperty& property) {
    const std::int64_t size = body_.integer(property.count_type, "length of a list");
    if (size < 0) body_.fail(fmt::format("{} as the length of a list", size), "a length >= 0");
    return std::uint64_t(size);
  }

  void read_vertices(const PlyElement& element) {
    std::array<bool, role_count> has{};
    for (const PlyProperty& property : element.properties) has[std::size_t(property.role)] = true;
    const auto all = [&](std::initializer_list<Role> roles) {
      return std::all_of(roles.begin(), roles.end(), [&](Role role) { return has[std::size_t(role)]; });
    };
    if (!all({Role::x, Role::y, Role::z})) body_.fail("vertices without x, y or z", "these three properties");
    const bool has_colors = all({Role::red, Role::green, Role::blue}), has_uvs = all({Role::u, Role::v});
    if (element.count >= 0xffffffff)
      body_.fail(fmt::format("{} vertices", element.count), "fewer than 2^32 - 1");
    mesh_.positions.reserve(element.count);
    if (has_colors) mesh_.colors.reserve(element.count);
    if (has_uvs) mesh_.uvs.reserve(element.count);
    std::array<double, role_count> values{};
    const auto value = [&](Role role) { return values[std::size_t(role)]; };
    for (std::size_t i = 0; i < element.count; ++i) {
      for (const PlyProperty& property : element.properties) read_vertex_property(property, values);
      mesh_.positions.emplace_back(value(Role::x), value(Role::y), value(Role::z));
      if (has_colors) {
        mesh_.colors.emplace_back(float(value(Role::red)), float(value(Role::green)),
                                  float(value(Role::blue)));
      }
      if (has_uvs) mesh_.uvs.push_back({float(value(Role::u)), float(value(Role::v))});
    }
  }

  void read_vertex_property(const PlyProperty& property, std::array<double, role_count>& values) {
    if (property.role == Role::none) return skip(property);
    double value = body_.number(property.type, property.name.c_str());
    if (property.role == Role::red || property.role == Role::green || property.role == Role::blue) {
      value = double(float(value) / color_divisor(property.type));
      if (!(value >= 0.0 && value <= 1.0)) {
        body_.fail(fmt::format("the color {:g}", value), "0 to 1, or 0 to 255 as uchar");
      }
    } else if (!(std::abs(value) <= mesh_detail::largest_coordinate)) {
      body_.fail(fmt::format("{:g} as {}", value, property.name), "a number within 1e18");
    }
    values[std::size_t(property.role)] = value;
  }

  void read_faces(const PlyElement& element) {
    const bool has_corners = std::any_of(element.properties.begin(), element.properties.end(),
                                         [](const PlyProperty& p) { return p.role == Role::corners; });
    if (!has_corners && element.count > 0) body_.fail("faces without vertex_indices", "this property");
    faces_.ends.reserve(element.count);
    for (std::size_t face = 0; face < element.count; ++face) {
      for (const PlyProperty& property : element.properties) {
        if (property.role == Role::corners)
          read_corners(property, face);
        else
          skip(property);
      }
    }
  }

  void read_corners(const PlyProperty& property, std::size_t face) {
    const std::uint64_t size = list_size(property);
    if (size < 3) body_.fail(fmt::format("face {} with {} corners", face, size), "3 or more");
    body_.require_room(size, Body::smallest(property.type), "corners of a face");
    for (std::uint64_t i = 0; i < size; ++i) {
      const std::int64_t corner = body_.integer(property.type, "vertex index of a face");
      const bool known = !mesh_.positions.empty();
      const auto count = std::int64_t(known ? mesh_.positions.size() : 0xffffffff);
      if (corner < 0 || corner >= count) {
        body_.fail(fmt::format("vertex index {} in face {}", corner, face),
                   fmt::format("0 to {}, the vertices that the file lists", count - 1));
      }
      // Faces may precede the vertices.
      if (std::uint64_t(corner) > largest_corner_) {
        largest_corner_ = std::uint64_t(corner);
        largest_corner_face_ = face;
      }
      faces_.corners.push_back(std::uint32_t(corner));
    }
    faces_.end_face();
  }

  const PlyHeader& header_;
  Body body_;
  TriangleMesh mesh_;
  FaceList faces_;
  std::uint64_t largest_corner_ = 0;
  std::size_t largest_corner_face_ = 0;
};

}  // namespace

TriangleMesh parse_ply(std::string_view bytes, const std::string& name) {
  const PlyHeader header = HeaderReader(bytes, name).read();
  if (header.format == PlyFormat::ascii) {
    return BodyReader<AsciiBody>(header, AsciiBody(bytes, name, header)).read(name);
  }
  return BodyReader<BinaryBody>(header, BinaryBody(bytes, name, header)).read(name);
}

}  // namespace souple
