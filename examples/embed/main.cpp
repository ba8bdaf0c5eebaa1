#include <cstdio>
#include <souple/host/session.h>
#include <vector>

// A renderer's own memory: a square of 1 m as an importer delivers it, with a vertex for each corner of each
// triangle.
std::vector<float> positions{-0.5f, 0, -0.5f, -0.5f, 0, 0.5f, 0.5f, 0, 0.5f,
                             -0.5f, 0, -0.5f, 0.5f,  0, 0.5f, 0.5f, 0, -0.5f};
std::vector<float> normals(positions.size());
const std::vector<std::uint32_t> indices{0, 1, 2, 3, 4, 5};

int main() {
  souple::host::Session session;
  const std::size_t count = positions.size() / 3;
  const souple::host::Handle cloth =
      session.add_cloth({positions.data(), count, indices.data(), indices.size() / 3});
  session.set_pinned(cloth, 0, true);  // render vertex 0, and vertex 3 at the same position

  // The user's thread posts a change; the next frame applies it.
  session.post("stiffer",
               [cloth](souple::host::Session& s) { s.set_parameter(cloth, "bending_stiffness", 1e-3); });

  double animation_time = 0;
  for (int frame = 0; frame < 60; ++frame) {  // the renderer's loop
    animation_time += 1.0 / 60;
    if (session.advance(animation_time, 1.0 / 60) != souple::host::Tick::nothing)
      session.write(cloth, {positions.data(), normals.data()}, count);
    for (const std::string& message : session.take_messages()) std::puts(message.c_str());
  }
  std::printf("%s\nvertex 2 is at y = %.2f m\n", session.statistics().text().c_str(), positions[7]);
  return positions[1] == 0 && positions[7] < -0.3f ? 0 : 1;
}
