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

/// What Radium loads: brings the system into the engine, and a panel and the mouse into the window. Of two
/// in one Radium only the first does something.
class Plugin : public QObject, public Ra::Plugins::RadiumPluginInterface {
  Q_OBJECT
  Q_RADIUM_PLUGIN_METADATA
  Q_INTERFACES(Ra::Plugins::RadiumPluginInterface)

 public:
  // Radium's engine is gone when a plugin is destroyed: nothing here speaks to it then.
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

  PhysicsSystem* system_ = nullptr;  // the engine's; nullptr: another plugin has brought it
  BackSides* back_sides_ = nullptr;  // the same
  std::unique_ptr<Playback> playback_;
  std::unique_ptr<Mouse> mouse_;
  QPointer<Panel> panel_;  // the window's
};

}  // namespace souple::radium
