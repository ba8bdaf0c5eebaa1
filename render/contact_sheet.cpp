#include "render/contact_sheet.h"
