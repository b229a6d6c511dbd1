// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/format.h"

namespace slamdb::detail {

// `store`: atlases in a SQLite file, see store.h. A Location without name means the only atlas of the store, when
// reading or writing; in a new store, `atlas`. Writing to a name that is taken needs `overwrite`.
extern const Format kStoreFormat;

}  // namespace slamdb::detail
