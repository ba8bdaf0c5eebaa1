#pragma once

#include "souple/host/session.h"
#include "tests/host/triangle_soups.h"
#include "tests/paths.h"

#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

// Helpers of the tests of Session.

namespace souple::host {

inline constexpr double dt = 1.0 / 60;
inline constexpr float nan = std::numeric_limits<float>::quiet_NaN();
inline const std::string scenes = source_path("scenes/");

/// A host's matrix of a place.
struct At {
  float matrix[16];
  At(float x, float y, float z) : matrix{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, y, z, 1} {}
  operator const float*() const { return matrix; }
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
