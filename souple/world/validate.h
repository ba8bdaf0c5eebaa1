#pragma once

#include "souple/stages/settings.h"

namespace souple {

/// Throws Error with the setting, its value and the expected range.
void validate(const Settings& settings);

}  // namespace souple
