#include "slamdb/low/low.h"
