#include "souple/io/particle_file.h"

#include "souple/error.h"
#include "souple/files/endian.h"
#include "souple/files/file.h"
#include "souple/math/bit_cast.h"
#include "souple/mesh_files/mesh_write.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <iterator>
#include <system_error>
#include <utility>

#include <fmt/core.h>

namespace souple {

namespace {

/// Both formats store the high byte first.
class BigEndian {
 public:
  template <class Unsigned>
  void put(Unsigned value) {
    std::array<std::byte, sizeof(Unsigned)> bytes;
    store<ByteOrder::big>(bytes.data(), value);
    text_.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }
  void put(float value) { put(bit_cast<std::uint32_t>(value)); }
  void put(const Vec3f& v) { put(v.x), put(v.y), put(v.z); }
  void put_text(std::string_view text) { text_ += text; }

  std::string text() && { return std::move(text_); }

 private:
  std::string text_;
};

// The VTK User's Guide, "Simple legacy formats".
std::string vtk_bytes(std::span<const Vec3f> points, std::span<const Vec3f> velocities) {
  const std::size_t count = points.size();
  BigEndian out;
  out.put_text(
      fmt::format("# vtk DataFile Version 3.0\nparticles written by Souple\nBINARY\nDATASET POLYDATA\n"
                  "POINTS {} float\n",
                  count));
  for (const Vec3f& x : points) out.put(x);
  out.put_text(fmt::format("\nVERTICES {} {}\n", count, 2 * count));
  for (std::uint32_t i = 0; i < points.size(); ++i) out.put(std::uint32_t{1}), out.put(i);
  if (!velocities.empty()) {
    out.put_text(fmt::format("\nPOINT_DATA {}\nVECTORS velocity float\n", count));
    for (const Vec3f& v : velocities) out.put(v);
  }
  out.put_text("\n");
  return std::move(out).text();
}

// A header, the points' attributes beside positions, then the points: x, y, z, 1 and the attributes.
std::string bgeo_bytes(std::span<const Vec3f> points, std::span<const Vec3f> velocities) {
  constexpr std::uint32_t format_version = 5, vector_type = 5;
  const bool has_velocities = !velocities.empty();
  BigEndian out;
  out.put_text("BgeoV");
  out.put(format_version);
  out.put(static_cast<std::uint32_t>(points.size()));
  for (int none = 0; none < 3; ++none) out.put(std::uint32_t{0});  // primitives, groups of both
  out.put(std::uint32_t{has_velocities ? 1u : 0u});
  for (int none = 0; none < 3; ++none) out.put(std::uint32_t{0});  // attributes of vertices, primitives, all
  if (has_velocities) {
    out.put(std::uint16_t{1});  // length of the name
    out.put_text("v");
    out.put(std::uint16_t{3});
    out.put(vector_type);
    out.put(Vec3f{});  // default
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    out.put(points[i]);
    out.put(1.0f);
    if (has_velocities) out.put(velocities[i]);
  }
  out.put(std::uint8_t{0x00}), out.put(std::uint8_t{0xff});
  return std::move(out).text();
}

/// The supported part of a PLY's header.
struct PlyOfParticles {
  std::uint64_t points = 0;
  std::size_t floats = 0;  ///< floats per point
  bool has_kinds = false;  ///< a byte follows them
  std::size_t begin = 0;   ///< offset of the first point
};

std::optional<PlyOfParticles> parse_header(std::string_view text) {
  constexpr std::string_view properties[] = {"x", "y", "z", "vx", "vy", "vz"};
  constexpr std::string_view element = "element vertex ", property = "property float ";
  PlyOfParticles found;
  bool has_points = false;
  for (std::size_t line_number = 0;; ++line_number) {
    const std::size_t end = text.find('\n', found.begin);
    if (end == std::string_view::npos) return std::nullopt;
    const std::string_view line = text.substr(found.begin, end - found.begin);
    found.begin = end + 1;
    if (line_number == 0 || line_number == 1) {
      if (line != (line_number == 0 ? "ply" : "format binary_little_endian 1.0")) return std::nullopt;
    } else if (line.starts_with(element) && !has_points) {
      const std::string_view count = line.substr(element.size());
      const auto parsed = std::from_chars(count.data(), count.data() + count.size(), found.points);
      if (parsed.ec != std::errc{} || parsed.ptr != count.data() + count.size()) return std::nullopt;
      has_points = true;
    } else if (line.starts_with(property) && has_points && found.floats < std::size(properties) &&
               line.substr(property.size()) == properties[found.floats]) {
      ++found.floats;
    } else if (line == "property uchar kind" && found.floats == std::size(properties) && !found.has_kinds) {
      found.has_kinds = true;
    } else if (line == "end_header") {
      return found.floats == 3 || found.floats == 6 ? std::optional(found) : std::nullopt;
    } else if (!line.starts_with("comment")) {
      return std::nullopt;
    }
  }
}

/// Where the velocities of a PLY's vertices are.
struct PlyVelocities {
  std::uint64_t vertices = 0;
  std::size_t begin = 0, stride = 0;  ///< of the first vertex in the file, and from one to the next
  std::optional<std::size_t> offset;  ///< of vx in a vertex; vy and vz follow
};

/// The next line of a text, without its end, which it loses.
std::string_view take_line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

/// Nothing for a PLY that Souple does not write, or one without velocities.
std::optional<PlyVelocities> find_velocities(std::string_view text) {
  constexpr std::string_view first = "ply\nformat binary_little_endian 1.0\n", last = "end_header\n",
                             element = "element vertex ", floats = "property float ",
                             bytes = "property uchar ";
  const std::size_t end = text.find(last), vertices = text.find("element ");
  if (!text.starts_with(first) || end == std::string_view::npos || vertices > end) return std::nullopt;
  PlyVelocities found;
  found.begin = end + last.size();
  std::string_view header = text.substr(vertices, end - vertices), line = take_line(header);
  if (!line.starts_with(element)) return std::nullopt;
  std::from_chars(line.data() + element.size(), line.data() + line.size(), found.vertices);
  for (int in_succession = 0; !header.empty();) {
    line = take_line(header);
    if (!line.starts_with(floats) && !line.starts_with(bytes)) break;
    constexpr std::string_view components[] = {"vx", "vy", "vz"};
    const bool next = in_succession < 3 && line.starts_with(floats) &&
                      line.substr(floats.size()) == components[in_succession];
    if (next && ++in_succession == 3) found.offset = found.stride - 8;
    if (!next && in_succession < 3) in_succession = 0;
    found.stride += line.starts_with(floats) ? 4 : 1;
  }
  // An element with lists or other types has no fixed size.
  const bool known = line.starts_with(floats) || line.starts_with(bytes) || line.starts_with("element ");
  return known && found.offset ? std::optional(found) : std::nullopt;
}

}  // namespace

std::optional<ParticleFrame> read_particle_ply(const std::filesystem::path& path) {
  File file(path, File::Mode::read);
  std::string text(file.size(), '\0');
  file.read(0, std::as_writable_bytes(std::span(text)));
  const std::optional<PlyOfParticles> header = parse_header(text);
  if (!header) return std::nullopt;
  const std::size_t bytes_each = 4 * header->floats + (header->has_kinds ? 1 : 0),
                    held = (text.size() - header->begin) / bytes_each;
  if (held < header->points)
    throw Error(fmt::format("{}: holds {} points, its header says {}; it is damaged", path.string(), held,
                            header->points));
  ParticleFrame frame;
  frame.positions.resize(header->points);
  if (header->floats == 6) frame.velocities.resize(header->points);
  const std::byte* in = std::as_bytes(std::span(text)).data() + header->begin;
  for (std::size_t i = 0; i < header->points; ++i, in += bytes_each) {
    load_points<ByteOrder::little>(in, std::span(&frame.positions[i], 1));
    if (!frame.velocities.empty())
      load_points<ByteOrder::little>(in + 12, std::span(&frame.velocities[i], 1));
    if (!header->has_kinds) continue;
    frame.kinds.push_back(std::to_integer<std::uint8_t>(in[bytes_each - 1]));
    if (frame.kinds.back() > 2)
      throw Error(fmt::format("{}: point {} has the kind {}, expected 0 (spray), 1 (foam) or 2 (bubble)",
                              path.string(), i, frame.kinds.back()));
  }
  return frame;
}

std::vector<Vec3f> read_ply_velocities(const std::filesystem::path& path) {
  File file(path, File::Mode::read);
  std::string text(file.size(), '\0');
  file.read(0, std::as_writable_bytes(std::span(text)));
  const std::optional<PlyVelocities> found = find_velocities(text);
  if (!found) return {};
  const std::uint64_t held = (text.size() - found->begin) / found->stride;
  if (held < found->vertices)
    throw Error(fmt::format("{}: holds {} vertices, its header says {}; it is damaged", path.string(), held,
                            found->vertices));
  std::vector<Vec3f> velocities(found->vertices);
  const std::byte* in = std::as_bytes(std::span(text)).data() + found->begin + *found->offset;
  for (std::size_t i = 0; i < velocities.size(); ++i)
    load_points<ByteOrder::little>(in + i * found->stride, std::span(&velocities[i], 1));
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
