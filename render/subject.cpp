#include "render/subject.h"
