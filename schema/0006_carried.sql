-- SPDX-License-Identifier: BSD-3-Clause
-- The slamdb store, version 6: what files of ORB-SLAM3's forks have and the model does not know.

-- Which layout they are of: the id of a known one, or its JSON (schema/layouts.md). NULL: ORB-SLAM3 v1.0.
ALTER TABLE atlas ADD COLUMN layout TEXT;

-- No row where there is nothing, as in every atlas of ORB-SLAM3 itself.
CREATE TABLE carried (
  kind INTEGER NOT NULL,                      -- 0 atlas, 1 camera, 2 map, 3 keyframe, 4 map_point
  row INTEGER NOT NULL,                       -- of that table; of a camera: atlas * 2^32 + position
  bytes BLOB NOT NULL,                        -- members and descriptors, packed. Layout: schema/store.md
  PRIMARY KEY (kind, row)
) STRICT, WITHOUT ROWID;
