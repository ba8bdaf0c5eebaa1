#pragma once

#include "souple/math/mat3.h"

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

struct aiAnimation;
struct aiMesh;
struct aiMeshMorphAnim;
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

/// Where a scene's nodes and vertices are: as the file states it, or at a time of an animation. assimp tells nodes apart by
/// their names: Error is thrown where bones or keys name one of several nodes.
class Pose {
 public:
  /// `file`: its path, whose extension matters, for errors too. The scene must live as long.
  Pose(const aiScene& scene, const std::string& file);

  /// Takes the keys of an animation, which must live as long. Throws Error for keys that assimp reads wrongly.
  void animate(const aiAnimation& animation);

  /// Moves the nodes and shapes of the animation. Before its first key and after its last it rests.
  void set(double seconds);

  /// Per vertex of the part: from its own coordinates to those of the scene. A vertex with weights follows its bones, and
  /// its node does not matter (glTF 2.0, section 3.7.3.3); any other moves with the node.
  ///   x' = (sum_b w_b G_b O_b / sum_b w_b) x,  G_b: bone to scene, O_b: mesh to bone when it was bound
  std::vector<Affine> placements(const ScenePart& part) const;

  /// The part's vertices in its own coordinates, with the shapes of the animation, or those that the file states (glTF).
  ///   x' = x + sum_s w_s (x_s - x)
  std::vector<Vec3d> vertices(const ScenePart& part) const;

 private:
  struct Node {
    const aiNode* node;
    std::size_t parent;  ///< itself: the root
    Affine own, to_scene;
  };
  /// The keys of one shape.
  struct ShapeTrack {
    unsigned shape;
    struct Key {
      double mTime, weight;  // ticks
    };
    std::vector<Key> keys;
  };
  void move_down();
  /// The place of the node, in nodes_; their number, if there is none. Throws Error if there are several.
  std::size_t find(const std::string& name) const;
  static std::vector<ShapeTrack> tracks_of(const aiMeshMorphAnim& channel);
  /// Weights of the part's shapes.
  std::vector<double> weights_of(const ScenePart& part) const;

  std::string file_;
  bool is_gltf_, is_fbx_;
  std::vector<Node> nodes_;                        // parents first
  std::map<const aiNode*, std::size_t> place_of_;  // in nodes_
  std::map<std::string, std::size_t> by_name_;     // the first one of a name
  std::set<std::string> shared_names_;             // of several nodes
  std::map<const aiMesh*, std::size_t> holders_;   // of each mesh: nodes that hold it
  const aiAnimation* animation_ = nullptr;
  std::map<std::string, std::vector<ShapeTrack>> shape_tracks_;  // by the name of the node or mesh
  std::map<std::string, std::vector<double>> weights_;           // of shapes, now
};

}  // namespace souple::mesh_detail
