#include "souple/io/particle_file.h"

#include "souple/error.h"
#include "souple/files/endian.h"
#include "souple/files/file.h"
#include "souple/mesh_files/mesh_write.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <system_error>

#include <fmt/core.h>

namespace souple {

namespace {

/// Both formats store the high byte first.
template <class... Numbers>
void add_big_endian(std::string& out, Numbers... numbers) {
  (append_binary<ByteOrder::big>(out, numbers), ...);
}

void add_vector(std::string& out, const Vec3f& v) {
  add_big_endian(out, v.x, v.y, v.z);
}

// The VTK User's Guide, "Simple legacy formats".
std::string vtk_bytes(std::span<const Vec3f> points, std::span<const Vec3f> velocities) {
  const std::size_t count = points.size();
  std::string out = fmt::format(
      "# vtk DataFile Version 3.0\nparticles written by Souple\nBINARY\nDATASET POLYDATA\n"
      "POINTS {} float\n",
      count);
  for (const Vec3f& x : points) add_vector(out, x);
  out += fmt::format("\nVERTICES {} {}\n", count, 2 * count);
  for (std::uint32_t i = 0; i < points.size(); ++i) add_big_endian(out, std::uint32_t{1}, i);
  if (!velocities.empty()) {
    out += fmt::format("\nPOINT_DATA {}\nVECTORS velocity float\n", count);
    for (const Vec3f& v : velocities) add_vector(out, v);
  }
  out += "\n";
  return out;
}

// A header, the points' attributes beside positions, then the points: x, y, z, 1 and the attributes.
std::string bgeo_bytes(std::span<const Vec3f> points, std::span<const Vec3f> velocities) {
  constexpr std::uint32_t none = 0, format_version = 5, vector_type = 5;
  const bool has_velocities = !velocities.empty();
  std::string out = "BgeoV";
  add_big_endian(out, format_version, static_cast<std::uint32_t>(points.size()));
  add_big_endian(out, none, none, none);  // primitives, groups of both
  add_big_endian(out, std::uint32_t{has_velocities ? 1u : 0u});
  add_big_endian(out, none, none, none);  // attributes of vertices, primitives, all
  if (has_velocities) {
    add_big_endian(out, std::uint16_t{1});  // length of the name
    out += "v";
    add_big_endian(out, std::uint16_t{3}, vector_type);
    add_vector(out, {});  // default
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    add_vector(out, points[i]);
    add_big_endian(out, 1.0f);
    if (has_velocities) add_vector(out, velocities[i]);
  }
  add_big_endian(out, std::uint8_t{0x00}, std::uint8_t{0xff});
  return out;
}

/// The vertices of a PLY in the form that Souple writes.
struct PlyVertices {
  std::uint64_t count = 0;
  std::size_t begin = 0, stride = 0;           ///< of the first vertex in the file, and from one to the next
  std::vector<std::string_view> properties{};  ///< "float x", "uchar red", ...
  bool alone = true;                           ///< no other element follows
};

std::size_t size_of_property(std::string_view property) {
  return property.starts_with("float ") ? 4 : 1;
}

/// The next line of a text, without its end, which it loses.
std::string_view take_line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

/// Nothing for a PLY that Souple does not write, such as one with lists or other types in its vertices.
std::optional<PlyVertices> find_vertices(std::string_view text) {
  constexpr std::string_view first = "ply\nformat binary_little_endian 1.0\n", last = "end_header\n",
                             element = "element vertex ", property = "property ";
  const std::size_t end = text.find(last), vertices = text.find("element ");
  if (!text.starts_with(first) || end == std::string_view::npos || vertices > end) return std::nullopt;
  PlyVertices found{.begin = end + last.size()};
  std::string_view header = text.substr(vertices, end - vertices), line = take_line(header);
  if (!line.starts_with(element)) return std::nullopt;
  const auto parsed = std::from_chars(line.data() + element.size(), line.data() + line.size(), found.count);
  if (parsed.ec != std::errc{} || parsed.ptr != line.data() + line.size()) return std::nullopt;
  while (!header.empty() && found.alone) {
    line = take_line(header);
    found.alone = !line.starts_with("element ");
    if (!found.alone || line.starts_with("comment")) continue;
    if (!line.starts_with("property float ") && !line.starts_with("property uchar ")) return std::nullopt;
    found.properties.push_back(line.substr(property.size()));
    found.stride += size_of_property(found.properties.back());
  }
  return found.properties.empty() ? std::nullopt : std::optional(found);
}

void require_held(const PlyVertices& vertices, std::size_t bytes, const std::filesystem::path& path) {
  const std::uint64_t held = (bytes - vertices.begin) / vertices.stride;
  if (held < vertices.count)
    throw Error(fmt::format("{}: holds {} vertices, its header says {}; it is damaged", path.string(), held,
                            vertices.count));
}

constexpr std::string_view particle_properties[] = {"float x",  "float y",  "float z",   "float vx",
                                                    "float vy", "float vz", "uchar kind"};

/// Whether these are a position, also with a velocity, also with a kind of foam.
bool are_of_particles(std::span<const std::string_view> properties) {
  const std::size_t count = properties.size();
  return (count == 3 || count == 6 || count == 7) &&
         std::equal(properties.begin(), properties.end(), particle_properties);
}

}  // namespace

std::optional<ParticleFrame> read_particle_ply(const std::filesystem::path& path) {
  const std::string text = read_whole_file(path);
  const std::optional<PlyVertices> header = find_vertices(text);
  if (!header || !header->alone || !are_of_particles(header->properties)) return std::nullopt;
  require_held(*header, text.size(), path);
  ParticleFrame frame;
  frame.positions.resize(header->count);
  if (header->properties.size() > 3) frame.velocities.resize(header->count);
  const std::byte* in = std::as_bytes(std::span(text)).data() + header->begin;
  for (std::size_t i = 0; i < header->count; ++i, in += header->stride) {
    load_points<ByteOrder::little>(in, std::span(&frame.positions[i], 1));
    if (!frame.velocities.empty())
      load_points<ByteOrder::little>(in + 12, std::span(&frame.velocities[i], 1));
    if (header->properties.size() < 7) continue;
    frame.kinds.push_back(std::to_integer<std::uint8_t>(in[24]));
    if (frame.kinds.back() > 2)
      throw Error(fmt::format("{}: point {} has the kind {}, expected 0 (spray), 1 (foam) or 2 (bubble)",
                              path.string(), i, frame.kinds.back()));
  }
  return frame;
}

std::vector<Vec3f> read_ply_velocities(const std::filesystem::path& path) {
  const std::string text = read_whole_file(path);
  const std::optional<PlyVertices> header = find_vertices(text);
  if (!header) return {};
  const auto& properties = header->properties;
  const auto vx =
      std::search(properties.begin(), properties.end(), particle_properties + 3, particle_properties + 6);
  if (vx == properties.end()) return {};
  require_held(*header, text.size(), path);
  std::vector<Vec3f> velocities(header->count);
  const std::byte* in = std::as_bytes(std::span(text)).data() + header->begin;
  for (auto before = properties.begin(); before != vx; ++before) in += size_of_property(*before);
  for (std::size_t i = 0; i < velocities.size(); ++i)
    load_points<ByteOrder::little>(in + i * header->stride, std::span(&velocities[i], 1));
  return velocities;
}

std::string_view particle_format_name(ParticleFormat format) {
  switch (format) {
    case ParticleFormat::vtk:
      return "vtk";
    case ParticleFormat::bgeo:
      return "bgeo";
    case ParticleFormat::ply:
      break;
  }
  return "ply";
}

std::string particle_bytes(ParticleFormat format, std::span<const Vec3f> points,
                           std::span<const Vec3f> velocities) {
  if (!velocities.empty() && velocities.size() != points.size())
    throw Error(
        fmt::format("writing particles: found {} velocities, expected {}, one for each point, or none",
                    velocities.size(), points.size()));
  switch (format) {
    case ParticleFormat::vtk:
      return vtk_bytes(points, velocities);
    case ParticleFormat::bgeo:
      return bgeo_bytes(points, velocities);
    case ParticleFormat::ply:
      break;
  }
  return ply_bytes(points, velocities);
}

}  // namespace souple
