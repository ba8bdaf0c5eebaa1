#pragma once

#include "souple/geometry/triangle_mesh.h"
#include "souple/math/vec3.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace souple {

/// The part of glTF 2.0 that a run needs, and its binary form GLB: one buffer, a bufferView per accessor, floats and
/// 32-bit indices. (The Khronos Group, glTF 2.0 Specification.) Souple writes it itself: tinygltf would be a second
/// JSON library and seconds of compile time, for as many lines that fill its structs.
class GlbModel {
 public:
  using Index = std::uint32_t;  ///< of an accessor, material, mesh, ...

  struct Material {
    std::string name;
    std::array<float, 4> color{1, 1, 1, 1};  ///< linear RGB, opacity
    float roughness = 1;
    bool double_sided = false;
  };
  enum class Mode { points = 0, line_strip = 3, triangles = 4 };
  /// Displacements of the vertices in one shape, added with the weight of the shape.
  struct Target {
    Index positions = 0;
    std::optional<Index> normals;
  };
  struct Primitive {
    Mode mode = Mode::triangles;
    std::vector<std::pair<std::string, Index>> attributes;  ///< accessor of POSITION, NORMAL, ...
    std::optional<Index> indices, material;
    std::vector<Target> targets;
  };
  struct Mesh {
    std::string name;
    std::vector<Primitive> primitives;
    std::vector<std::string> target_names;
  };
  /// A node of a mesh's name; its weights, if it has some, follow the keys.
  struct Node {
    Index mesh = 0;
    std::optional<Index> times, weights;  ///< accessors: seconds, and a weight per target and time
  };

  // Each adds an accessor and returns its index.
  Index add_vectors(std::span<const Vec3f> values);  ///< with bounds, as POSITION requires
  Index add_uvs(std::span<const std::array<float, 2>> values);
  Index add_scalars(std::span<const float> values);
  Index add_times(std::span<const float> values);    ///< with bounds; not for vertices
  Index add_weights(std::span<const float> values);  ///< not for vertices
  Index add_indices(std::span<const Triangle> triangles);
  /// Vectors that are all zero, without bytes in the file.
  Index add_zeros(std::size_t count);

  /// Size of the data so far; the JSON adds about 300 bytes per accessor. [bytes]
  std::uint64_t size() const { return data_.size(); }

  /// The bytes of a .glb. Throws Error above 4 GiB, the format's limit, and for a name that is not UTF-8.
  std::string bytes() const;

  std::string name;    ///< of the scene and the animation
  std::string extras;  ///< of the scene: JSON text of an object; may be empty
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<Node> nodes;

 private:
  enum class Kind { vertices, indices, other };
  struct Accessor {
    const char* type = "SCALAR";
    bool is_float = true;
    std::uint64_t count = 0;
    std::optional<std::uint64_t> offset{};  ///< of its bytes in the buffer
    std::uint64_t length = 0;               ///< bytes
    Kind kind = Kind::vertices;
    std::vector<float> lo{}, hi{};  ///< bounds; may be empty
  };
  friend class GlbJson;

  Index add(Accessor accessor, std::span<const float> numbers);

  std::vector<Accessor> accessors_;
  std::string data_;
};

}  // namespace souple
