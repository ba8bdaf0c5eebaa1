#include "render/film.h"
