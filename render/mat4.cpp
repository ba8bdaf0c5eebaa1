#include "render/mat4.h"
