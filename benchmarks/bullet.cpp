#include "benchmarks/bullet.h"

#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

namespace souple::peers {

namespace {

btVector3 bullet(const Vec3d& v) {
  return {static_cast<btScalar>(v.x), static_cast<btScalar>(v.y), static_cast<btScalar>(v.z)};
}

/// No collisions and no damping: only integration and the links remain.
class Bullet final : public PeerEngine {
 public:
  Bullet(const PeerScene& input, int substeps, int iterations) : substeps_(substeps) {
    const btVector3 gravity(0, btScalar(-9.81), 0);
    world_.setGravity(gravity);
    world_.getWorldInfo().m_gravity = gravity;
    world_.getWorldInfo().air_density = 0;
    std::vector<btVector3> x;
    std::vector<btScalar> m;
    for (std::size_t i = 0; i < input.positions.size(); ++i) {
      x.push_back(bullet(input.positions[i]));
      m.push_back(static_cast<btScalar>(input.masses[i]));
    }
    // The world deletes its bodies.
    body_ = new btSoftBody(&world_.getWorldInfo(), static_cast<int>(x.size()), x.data(), m.data());
    body_->m_materials[0]->m_kLST = 1;
    body_->m_cfg.piterations = iterations;
    body_->m_cfg.viterations = body_->m_cfg.diterations = body_->m_cfg.citerations = 0;
    body_->m_cfg.kDP = body_->m_cfg.kDG = body_->m_cfg.kLF = 0;
    body_->m_cfg.collisions = 0;
    for (const Edge& link : input.links)
      body_->appendLink(static_cast<int>(link[0]), static_cast<int>(link[1]));
    for (int i = 0; i < body_->m_nodes.size(); ++i)
      if (body_->m_nodes[i].m_im > 0) body_->m_nodes[i].m_v = bullet(input.velocity);
    world_.addSoftBody(body_);
  }
  Bullet(const Bullet&) = delete;
  Bullet& operator=(const Bullet&) = delete;
  ~Bullet() override {
    world_.removeSoftBody(body_);
    delete body_;
  }

  void step(double dt) override {
    for (int i = 0; i < substeps_; ++i) world_.stepSimulation(static_cast<btScalar>(dt / substeps_), 0);
  }
  std::vector<Vec3d> positions() const override {
    std::vector<Vec3d> result;
    for (int i = 0; i < body_->m_nodes.size(); ++i) {
      const btVector3& x = body_->m_nodes[i].m_x;
      result.push_back({double(x.x()), double(x.y()), double(x.z())});
    }
    return result;
  }

 private:
  btSoftBodyRigidBodyCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  btSoftRigidDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
  btSoftBody* body_ = nullptr;
  int substeps_;
};

}  // namespace

std::unique_ptr<PeerEngine> make_bullet(const PeerScene& input, int substeps, int iterations) {
  return std::make_unique<Bullet>(input, substeps, iterations);
}

}  // namespace souple::peers
