#pragma once

#include "souple/contacts/contacts.h"
#include "souple/queries/query.h"
#include "souple/world/contact_tracker.h"

#include <vector>

namespace souple {

/// Contacts of a world, with their input in a step and their reports after it.
struct ContactState {
  Contacts contacts;
  ContactTables tables;  ///< built from objects and colliders
  PairOverrides pairs;
  bool check_intersections = true;  ///< an object was placed without continuous motion
  ContactTracker tracker;
  bool valid = false;         ///< `contacts` holds the result of the last step and may be read
  bool events_valid = false;  ///< `events` match these contacts
  std::vector<ContactEvent> events;

  void invalidate() { valid = events_valid = false; }
};

}  // namespace souple
