#include "plugins/radium/plugin/object_list.h"

#include <QCheckBox>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QPushButton>
#include <QSignalBlocker>
#include <QTreeWidget>
#include <QVBoxLayout>
#include <exception>
#include <utility>

namespace souple::radium {

namespace {

constexpr int visible_rows = 4;

QString words_of(host::Kind kind) {
  if (kind == host::Kind::obstacle) return QObject::tr("collider");
  return QString(host::kind_name(kind)).replace('_', ' ');
}

}  // namespace

ObjectList::ObjectList(PhysicsSystem& system, BackSides& back_sides, Answers answers)
    : system_(system),
      back_sides_(back_sides),
      answers_(std::move(answers)),
      table_(new QTreeWidget),
      remover_(new QPushButton(tr("Remove"))),
      self_collision_(new QCheckBox(tr("New cloth collides with itself"))) {
  table_->setHeaderLabels({tr("Mesh"), tr("Is"), tr("Triangles")});
  table_->setRootIsDecorated(false);
  table_->header()->setStretchLastSection(false);
  table_->header()->setSectionResizeMode(0, QHeaderView::Stretch);
  for (int column : {1, 2}) table_->header()->setSectionResizeMode(column, QHeaderView::ResizeToContents);
  table_->setMinimumHeight(visible_rows * fontMetrics().lineSpacing());
  connect(table_, &QTreeWidget::currentItemChanged, this, [this] {
    enable_buttons();
    answers_.selected();
  });

  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 4, 0, 0);
  layout->setSpacing(4);
  layout->addWidget(table_, 1);
  add_buttons();
  layout->addWidget(self_collision_);
  enable_buttons();
}

void ObjectList::add_buttons() {
  auto* buttons = new QHBoxLayout;
  const std::pair<const char*, host::Kind> kinds[] = {{"Make cloth", host::Kind::cloth},
                                                      {"Soft body", host::Kind::soft_body},
                                                      {"Rigid body", host::Kind::rigid_body},
                                                      {"Collider", host::Kind::obstacle}};
  for (const auto& [label, kind] : kinds) {
    auto* button = new QPushButton(tr(label));
    connect(button, &QPushButton::clicked, this, [this, kind = kind] { make(kind); });
    buttons->addWidget(button);
    makers_.push_back(button);
  }
  makers_[0]->setToolTip(tr("The selected mesh becomes cloth: its edges resist stretching and bending."));
  makers_[1]->setToolTip(tr("The selected mesh, which has to be closed, becomes elastic."));
  makers_[2]->setToolTip(
      tr("The selected mesh falls and collides as it is: each of its pieces as its convex hull."));
  makers_[3]->setToolTip(tr("Others touch the selected mesh; it moves only when you move it in Radium."));
  remover_->setToolTip(tr("Takes the selected object out of the world; a mesh lies again as it was loaded."));
  connect(remover_, &QPushButton::clicked, this, [this] { remove(); });
  buttons->addWidget(remover_);
  static_cast<QVBoxLayout*>(layout())->addLayout(buttons);
}

std::vector<ObjectList::Row> ObjectList::rows() const {
  const host::Session& session = system_.session();
  std::vector<Row> rows;
  for (const host::ObjectInfo& info : session.objects())
    if (info.from_scene)
      rows.push_back(
          {{}, info.handle, QString::fromStdString(info.name), words_of(info.kind), info.triangle_count});
  for (const LoadedMesh& mesh : system_.loaded_meshes()) {
    if (back_sides_.contains(mesh.render_object)) continue;
    const QString kind = mesh.object == 0 ? tr("mesh") : words_of(session.object(mesh.object).kind);
    rows.push_back(
        {mesh.render_object, mesh.object, QString::fromStdString(mesh.name), kind, mesh.triangle_count});
  }
  return rows;
}

void ObjectList::refresh() {
  const Row before = selected() != nullptr ? *selected() : Row{};
  rows_ = rows();
  {
    const QSignalBlocker quiet(table_);
    table_->clear();
    for (const Row& row : rows_) {
      auto* item = new QTreeWidgetItem({row.name, row.kind, QString::number(row.triangles)});
      item->setToolTip(0, row.name);
      item->setTextAlignment(2, Qt::AlignRight);
      table_->addTopLevelItem(item);
      const bool is_same = row.render_object.isValid()
                               ? row.render_object.getValue() == before.render_object.getValue()
                               : row.object != 0 && row.object == before.object;
      if (is_same) table_->setCurrentItem(item);
    }
  }
  enable_buttons();
  answers_.selected();
}

void ObjectList::select(host::Handle object) {
  for (std::size_t i = 0; i < rows_.size(); ++i)
    if (rows_[i].object == object) table_->setCurrentItem(table_->topLevelItem(static_cast<int>(i)));
}

const ObjectList::Row* ObjectList::selected() const {
  const int at = table_->indexOfTopLevelItem(table_->currentItem());
  return at < 0 ? nullptr : &rows_[static_cast<std::size_t>(at)];
}

host::Handle ObjectList::object() const {
  return selected() != nullptr ? selected()->object : 0;
}

void ObjectList::make(host::Kind kind) {
  if (selected() == nullptr) return;
  host::MeshOptions options;
  options.self_collision = kind == host::Kind::cloth && self_collision_->isChecked();
  try {
    system_.add(selected()->render_object, kind, options);
  } catch (const std::exception& error) {
    answers_.say(error.what());
  }
  answers_.changed();
}

void ObjectList::remove() {
  if (object() == 0) return;
  answers_.about_to_remove();
  try {
    system_.remove(object());
  } catch (const std::exception& error) {
    answers_.say(error.what());
  }
  answers_.changed();
}

void ObjectList::enable_buttons() {
  const bool is_mesh = selected() != nullptr && selected()->object == 0;
  for (QPushButton* button : makers_) button->setEnabled(is_mesh);
  remover_->setEnabled(object() != 0);
}

}  // namespace souple::radium
