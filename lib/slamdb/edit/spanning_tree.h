// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/model/spanning_tree.h"
