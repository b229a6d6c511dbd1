-- SPDX-License-Identifier: BSD-3-Clause
-- The slamdb store, version 2: landmarks as MRPT has them, beside the points of a map.

-- Rows are map * 2^32 + place, as those of points. Lengths are metres or map units, as those of the map. REAL columns
-- hold 64-bit floats; where one is a NaN or -0.0, `exact` has all twelve as they were.
CREATE TABLE landmark (
  row INTEGER PRIMARY KEY,
  map INTEGER NOT NULL REFERENCES map (row),
  id INTEGER NOT NULL,                        -- -1: none
  unique_id INTEGER,
  hash INTEGER NOT NULL,                      -- of this row
  x REAL, y REAL, z REAL,                     -- mean position, world
  nx REAL, ny REAL, nz REAL,                  -- unit viewing direction, or zero
  cov_11 REAL, cov_22 REAL, cov_33 REAL,      -- covariance of the mean; all zero: not known
  cov_12 REAL, cov_13 REAL, cov_23 REAL,
  last_seen INTEGER NOT NULL,                 -- 100 ns since 1601-01-01 UTC; 0: not known
  seen_count INTEGER NOT NULL,
  features BLOB NOT NULL,                     -- keypoints with descriptors, packed. Layout: schema/store.md
  exact BLOB,
  UNIQUE (map, unique_id)
) STRICT;

-- last_seen: seconds since 1970.
CREATE VIEW v_landmark AS
SELECT atlas.name AS atlas, map.id AS map, landmark.id AS landmark, x, y, z, nx, ny, nz,
       cov_11, cov_22, cov_33, cov_12, cov_13, cov_23,
       CASE last_seen WHEN 0 THEN NULL ELSE (last_seen - 116444736000000000) / 1e7 END AS last_seen, seen_count
FROM landmark JOIN map ON map.row = landmark.map JOIN atlas ON atlas.row = map.atlas;
