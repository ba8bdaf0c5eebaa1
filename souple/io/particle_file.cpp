#include "souple/io/particle_file.h"

#include "souple/error.h"
#include "souple/io/endian.h"
#include "souple/io/mesh_write.h"

#include <array>
#include <bit>
#include <cstdint>
#include <utility>

namespace souple {

namespace {

/// Both formats want the high byte first.
class BigEndian {
 public:
  template <class Unsigned>
  void put(Unsigned value) {
    std::array<std::byte, sizeof(Unsigned)> bytes;
    store<ByteOrder::big>(bytes.data(), value);
    text_.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }
  void put(float value) { put(std::bit_cast<std::uint32_t>(value)); }
  void put(const Vec3f& v) { put(v.x), put(v.y), put(v.z); }
  void put_text(std::string_view text) { text_ += text; }

  std::string text() && { return std::move(text_); }

 private:
  std::string text_;
};

// The VTK User's Guide, "Simple legacy formats".
std::string vtk_bytes(std::span<const Vec3f> points, std::span<const Vec3f> velocities) {
  const std::string count = std::to_string(points.size());
  BigEndian out;
  out.put_text("# vtk DataFile Version 3.0\nparticles written by Souple\nBINARY\nDATASET POLYDATA\nPOINTS " +
               count + " float\n");
  for (const Vec3f& x : points) out.put(x);
  out.put_text("\nVERTICES " + count + " " + std::to_string(2 * points.size()) + "\n");
  for (std::uint32_t i = 0; i < points.size(); ++i) out.put(std::uint32_t{1}), out.put(i);
  if (!velocities.empty()) {
    out.put_text("\nPOINT_DATA " + count + "\nVECTORS velocity float\n");
    for (const Vec3f& v : velocities) out.put(v);
  }
  out.put_text("\n");
  return std::move(out).text();
}

// A header, what attributes points have beside their place, then the points: x, y, z, 1 and the attributes.
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

}  // namespace

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
    throw Error("writing particles: found " + std::to_string(velocities.size()) + " velocities, expected " +
                std::to_string(points.size()) + ", one for each point, or none");
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
