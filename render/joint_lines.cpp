#include "render/joint_lines.h"

#include "render/color.h"
#include "souple/objects/tie_options.h"
#include "souple/world/debug_draw.h"
#include "souple/world/world.h"

namespace souple::render {
namespace {

const PackedColor rope_ink = pack(srgb(0x3b3029)), joint_ink = pack(srgb(0xae3ec9)),
                  broken_ink = pack(srgb(0xc92a2a));

/// A cross at each end, and the line between them unless the tie is broken.
void draw_tie(const DebugJoint& tie, float size, std::vector<Line>& lines) {
  const PackedColor ink = tie.broken ? broken_ink : joint_ink;
  const float arm = size / 8;
  for (const Vec3f& x : {tie.point_a, tie.point_b})
    for (const Vec3f& half : {Vec3f{arm, 0, 0}, Vec3f{0, arm, 0}, Vec3f{0, 0, arm}})
      lines.push_back({x - half, x + half, ink, 2.5f});
  if (!tie.broken) lines.push_back({tie.point_a, tie.point_b, ink, 2.5f});
}

}  // namespace

void draw_joints(const World& world, bool all, float size, std::vector<Line>& lines) {
  if (world.joints().empty() && (!all || world.ties().empty())) return;
  DebugDraw draw;
  draw.joint = [&](const DebugJoint& joint) {
    if (!joint.broken)
      for (std::size_t i = 1; i < joint.rope.size(); ++i)
        lines.push_back({joint.rope[i - 1], joint.rope[i], rope_ink, 3});
    if (!all) return;
    if (joint.kind == "tie") return draw_tie(joint, size, lines);
    const PackedColor ink = joint.broken ? broken_ink : joint_ink;
    const Vec3f half = joint.axis * (size / 2);
    lines.push_back({joint.point_a - half, joint.point_a + half, ink, 2.5f});
    lines.push_back({joint.point_a, joint.point_b, ink, 2.5f});
  };
  world.debug_draw(draw);
}

}  // namespace souple::render
