#pragma once

#include <Core/CoreMacros.hpp>

#define RA_ENGINE_API
