#pragma once

#include "gl_test.h"
#include "souple/souple.h"

#include <vector>

// A scene of everything: a cloth that has fallen on a ball, boxes, a soft ring, grains.

namespace souple::render {

class Studio {
 public:
  explicit Studio(int steps, int cloth_side = 64);
  /// Spans refer to the studio.
  DrawList list() const;
  static Camera camera() { return {{2.1f, 1.45f, 2.7f}, {0.1f, 0.33f, 0}, 32}; }

 private:
  World world_;
  ObjectId cloth_, ring_, grains_;
  std::vector<Vec3f> cloth_rest_;
  Solid ball_, box_, small_box_;
};

}  // namespace souple::render
