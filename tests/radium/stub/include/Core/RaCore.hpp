#pragma once

#include <Core/CoreMacros.hpp>

#define RA_CORE_API
