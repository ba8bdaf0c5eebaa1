#include "plugins/radium/plugin/plugin.h"

#include "plugins/radium/plugin/panel.h"

#include <Engine/RadiumEngine.hpp>
#include <Gui/Viewer/Viewer.hpp>
#include <PluginBase/PluginContext.hpp>
#include <QCoreApplication>
#include <QLabel>

namespace souple::radium {

namespace {

QWidget* second_panel() {
  auto* words = new QLabel(QObject::tr("Souple is loaded twice. This panel does nothing: use the other one, "
                                       "and remove one of the two files from Radium's plugin directories."));
  words->setWordWrap(true);
  words->setAlignment(Qt::AlignTop);
  words->setMargin(12);
  return words;
}

}  // namespace

Plugin::Plugin() = default;
Plugin::~Plugin() = default;

void Plugin::registerPlugin(const Ra::Plugins::Context& context) {
  system_ = PhysicsSystem::add_to(*context.m_engine);
  if (system_ == nullptr) return;
  connect(this, &Plugin::setContinuousUpdate, &context, &Ra::Plugins::Context::setContinuousUpdate);
  connect(this, &Plugin::askForUpdate, &context, &Ra::Plugins::Context::askForUpdate);

  auto* viewer = context.m_viewer;
  HostRequests requests;
  requests.continuous_update = [this](bool on) { emit setContinuousUpdate(on); };
  requests.update = [this] { emit askForUpdate(); };
  requests.show_new = [this, viewer] {
    viewer->prepareDisplay();
    emit askForUpdate();
  };
  playback_ = std::make_unique<Playback>(*context.m_engine, *system_, requests);
  mouse_ = std::make_unique<Mouse>(*viewer, *system_, answers());
  connect(qApp, &QCoreApplication::aboutToQuit, this, [this] { playback_->pause(); });
}

Mouse::Answers Plugin::answers() {
  Mouse::Answers answers;
  answers.picked = [this](host::Handle object) {
    if (panel_) panel_->select(object);
  };
  answers.say = [this](const std::string& message) {
    if (panel_) panel_->say(message);
  };
  answers.update = [this] { emit askForUpdate(); };
  return answers;
}

bool Plugin::doAddWidget(QString& name) {
  name = "Souple";
  return true;
}

QWidget* Plugin::getWidget() {
  if (system_ == nullptr) return second_panel();
  panel_ = new Panel(*system_, *playback_);
  return panel_;
}

bool Plugin::doAddAction(int& count) {
  count = 0;
  return false;
}

}  // namespace souple::radium
