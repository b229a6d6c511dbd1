#include <nlohmann/json.hpp>

#include "slamdb/high/high.h"
#include "slamdb/low/detail/inner.h"
#include "slamdb/low/gone.h"
