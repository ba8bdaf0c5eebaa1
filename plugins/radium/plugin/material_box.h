#pragma once

#include <QWidget>
#include <functional>
#include <souple/host/session.h>
#include <string>

class QComboBox;
class QGridLayout;
class QLabel;

namespace souple::radium {

/// Editor of an object's material: a preset, and a slider for each number.
class MaterialBox : public QWidget {
 public:
  MaterialBox(host::Session& session, std::function<void(const std::string&)> say);

  /// 0: none.
  void show_object(host::Handle object);

 private:
  void show_presets();
  void show_sliders();
  void add_slider(QGridLayout& grid, const host::Parameter& parameter);
  void set_preset(const QString& name);
  void set_parameter(const std::string& name, double value);

  host::Session& session_;
  std::function<void(const std::string&)> say_;
  host::Handle object_ = 0;
  QLabel* title_;
  QComboBox* presets_;
  QWidget* sliders_ = nullptr;
};

}  // namespace souple::radium
