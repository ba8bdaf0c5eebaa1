#include "plugins/radium/plugin/material_box.h"

#include <QComboBox>
#include <QGridLayout>
#include <QLabel>
#include <QSignalBlocker>
#include <QSlider>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>
#include <exception>
#include <utility>

namespace souple::radium {

namespace {

constexpr int slider_steps = 1000;

double value_at(const host::Parameter& p, int step) {
  const double share = static_cast<double>(step) / slider_steps;
  return p.logarithmic ? p.least * std::pow(p.most / p.least, share) : p.least + share * (p.most - p.least);
}

int step_at(const host::Parameter& p, double value) {
  const double inside = std::clamp(value, p.least, p.most);
  const double share = p.logarithmic ? std::log(inside / p.least) / std::log(p.most / p.least)
                                     : (inside - p.least) / (p.most - p.least);
  return static_cast<int>(std::lround(share * slider_steps));
}

QString text_of(const host::Parameter& p, double value) {
  const bool is_round = std::fabs(value) >= 999.5 && std::fabs(value) < 1e6;  // 4000 rather than 4e+03
  const QString number = is_round ? QString::number(value, 'f', 0) : QString::number(value, 'g', 3);
  return number + " " + QString::fromStdString(p.unit);
}

}  // namespace

MaterialBox::MaterialBox(host::Session& session, std::function<void(const std::string&)> say)
    : session_(session), say_(std::move(say)), title_(new QLabel), presets_(new QComboBox) {
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(4, 4, 4, 4);
  layout->addWidget(title_);
  layout->addWidget(presets_);
  layout->addStretch(1);
  connect(presets_, QOverload<int>::of(&QComboBox::activated), this, [this](int chosen) {
    if (chosen > 0) set_preset(presets_->itemText(chosen));
  });
  show_object(0);
}

void MaterialBox::show_object(host::Handle object) {
  object_ = session_.contains(object) ? object : 0;
  title_->setText(object_ == 0 ? tr("Select an object of the world.")
                               : QString::fromStdString(session_.object(object_).name));
  show_presets();
  show_sliders();
}

void MaterialBox::show_presets() {
  const QSignalBlocker quiet(presets_);
  presets_->clear();
  presets_->addItem(tr("Take a preset..."));
  if (object_ != 0)
    for (const std::string& name : session_.presets(object_)) presets_->addItem(QString::fromStdString(name));
  presets_->setVisible(presets_->count() > 1);
}

void MaterialBox::show_sliders() {
  delete sliders_;
  sliders_ = new QWidget;
  auto* grid = new QGridLayout(sliders_);
  grid->setContentsMargins(0, 0, 0, 0);
  grid->setColumnStretch(1, 1);
  if (object_ != 0)
    for (const host::Parameter& parameter : session_.parameters(object_)) add_slider(*grid, parameter);
  static_cast<QVBoxLayout*>(layout())->insertWidget(2, sliders_);
}

void MaterialBox::add_slider(QGridLayout& grid, const host::Parameter& parameter) {
  auto* slider = new QSlider(Qt::Horizontal);
  slider->setRange(0, slider_steps);
  slider->setValue(step_at(parameter, parameter.value));
  auto* number = new QLabel(text_of(parameter, parameter.value));
  number->setMinimumWidth(number->fontMetrics().horizontalAdvance("0.00123 kg/m²"));
  connect(slider, &QSlider::valueChanged, this, [this, parameter, number](int step) {
    const double value = value_at(parameter, step);
    number->setText(text_of(parameter, value));
    set_parameter(parameter.name, value);
  });
  const int row = grid.rowCount();
  grid.addWidget(new QLabel(QString::fromStdString(parameter.label)), row, 0);
  grid.addWidget(slider, row, 1);
  grid.addWidget(number, row, 2);
}

void MaterialBox::set_preset(const QString& name) {
  try {
    session_.set_preset(object_, name.toStdString());
  } catch (const std::exception& error) {
    say_(error.what());
  }
  show_sliders();
}

void MaterialBox::set_parameter(const std::string& name, double value) {
  try {
    session_.set_parameter(object_, name, value);
  } catch (const std::exception& error) {
    say_(error.what());
  }
}

}  // namespace souple::radium
