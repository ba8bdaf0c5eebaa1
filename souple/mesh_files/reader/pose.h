#pragma once

#include "souple/math/mat3.h"

#include <cstddef>
#include <map>
#include <string>
#include <vector>

struct aiAnimation;
struct aiMesh;
struct aiNode;
struct aiScene;

namespace souple::mesh_detail {

/// x -> linear x + translation.
struct Affine {
  Mat3d linear = Mat3d::identity();
  Vec3d translation{};

  Vec3d point(const Vec3d& x) const { return linear * x + translation; }
};

/// A mesh of a scene, and the node that holds it.
struct ScenePart {
  const aiMesh* mesh;
  const aiNode* node;
};

/// All meshes in the order of the scene's nodes, parents first. A mesh that several nodes hold is there several times.
std::vector<ScenePart> parts_of(const aiScene& scene);

/// Units of an animation's times in a second.
double ticks_per_second(const aiAnimation& animation);

/// Where a scene's nodes and vertices are: as the file states it, or at a time of an animation.
class Pose {
 public:
  explicit Pose(const aiScene& scene);

  /// Moves the nodes and shapes that the animation names. Before its first key and after its last it rests.
  void set(const aiAnimation& animation, double seconds);

  /// Per vertex of the part: from its own coordinates to those of the scene. A vertex with weights follows its bones, and
  /// its node does not matter (glTF 2.0, section 3.7.3.3); any other moves with the node.
  ///   x' = (sum_b w_b G_b O_b / sum_b w_b) x,  G_b: bone to scene, O_b: mesh to bone when it was bound
  std::vector<Affine> placements(const ScenePart& part) const;

  /// The part's vertices in its own coordinates, with the shapes of the animation.
  ///   x' = x + sum_s w_s (x_s - x)
  std::vector<Vec3d> vertices(const ScenePart& part) const;

 private:
  struct Node {
    const aiNode* node;
    std::size_t parent;  ///< itself: the root
    Affine own, to_scene;
  };
  void move_down();
  const Affine* find(const std::string& name) const;

  std::vector<Node> nodes_;                            // parents first
  std::map<const aiNode*, std::size_t> place_of_;      // in nodes_
  std::map<std::string, std::size_t> by_name_;         // the first one of a name
  std::map<std::string, std::vector<double>> shapes_;  // weights by the name of the node or mesh
};

}  // namespace souple::mesh_detail
