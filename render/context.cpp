#include "render/context.h"
