#include "slamdb/low/detail/inner.h"
