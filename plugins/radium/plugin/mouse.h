#pragma once

#include "plugins/radium/plugin/back_sides.h"

#include <QObject>
#include <functional>
#include <optional>

class QMouseEvent;
class QPoint;

namespace Ra::Gui {
class Viewer;
}

namespace souple::radium {

/// The right mouse button in Radium's view: drags objects of the world. With Shift it pins the vertex under
/// it, with Ctrl it releases that vertex.
class Mouse : public QObject {
 public:
  struct Answers {
    std::function<void(host::Handle)> picked;  ///< called for the object under the mouse
    std::function<void(const std::string&)> say;
    std::function<void()> update;  ///< requests a picture
  };
  Mouse(Ra::Gui::Viewer& viewer, PhysicsSystem& system, const BackSides& back_sides, Answers answers);

 private:
  struct Seen {
    PickedVertex vertex;
    float distance = 0;  ///< from the eye [m]
  };
  void press(const QMouseEvent& event);
  void move(const QMouseEvent& event);
  void release(const QMouseEvent& event);
  std::optional<Seen> pick(const QPoint& at);
  Ra::Core::Ray ray(const QPoint& at);
  bool grab(const std::optional<Seen>& seen, const QPoint& at);
  void set_pinned(const std::optional<Seen>& seen, bool pinned);

  Ra::Gui::Viewer& viewer_;
  PhysicsSystem& system_;
  const BackSides& back_sides_;
  Answers answers_;
};

}  // namespace souple::radium
