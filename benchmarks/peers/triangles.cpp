// The scene of `souple bench triangles` in Souple and in the broad phase of Bullet's soft bodies, step by
// step alternately, so that a slow phase of the machine affects both.
//   peer_triangles [--size N] [--steps N] [--threads N]

#include "app/bench_sheets.h"
#include "souple/error.h"

#include <BulletCollision/BroadphaseCollision/btDbvt.h>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace souple::peers {
namespace {

struct Options {
  int size = 100000, steps = 12, threads = 1;
};

btVector3 bullet(const Vec3f& v) {
  return {v.x, v.y, v.z};
}

/// As in btSoftBody: a tree of a sheet's nodes and a tree of its faces. Boxes have a margin of three steps of
/// motion and a quarter of the collision margin; a box is updated only when its content leaves it
/// (btSoftBody::predictMotion).
class BulletSheet {
 public:
  BulletSheet(const app::Sheets& scene, std::size_t sheet)
      : scene_(scene), first_(sheet * scene.vertices_of_sheet()) {
    for (std::size_t v = 0; v < scene.vertices_of_sheet(); ++v)
      nodes_.push_back(node_tree.insert(node_volume(v), tag(first_ + v)));
    const auto& triangles = scene.triangles_of_sheet();
    for (std::size_t t = 0; t < triangles.size(); ++t)
      faces_.push_back(face_tree.insert(face_volume(triangles[t]), tag(sheet * triangles.size() + t)));
  }

  void update() {
    constexpr float steps_ahead = 3;
    for (std::size_t v = 0; v < nodes_.size(); ++v) {
      btDbvtVolume volume = node_volume(v);
      node_tree.update(nodes_[v], volume, bullet(scene_.motion()[first_ + v]) * steps_ahead, margin / 4);
    }
    const auto& triangles = scene_.triangles_of_sheet();
    for (std::size_t t = 0; t < faces_.size(); ++t) {
      btDbvtVolume volume = face_volume(triangles[t]);
      Vec3f motion;
      for (const std::uint32_t i : triangles[t]) motion += scene_.motion()[first_ + i];
      face_tree.update(faces_[t], volume, bullet(motion * (1 / 3.0f)) * steps_ahead, margin / 4);
    }
    node_tree.optimizeIncremental(1);
    face_tree.optimizeIncremental(1);
  }

  btDbvt node_tree, face_tree;

 private:
  static constexpr btScalar margin = static_cast<btScalar>(app::Sheets::thickness / 2);

  static void* tag(std::size_t i) { return reinterpret_cast<void*>(i + 1); }
  btDbvtVolume node_volume(std::size_t v) const {
    return btDbvtVolume::FromCR(bullet(scene_.positions()[first_ + v].xyz()), margin);
  }
  btDbvtVolume face_volume(const Triangle& t) const {
    btVector3 corners[3];
    for (int k = 0; k < 3; ++k) corners[k] = bullet(scene_.positions()[first_ + t[std::size_t(k)]].xyz());
    btDbvtVolume volume = btDbvtVolume::FromPoints(corners, 3);
    volume.Expand({margin, margin, margin});
    return volume;
  }

  const app::Sheets& scene_;
  std::size_t first_;
  std::vector<btDbvtNode*> nodes_, faces_;
};

struct Count final : btDbvt::ICollide {
  std::size_t pairs = 0;
  void Process(const btDbvtNode*, const btDbvtNode*) override { ++pairs; }
};

class Bullet {
 public:
  explicit Bullet(const app::Sheets& scene) {
    for (std::size_t s = 0; s < scene.sheets(); ++s)
      sheets_.push_back(std::make_unique<BulletSheet>(scene, s));
  }
  void update() {
    for (const auto& sheet : sheets_) sheet->update();
  }
  /// Nodes of each sheet against faces of each, as in Bullet's soft bodies.
  std::size_t nodes_faces() {
    Count count;
    for (const auto& a : sheets_)
      for (const auto& b : sheets_) a->node_tree.collideTT(a->node_tree.m_root, b->face_tree.m_root, count);
    return count.pairs;
  }
  /// Faces against faces, as edges against edges would need; Bullet does not have this test.
  std::size_t faces_faces() {
    Count count;
    for (std::size_t a = 0; a < sheets_.size(); ++a)
      for (std::size_t b = a; b < sheets_.size(); ++b)
        sheets_[a]->face_tree.collideTT(sheets_[a]->face_tree.m_root, sheets_[b]->face_tree.m_root, count);
    return count.pairs;
  }

 private:
  std::vector<std::unique_ptr<BulletSheet>> sheets_;
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

double milliseconds(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    int* number = word == "--size"      ? &options.size
                  : word == "--steps"   ? &options.steps
                  : word == "--threads" ? &options.threads
                                        : nullptr;
    if (number == nullptr || i + 1 >= argc || std::atoi(argv[i + 1]) < 1)
      throw Error(word + ": expected --size N, --steps N or --threads N, N above 0");
    *number = std::atoi(argv[++i]);
  }
  return options;
}

void run(const Options& options) {
  app::Sheets scene(options.size);
  Bullet bullet(scene);
  const auto threads = make_threads(Threading::automatic, options.threads);
  const auto all = [](std::uint32_t, std::uint32_t) { return true; };
  NearPairFinder finder;
  NearPairs pairs;
  std::vector<double> ours, update, nodes, faces;
  std::size_t node_pairs = 0, face_pairs = 0;
  for (int step = 0; step < options.steps + 2; ++step) {
    scene.move_to(step);
    const double times[] = {
        milliseconds(
            [&] { finder.find(scene.elements(), scene.boxes(), all, scene.positions(), pairs, *threads); }),
        milliseconds([&] { bullet.update(); }), milliseconds([&] { node_pairs = bullet.nodes_faces(); }),
        milliseconds([&] { face_pairs = bullet.faces_faces(); })};
    if (step < 2) continue;
    ours.push_back(times[0]), update.push_back(times[1]), nodes.push_back(times[2]),
        faces.push_back(times[3]);
  }
  const double reference = median(ours);
  const auto print = [&](const char* name, double ms, std::size_t found) {
    std::printf("  %-44s %10.2f ms %8.2f %12zu pairs\n", name, ms, ms / reference, found);
  };
  std::printf("%zu triangles in %zu sheets; Souple on %d threads\n", scene.elements().triangles().size(),
              scene.sheets(), threads->count());
  print("Souple, boxes, hash, all near pairs", reference,
        pairs.vertex_triangle.size() + pairs.edge_edge.size());
  print("Bullet, update of the trees", median(update), 0);
  print("Bullet, nodes against faces, with update", median(update) + median(nodes), node_pairs);
  print("Bullet, faces against faces, with update", median(update) + median(faces), face_pairs);
}

}  // namespace
}  // namespace souple::peers

int main(int argc, char** argv) {
  try {
    souple::peers::run(souple::peers::parse(argc, argv));
    return 0;
  } catch (const souple::Error& error) {
    std::fprintf(stderr, "peer_triangles: %s\n", error.what());
    return 2;
  }
}
