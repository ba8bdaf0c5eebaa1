#pragma once

#include "plugins/radium/plugin/back_sides.h"
#include "plugins/radium/plugin/playback.h"

#include <QElapsedTimer>
#include <QTimer>
#include <QWidget>
#include <functional>
#include <string>

class QComboBox;
class QLabel;
class QLayout;
class QPlainTextEdit;
class QPushButton;
class QSpinBox;

namespace souple::radium {

class MaterialBox;
class ObjectList;

/// The plugin's tab in Radium's window.
class Panel : public QWidget {
 public:
  Panel(PhysicsSystem& system, BackSides& back_sides, Playback& playback);

  void select(host::Handle object);
  void say(const std::string& message);

 private:
  QLayout* scene_buttons();
  QLayout* time_buttons();
  QWidget* tabs();
  QWidget* solver_form();
  void add_objects_and_material();
  /// Shows an error; exceptions must not reach Qt.
  void attempt(const std::function<void()>& action);
  void ask_for_scene();
  void open_scene(const QString& file);
  void clear();
  /// Updates the panel after objects were added or removed.
  void world_changed();
  void show_settings();
  void show_time();
  void look_again();

  PhysicsSystem& system_;
  BackSides& back_sides_;
  Playback& playback_;
  QPushButton *play_, *pause_;
  QSpinBox *substeps_, *iterations_;
  QComboBox* mode_;
  ObjectList* objects_;
  MaterialBox* material_;
  QLabel *state_, *statistics_, *last_message_;
  QPlainTextEdit* log_;
  QString last_folder_;
  QTimer timer_;
  QElapsedTimer wall_;  // since the speed was last measured
  double time_then_ = 0;
};

}  // namespace souple::radium
