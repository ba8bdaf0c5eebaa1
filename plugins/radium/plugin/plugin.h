#pragma once

#include "plugins/radium/plugin/mouse.h"
#include "plugins/radium/plugin/playback.h"

#include <PluginBase/RadiumPluginInterface.hpp>
#include <QObject>
#include <QPointer>
#include <QtPlugin>
#include <memory>

namespace souple::radium {

class Panel;

/// The plugin that Radium loads: adds the system to the engine, and a panel and the mouse to the window. If one Radium
/// has two instances, only the first is active.
class Plugin : public QObject, public Ra::Plugins::RadiumPluginInterface {
  Q_OBJECT
  Q_RADIUM_PLUGIN_METADATA
  Q_INTERFACES(Ra::Plugins::RadiumPluginInterface)

 public:
  // Radium's engine is destroyed before its plugins: the destructor must not use it.
  Plugin();
  ~Plugin() override;

  void registerPlugin(const Ra::Plugins::Context& context) override;
  bool doAddWidget(QString& name) override;
  QWidget* getWidget() override;
  bool doAddMenu() override { return false; }
  QMenu* getMenu() override { return nullptr; }
  bool doAddAction(int& count) override;
  QAction* getAction(int) override { return nullptr; }

 signals:
  void setContinuousUpdate(bool on);
  void askForUpdate();

 private:
  HostRequests requests(const Ra::Plugins::Context& context);
  Mouse::Answers answers();

  PhysicsSystem* system_ = nullptr;  // owned by the engine; nullptr: another plugin registered it
  BackSides* back_sides_ = nullptr;  // owned by the engine; nullptr: another plugin registered it
  std::unique_ptr<Playback> playback_;
  std::unique_ptr<Mouse> mouse_;
  QPointer<Panel> panel_;  // the window's
};

}  // namespace souple::radium
