#include "plugins/radium/plugin/panel.h"

#include "plugins/radium/plugin/material_box.h"
#include "plugins/radium/plugin/object_list.h"

#include <QComboBox>
#include <QFileDialog>
#include <QFileInfo>
#include <QFormLayout>
#include <QGroupBox>
#include <QHBoxLayout>
#include <QLabel>
#include <QPlainTextEdit>
#include <QPushButton>
#include <QScrollArea>
#include <QSignalBlocker>
#include <QSpinBox>
#include <QVBoxLayout>
#include <exception>

namespace souple::radium {

namespace {

constexpr int look_every = 100;      // ms
constexpr int measure_every = 1000;  // ms
constexpr int log_lines = 200;

template <class Action>
QPushButton* button(const QString& label, const QString& hint, Action action) {
  auto* made = new QPushButton(label);
  made->setToolTip(hint);
  QObject::connect(made, &QPushButton::clicked, made, [action] { action(); });
  return made;
}

QSpinBox* counter(int most) {
  auto* made = new QSpinBox;
  made->setRange(1, most);
  return made;
}

}  // namespace

Panel::Panel(PhysicsSystem& system, Playback& playback)
    : system_(system), playback_(playback), state_(new QLabel), log_(new QPlainTextEdit) {
  log_->setReadOnly(true);
  log_->setMaximumBlockCount(log_lines);
  log_->setFixedHeight(5 * fontMetrics().lineSpacing());
  log_->setPlaceholderText(tr("What goes wrong is said here."));

  auto* scroll = new QScrollArea;
  scroll->setWidget(contents());
  scroll->setWidgetResizable(true);
  scroll->setFrameShape(QFrame::NoFrame);
  scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);

  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(4, 4, 4, 4);
  layout->addLayout(scene_buttons());
  layout->addLayout(time_buttons());
  layout->addWidget(state_);
  layout->addWidget(scroll, 1);
  layout->addWidget(log_);

  show_settings();
  connect(&timer_, &QTimer::timeout, this, [this] { look_again(); });
  timer_.start(look_every);
}

QLayout* Panel::scene_buttons() {
  auto* row = new QHBoxLayout;
  row->addWidget(button(tr("Open scene..."), tr("A Souple scene (JSON) in the place of all that is there"),
                        [this] { ask_for_scene(); }));
  row->addWidget(button(tr("Clear"), tr("Empties the world; Radium's meshes lie again as they were loaded"),
                        [this] { clear(); }));
  return row;
}

QLayout* Panel::time_buttons() {
  auto* row = new QHBoxLayout;
  play_ = button(tr("Play"), tr("A step in each frame"), [this] { playback_.play(); });
  pause_ = button(tr("Pause"), tr("No more steps"), [this] { playback_.pause(); });
  row->addWidget(play_);
  row->addWidget(pause_);
  row->addWidget(button(tr("Step"), tr("One step, then pause"), [this] { playback_.step(); }));
  row->addWidget(button(tr("Reset"), tr("Back to the start, with the materials and settings as they are now"),
                        [this] { playback_.reset(); }));
  return row;
}

QWidget* Panel::contents() {
  ObjectList::Answers answers;
  answers.selected = [this] { material_->show_object(objects_->object()); };
  answers.changed = [this] { world_changed(); };
  answers.say = [this](const std::string& message) { say(message); };
  material_ = new MaterialBox(system_.session(), answers.say);
  objects_ = new ObjectList(system_, answers);

  auto* all = new QWidget;
  auto* layout = new QVBoxLayout(all);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addWidget(objects_);
  layout->addWidget(material_);
  layout->addWidget(solver_box());
  layout->addWidget(statistics_box());
  layout->addStretch();
  return all;
}

QWidget* Panel::solver_box() {
  auto* box = new QGroupBox(tr("Solver"));
  auto* form = new QFormLayout(box);
  substeps_ = counter(200);
  iterations_ = counter(200);
  mode_ = new QComboBox;
  for (const std::string& mode : host::Session::modes()) mode_->addItem(QString::fromStdString(mode));
  form->addRow(tr("Substeps"), substeps_);
  form->addRow(tr("Iterations"), iterations_);
  form->addRow(tr("Mode"), mode_);

  auto& session = system_.session();
  connect(substeps_, QOverload<int>::of(&QSpinBox::valueChanged), this,
          [&session](int substeps) { session.set_substeps(substeps); });
  connect(iterations_, QOverload<int>::of(&QSpinBox::valueChanged), this,
          [&session](int iterations) { session.set_iterations(iterations); });
  connect(mode_, QOverload<int>::of(&QComboBox::activated), this, [this, &session] {
    session.set_mode(mode_->currentText().toStdString());
    material_->show_object(objects_->object());  // a mode has parameters of its own
  });
  return box;
}

QWidget* Panel::statistics_box() {
  auto* box = new QGroupBox(tr("Statistics"));
  auto* layout = new QVBoxLayout(box);
  statistics_ = new QLabel;
  statistics_->setWordWrap(true);
  statistics_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  layout->addWidget(statistics_);
  return box;
}

void Panel::ask_for_scene() {
  const QString file = QFileDialog::getOpenFileName(this, tr("Open a Souple scene"), last_folder_,
                                                    tr("Souple scenes (*.json);;All files (*)"));
  if (!file.isEmpty()) open_scene(file);
}

void Panel::open_scene(const QString& file) {
  last_folder_ = QFileInfo(file).absolutePath();
  try {
    system_.open_scene(file.toStdString());
  } catch (const std::exception& error) {
    say(error.what());
    return;
  }
  playback_.pause();
  playback_.show_new();
  show_settings();
  world_changed();
}

void Panel::clear() {
  playback_.pause();
  system_.clear();
  show_settings();
  world_changed();
}

void Panel::world_changed() {
  objects_->refresh();
  playback_.update();
}

void Panel::show_settings() {
  const QSignalBlocker no_substeps(substeps_), no_iterations(iterations_), no_mode(mode_);
  const host::Session& session = system_.session();
  substeps_->setValue(session.substeps());
  iterations_->setValue(session.iterations());
  mode_->setCurrentText(QString::fromStdString(session.mode()));
}

void Panel::select(host::Handle object) {
  objects_->select(object);
}

void Panel::say(const std::string& message) {
  log_->appendPlainText(QString::fromStdString(message));
}

void Panel::look_again() {
  playback_.check();
  for (const std::string& message : system_.take_messages()) say(message);
  if (playback_.take_scene_change()) objects_->refresh();
  show_time();
}

void Panel::show_time() {
  const bool playing = playback_.playing();
  play_->setEnabled(!playing);
  pause_->setEnabled(playing);
  statistics_->setText(QString::fromStdString(system_.session().statistics().text()));
  if (!playing) {
    state_->setText(tr("paused"));
    wall_.invalidate();
    return;
  }
  const double time = system_.session().time();
  if (!wall_.isValid()) {
    state_->setText(tr("playing"));
  } else {
    if (wall_.elapsed() < measure_every) return;
    const double speed = 1000 * (time - time_then_) / static_cast<double>(wall_.elapsed());
    state_->setText(tr("playing, %1 of real time").arg(QString::number(100 * speed, 'f', 0) + " %"));
  }
  wall_.start();
  time_then_ = time;
}

}  // namespace souple::radium
