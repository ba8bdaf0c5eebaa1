#pragma once

#include "plugins/radium/plugin/back_sides.h"

#include <QString>
#include <QWidget>
#include <functional>
#include <vector>

class QCheckBox;
class QPushButton;
class QTreeWidget;

namespace souple::radium {

/// Lists Radium's meshes and the objects of the world, with buttons that convert between them.
class ObjectList : public QWidget {
 public:
  struct Answers {
    std::function<void()> selected;  ///< called when another row is selected
    std::function<void()> about_to_remove;
    std::function<void()> changed;  ///< called when an object was added or removed
    std::function<void(const std::string&)> say;
  };
  ObjectList(PhysicsSystem& system, BackSides& back_sides, Answers answers);

  /// Updates the list and keeps the selection.
  void refresh();
  void select(host::Handle object);
  /// Handle of the selected object; 0 if the selected row is no object, or no row is selected.
  host::Handle object() const;

 private:
  struct Row {
    Ra::Core::Utils::Index render_object;  ///< invalid for a scene's objects
    host::Handle object = 0;
    QString name, kind;
    std::size_t triangles = 0;
  };
  void add_buttons();
  std::vector<Row> rows() const;
  const Row* selected() const;
  void make(host::Kind kind);
  void remove();
  void enable_buttons();

  PhysicsSystem& system_;
  BackSides& back_sides_;
  Answers answers_;
  std::vector<Row> rows_;
  QTreeWidget* table_;
  std::vector<QPushButton*> makers_;
  QPushButton* remover_;
  QCheckBox* self_collision_;
};

}  // namespace souple::radium
