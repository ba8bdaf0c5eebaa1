#pragma once

#include "souple/geometry/builders.h"
#include "souple/host/session.h"
#include "souple/host/vertex_welder.h"
#include "tests/paths.h"

#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

// Helpers of the tests of Session and of what draws it.

namespace souple::host {

inline constexpr double dt = 1.0 / 60;
inline constexpr float nan = std::numeric_limits<float>::quiet_NaN();
inline const std::string scenes = source_path("scenes/");

/// A mesh as importers deliver it: a vertex for each corner of each triangle.
struct Corners {
  std::vector<float> positions, normals;
  std::vector<std::uint32_t> indices;

  explicit Corners(const TriangleMesh& mesh) {
    for (const Triangle& triangle : mesh.triangles)
      for (const std::uint32_t v : triangle) {
        indices.push_back(static_cast<std::uint32_t>(indices.size()));
        for (int k = 0; k < 3; ++k) positions.push_back(static_cast<float>(mesh.positions[v][k]));
      }
    normals.resize(positions.size());
  }
  std::size_t count() const { return positions.size() / 3; }
  TriangleSoup soup() const { return {positions.data(), count(), indices.data(), indices.size() / 3}; }
  Vec3f at(std::size_t v) const { return {positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]}; }
  Vec3f normal(std::size_t v) const { return {normals[3 * v], normals[3 * v + 1], normals[3 * v + 2]}; }
};

/// A host's matrix of a place.
struct At {
  float matrix[16];
  At(float x, float y, float z) : matrix{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, y, z, 1} {}
  operator const float*() const { return matrix; }
};

/// Options of a mesh at a place.
struct Placed : MeshOptions {
  At place;
  Placed(float x, float y, float z) : place(x, y, z) { transform = place; }
  Placed(const Placed&) = delete;
  Placed& operator=(const Placed&) = delete;
};

/// A playing host whose clock advances by twice the frame's length, like Radium's.
struct Player {
  Session session;
  double now = 0;

  void play(int frames) {
    for (int i = 0; i < frames; ++i) ASSERT_EQ(session.advance(now += 2 * dt, dt), Tick::step) << i;
  }
  std::vector<std::string> paused_frame() {
    session.advance(now, dt);
    return session.take_messages();
  }
};

class HostedSession : public testing::Test {
 protected:
  Player host;
  Session& s = host.session;
};

/// With a cloth of 1 m.
template <int vertices_of_a_side>
class HostedCloth : public HostedSession {
 protected:
  Corners sheet{grid(vertices_of_a_side, vertices_of_a_side, 1.0)};
  const Handle cloth = s.add_cloth(sheet.soup());
};
using SmallCloth = HostedCloth<5>;
using LargeCloth = HostedCloth<9>;

inline std::vector<float> drawn(Session& session, Handle object) {
  std::vector<float> positions(3 * session.object(object).vertex_count);
  session.write(object, {positions.data(), nullptr}, positions.size() / 3);
  return positions;
}

inline Vec3f vertex(const std::vector<float>& positions, std::size_t v) {
  return {positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]};
}

inline bool same_bits(const std::vector<float>& a, std::span<const Vec3f> b) {
  return a.size() == 3 * b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

}  // namespace souple::host
