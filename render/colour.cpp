#include "render/colour.h"
