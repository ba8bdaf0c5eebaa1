#include "plugins/radium/plugin/plugin.h"

#include "plugins/radium/plugin/panel.h"

#include <Core/Asset/Camera.hpp>
#include <Engine/RadiumEngine.hpp>
#include <Engine/Rendering/Renderer.hpp>
#include <Engine/Scene/Entity.hpp>
#include <Engine/Scene/EntityManager.hpp>
#include <Gui/SelectionManager/SelectionManager.hpp>
#include <Gui/Viewer/CameraManipulator.hpp>
#include <Gui/Viewer/Viewer.hpp>
#include <PluginBase/PluginContext.hpp>
#include <QCoreApplication>
#include <QLabel>

namespace souple::radium {

namespace {

QWidget* second_panel() {
  auto* words =
      new QLabel(QObject::tr("Souple is loaded twice. This panel does nothing: use the other one, "
                             "and remove one of the two files from Radium's plugin directories."));
  words->setWordWrap(true);
  words->setAlignment(Qt::AlignTop);
  words->setMargin(12);
  return words;
}

/// Aims the camera at the objects, not at the floor, which may be large; from above, the front of a floor.
void look_at(Ra::Gui::Viewer& viewer, PhysicsSystem& system) {
  Ra::Core::Aabb box;
  for (auto* entity : Ra::Engine::RadiumEngine::getInstance()->getEntityManager()->getEntities())
    if (!system.getEntityComponents(entity).empty()) box.extend(entity->computeAabb());
  if (box.isEmpty()) return;
  viewer.fitCameraToScene(box);
  auto& camera = *viewer.getCameraManipulator();
  const Ra::Core::Vector3 center = box.center(), from = Ra::Core::Vector3(0.4f, 0.5f, 1).normalized();
  camera.setCameraPosition(center + (camera.getCamera()->getPosition() - center).norm() * from);
  camera.setCameraTarget(center);
}

}  // namespace

Plugin::Plugin() = default;
Plugin::~Plugin() = default;

void Plugin::registerPlugin(const Ra::Plugins::Context& context) {
  system_ = PhysicsSystem::add_to(*context.m_engine);
  if (system_ == nullptr) return;
  connect(this, &Plugin::setContinuousUpdate, &context, &Ra::Plugins::Context::setContinuousUpdate);
  connect(this, &Plugin::askForUpdate, &context, &Ra::Plugins::Context::askForUpdate);

  back_sides_ = BackSides::add_to(*context.m_engine, *system_);
  playback_ = std::make_unique<Playback>(*context.m_engine, *system_, requests(context));
  mouse_ = std::make_unique<Mouse>(*context.m_viewer, *system_, *back_sides_, answers());
  connect(qApp, &QCoreApplication::aboutToQuit, this, [this] { playback_->pause(); });
}

HostRequests Plugin::requests(const Ra::Plugins::Context& context) {
  auto& viewer = *context.m_viewer;
  HostRequests requests;
  requests.continuous_update = [this](bool on) { emit setContinuousUpdate(on); };
  requests.update = [this] { emit askForUpdate(); };
  requests.prepare_new = [&viewer] {
    viewer.makeCurrent();
    viewer.getRenderer()->buildAllRenderTechniques();
    viewer.doneCurrent();
  };
  requests.look_at_world = [&viewer, this] { look_at(viewer, *system_); };
  requests.deselect = [selection = context.m_selectionManager] {
    if (selection != nullptr) selection->clear();
  };
  return requests;
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
  panel_ = new Panel(*system_, *back_sides_, *playback_);
  return panel_;
}

bool Plugin::doAddAction(int& count) {
  count = 0;
  return false;
}

}  // namespace souple::radium
