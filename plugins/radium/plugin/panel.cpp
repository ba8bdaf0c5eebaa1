#include "plugins/radium/plugin/panel.h"

#include "plugins/radium/plugin/material_box.h"
#include "plugins/radium/plugin/object_list.h"

#include <QComboBox>
#include <QFileDialog>
#include <QFileInfo>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QPlainTextEdit>
#include <QPushButton>
#include <QScrollArea>
#include <QSignalBlocker>
#include <QSpinBox>
#include <QTabWidget>
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

QScrollArea* scrolled(QWidget* page) {
  auto* area = new QScrollArea;
  area->setWidget(page);
  area->setWidgetResizable(true);
  area->setFrameShape(QFrame::NoFrame);
  area->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  return area;
}

QLabel* words() {
  auto* made = new QLabel;
  made->setWordWrap(true);
  made->setMargin(4);
  made->setAlignment(Qt::AlignTop);
  made->setTextInteractionFlags(Qt::TextSelectableByMouse);
  return made;
}

}  // namespace

Panel::Panel(PhysicsSystem& system, BackSides& back_sides, Playback& playback)
    : system_(system),
      back_sides_(back_sides),
      playback_(playback),
      state_(new QLabel),
      statistics_(words()),
      last_message_(words()),
      log_(new QPlainTextEdit) {
  log_->setReadOnly(true);
  log_->setMaximumBlockCount(log_lines);
  log_->setPlaceholderText(tr("What goes wrong is said here."));
  last_message_->hide();
  add_objects_and_material();

  // The Sandbox's tabs have little height: only two rows are always visible.
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(4, 4, 4, 4);
  layout->setSpacing(4);
  layout->addLayout(scene_buttons());
  layout->addLayout(time_buttons());
  layout->addWidget(tabs(), 1);
  layout->addWidget(last_message_);

  show_settings();
  connect(&timer_, &QTimer::timeout, this, [this] { look_again(); });
  timer_.start(look_every);
}

QLayout* Panel::scene_buttons() {
  auto* row = new QHBoxLayout;
  row->addWidget(button(tr("Open scene..."), tr("A Souple scene (JSON) in the place of all that is there"),
                        [this] { ask_for_scene(); }));
  row->addWidget(button(tr("Clear"), tr("Empties the world; Radium's meshes lie again as they were loaded"),
                        [this] { attempt([this] { clear(); }); }));
  row->addWidget(state_, 1);
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
                        [this] { attempt([this] { playback_.reset(); }); }));
  return row;
}

void Panel::add_objects_and_material() {
  ObjectList::Answers answers;
  answers.selected = [this] { material_->show_object(objects_->object()); };
  answers.about_to_remove = [this] { playback_.host().deselect(); };
  answers.changed = [this] { world_changed(); };
  answers.say = [this](const std::string& message) { say(message); };
  material_ = new MaterialBox(system_.session(), answers.say);
  objects_ = new ObjectList(system_, back_sides_, answers);
}

QWidget* Panel::tabs() {
  auto* all = new QTabWidget;
  all->setDocumentMode(true);
  all->addTab(objects_, tr("Objects"));
  all->addTab(scrolled(material_), tr("Material"));
  all->addTab(scrolled(solver_form()), tr("Solver"));
  all->addTab(scrolled(statistics_), tr("Statistics"));
  all->addTab(log_, tr("Log"));
  return all;
}

QWidget* Panel::solver_form() {
  auto* page = new QWidget;
  auto* form = new QFormLayout(page);
  substeps_ = counter(200);
  iterations_ = counter(200);
  mode_ = new QComboBox;
  for (const std::string& mode : host::Session::modes()) mode_->addItem(QString::fromStdString(mode));
  form->addRow(tr("Substeps"), substeps_);
  form->addRow(tr("Iterations"), iterations_);
  form->addRow(tr("Mode"), mode_);

  auto& session = system_.session();
  connect(substeps_, QOverload<int>::of(&QSpinBox::valueChanged), this,
          [this, &session](int substeps) { attempt([&] { session.set_substeps(substeps); }); });
  connect(iterations_, QOverload<int>::of(&QSpinBox::valueChanged), this,
          [this, &session](int iterations) { attempt([&] { session.set_iterations(iterations); }); });
  connect(mode_, QOverload<int>::of(&QComboBox::activated), this, [this, &session] {
    attempt([&] { session.set_mode(mode_->currentText().toStdString()); });
    material_->show_object(objects_->object());  // parameters depend on the mode
  });
  return page;
}

void Panel::attempt(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::exception& error) {
    say(error.what());
  }
}

void Panel::ask_for_scene() {
  const QString file = QFileDialog::getOpenFileName(this, tr("Open a Souple scene"), last_folder_,
                                                    tr("Souple scenes (*.json);;All files (*)"));
  if (!file.isEmpty()) open_scene(file);
}

void Panel::open_scene(const QString& file) {
  last_folder_ = QFileInfo(file).absolutePath();
  playback_.host().deselect();
  try {
    system_.open_scene(file.toStdString());
  } catch (const std::exception& error) {
    say(error.what());
    return;
  }
  playback_.pause();
  playback_.host().prepare_new();
  playback_.host().look_at_world();
  show_settings();
  world_changed();
  say("opened " + file.toStdString());
}

void Panel::clear() {
  playback_.pause();
  playback_.host().deselect();
  system_.clear();
  show_settings();
  world_changed();
}

void Panel::world_changed() {
  if (back_sides_.match_cloths()) playback_.host().prepare_new();
  objects_->refresh();
  playback_.host().update();
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
  const QString line = QString::fromStdString(message);
  if (last_message_->text() == line) return;  // a step may repeat a message many times
  log_->appendPlainText(line);
  last_message_->setText(line);
  last_message_->show();
}

void Panel::look_again() {
  playback_.check();
  const std::vector<std::string> messages = system_.take_messages();
  for (const std::string& message : messages) say(message);
  // A message may report the deletion of an object in Radium.
  if (playback_.take_scene_change() || !messages.empty()) world_changed();
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
    state_->setText(playback_.radium_plays() ? tr("Radium plays") : tr("playing"));
  } else {
    if (wall_.elapsed() < measure_every) return;
    const double speed = 1000 * (time - time_then_) / static_cast<double>(wall_.elapsed());
    state_->setText(tr("playing, %1 of real time").arg(QString::number(100 * speed, 'f', 0) + " %"));
  }
  wall_.start();
  time_then_ = time;
}

}  // namespace souple::radium
