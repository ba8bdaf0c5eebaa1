#include "souple/io/animated_target.h"

#include "souple/error.h"

#include <limits>
#include <utility>
#include <vector>

#include <fmt/core.h>

namespace souple {

namespace {

class Following {
 public:
  explicit Following(std::shared_ptr<AnimatedPoints> points)
      : points_(std::move(points)), now_(points_->points()) {}

  Vec3d at(std::uint32_t vertex, double time) {
    if (vertex >= now_.size())
      throw Error(
          fmt::format("animated_target: the animation has {} points, none for vertex {}; expected one for "
                      "each vertex of the object",
                      now_.size(), vertex));
    if (time != time_) {
      time_ = std::numeric_limits<double>::quiet_NaN();  // stays NaN if evaluate throws
      points_->evaluate(time, now_);
      time_ = time;
    }
    return Vec3d(now_[vertex]);
  }

 private:
  std::shared_ptr<AnimatedPoints> points_;
  std::vector<Vec3f> now_;
  double time_ = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace

Target animated_target(std::shared_ptr<AnimatedPoints> points) {
  if (!points) throw Error("animated_target: there is no animation (null)");
  // Targets are copied; all copies share one evaluation.
  return [following = std::make_shared<Following>(std::move(points))](std::uint32_t vertex, double time) {
    return following->at(vertex, time);
  };
}

}  // namespace souple
