#pragma once

#include "souple/rigid/contact_finder.h"
#include "souple/rigid/joints/joint.h"

#include <vector>

namespace souple {

/// The state of all rigid bodies, with their joints and contacts, in a snapshot.
struct SavedRigidBodies {
  struct Body {
    BodyPose pose;
    BodyVelocity velocity;
    double shown = 0;
  };
  std::vector<Body> bodies;
  std::vector<joint::JointState> joints;
  ContactFinder::Saved contacts;
};

}  // namespace souple
