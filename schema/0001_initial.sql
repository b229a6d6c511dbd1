-- SPDX-License-Identifier: BSD-3-Clause
-- The slamdb store, version 1. schema/store.md explains it; the views at the end are the place to start reading.
--
-- Conventions. Lengths are metres, or the map's own unit where a monocular map has no scale; times are seconds; angles of
-- keypoints are degrees. A pose named camera_from_world is the unit quaternion qw qx qy qz and the translation tx ty tz of
-- x_in_camera = rotation * x_in_world + translation; camera axes are x right, y down, z forward.
-- Ids are ORB-SLAM3's, 64 bits, as two's complement integers. NULL in a column that names another entity means none.
-- Flags are the byte as recorded: 0 false, anything else true.
-- REAL columns hold 32-bit floats exactly (timestamps: 64-bit), NULL for NaN. Where a number of a row is a NaN or -0.0,
-- which SQL cannot hold, `exact` has all REAL columns of the row as they were, as packed little-endian floats.
-- `row` numbers of keyframes and points are map * 2^32 + place; ascending order is the order of the list in the file,
-- with gaps where entries were removed.
-- `unique_id` is the id, and NULL in a row that repeats the id of an earlier row; foreign keys refer to it. They are
-- declared for PRAGMA foreign_key_check and not enforced while saving, because damaged atlases are to be kept as well.
-- Hashes are XXH3-64 of what a row means, as two's complement integers.

CREATE TABLE atlas (
  row INTEGER PRIMARY KEY,
  name TEXT NOT NULL UNIQUE,
  vocabulary_name TEXT NOT NULL,              -- file name of the vocabulary that bags of words refer to
  vocabulary_checksum TEXT NOT NULL,          -- MD5 of that file
  next_map INTEGER NOT NULL,                  -- the ids that ORB-SLAM3 hands out next
  next_frame INTEGER NOT NULL,
  next_keyframe INTEGER NOT NULL,
  next_map_point INTEGER NOT NULL,
  next_camera INTEGER NOT NULL,
  next_initial_keyframe INTEGER NOT NULL,
  archive_text INTEGER NOT NULL,              -- how the .osa file was written: 1 text, 0 binary
  archive_boost_version INTEGER NOT NULL,
  archive_long_bytes INTEGER NOT NULL,
  archive_size_bytes INTEGER NOT NULL,
  revision INTEGER NOT NULL,                  -- counts the saves under this name
  saved_at TEXT NOT NULL,                     -- UTC, ISO 8601
  maps INTEGER NOT NULL,
  keyframes INTEGER NOT NULL,
  points INTEGER NOT NULL,
  observations INTEGER NOT NULL,
  hash INTEGER NOT NULL                       -- of everything in the atlas
) STRICT;

CREATE TABLE camera (
  atlas INTEGER NOT NULL REFERENCES atlas (row),
  position INTEGER NOT NULL,                  -- in the atlas' list
  id INTEGER NOT NULL,
  unique_id INTEGER,
  model INTEGER NOT NULL,                     -- 0 pinhole, 1 Kannala-Brandt fisheye
  recorded_type INTEGER NOT NULL,             -- should agree with model
  parameters TEXT NOT NULL,                   -- JSON: fx, fy, cx, cy [pixels], fisheye: k0, k1, k2, k3
  precision REAL,                             -- fisheye: where unprojection stops iterating
  exact BLOB,                                 -- precision, then the parameters
  PRIMARY KEY (atlas, position),
  UNIQUE (atlas, unique_id)
) STRICT, WITHOUT ROWID;

CREATE TABLE map (
  row INTEGER PRIMARY KEY,
  atlas INTEGER NOT NULL REFERENCES atlas (row),
  position INTEGER NOT NULL,                  -- in the atlas' list
  id INTEGER NOT NULL,
  initial_keyframe INTEGER,                   -- fixed in bundle adjustment; may be of another map
  first_keyframe INTEGER,                     -- root of the spanning tree
  lowest_keyframe INTEGER,                    -- smallest id
  max_keyframe_id INTEGER NOT NULL,           -- largest keyframe id ever added
  big_change_index INTEGER NOT NULL,          -- loop closures and the like
  imu_initialized INTEGER NOT NULL,
  inertial INTEGER NOT NULL,
  imu_ba1 INTEGER NOT NULL,                   -- the first and second inertial bundle adjustment are done
  imu_ba2 INTEGER NOT NULL,
  hash INTEGER NOT NULL,
  FOREIGN KEY (row, first_keyframe) REFERENCES keyframe (map, unique_id),
  FOREIGN KEY (row, lowest_keyframe) REFERENCES keyframe (map, unique_id)
) STRICT;
CREATE INDEX map_of_atlas ON map (atlas, position);

-- Roots for global bundle adjustment.
CREATE TABLE map_origin (
  map INTEGER NOT NULL REFERENCES map (row),
  position INTEGER NOT NULL,
  keyframe INTEGER,
  PRIMARY KEY (map, position),
  FOREIGN KEY (map, keyframe) REFERENCES keyframe (map, unique_id)
) STRICT, WITHOUT ROWID;

-- Irregular entries of an .osa file's lists: a null pointer (owner_map NULL), or an object stored once more.
CREATE TABLE repeated_entry (
  atlas INTEGER NOT NULL REFERENCES atlas (row),
  list TEXT NOT NULL CHECK (list IN ('maps', 'cameras', 'keyframes', 'points')),
  map INTEGER NOT NULL,                       -- map.row whose list it is; 0: a list of the atlas
  sequence INTEGER NOT NULL,
  position INTEGER NOT NULL,                  -- in the list of the .osa file
  owner_map INTEGER,                          -- place of the map in the atlas that owns the repeated object
  entry INTEGER NOT NULL,                     -- place of the object in its list there
  PRIMARY KEY (atlas, list, map, sequence)
) STRICT, WITHOUT ROWID;

CREATE TABLE keyframe (
  row INTEGER PRIMARY KEY,
  map INTEGER NOT NULL REFERENCES map (row),
  atlas INTEGER NOT NULL REFERENCES atlas (row),
  id INTEGER NOT NULL,
  unique_id INTEGER,
  hash INTEGER NOT NULL,                      -- of this row
  links_hash INTEGER NOT NULL,                -- of the rows of keyframe_link
  frame_id INTEGER NOT NULL,                  -- the frame that became this keyframe
  timestamp REAL,
  qw REAL, qx REAL, qy REAL, qz REAL,         -- camera_from_world, left camera
  tx REAL, ty REAL, tz REAL,
  vx REAL, vy REAL, vz REAL,                  -- velocity in the world, m/s
  bias_ax REAL, bias_ay REAL, bias_az REAL,   -- IMU bias: accelerometer, m/s^2
  bias_wx REAL, bias_wy REAL, bias_wz REAL,   -- gyroscope, rad/s
  camera INTEGER,
  right_camera INTEGER,                       -- fisheye stereo only
  parent INTEGER,                             -- spanning tree; NULL for its root
  previous INTEGER,                           -- in time
  next INTEGER,
  origin_map INTEGER NOT NULL,                -- id of the map it was made in; that map may be gone
  features INTEGER NOT NULL,                  -- number of keypoints
  left_features INTEGER NOT NULL,             -- -1 unless fisheye stereo
  right_features INTEGER NOT NULL,
  first_connection INTEGER NOT NULL,          -- true until a parent is found
  not_erase INTEGER NOT NULL,                 -- must not be culled
  to_be_erased INTEGER NOT NULL,              -- culled as soon as it may be
  bad INTEGER NOT NULL,                       -- culled
  imu_initialized INTEGER NOT NULL,
  has_velocity INTEGER NOT NULL,
  details BLOB NOT NULL,                      -- packed: intrinsics, image bounds, pyramid, IMU preintegration, ...
  exact BLOB,
  UNIQUE (map, unique_id),
  FOREIGN KEY (atlas, camera) REFERENCES camera (atlas, unique_id),
  FOREIGN KEY (atlas, right_camera) REFERENCES camera (atlas, unique_id),
  FOREIGN KEY (map, parent) REFERENCES keyframe (map, unique_id),
  FOREIGN KEY (map, previous) REFERENCES keyframe (map, unique_id),
  FOREIGN KEY (map, next) REFERENCES keyframe (map, unique_id)
) STRICT;
CREATE INDEX keyframe_by_id ON keyframe (map, id);
CREATE INDEX keyframe_by_time ON keyframe (map, timestamp);

-- Keypoints, descriptors, links to points, grid and bag of words of a keyframe, packed. Layout: schema/store.md.
CREATE TABLE keyframe_features (
  keyframe INTEGER PRIMARY KEY REFERENCES keyframe (row),
  hash INTEGER NOT NULL,                      -- of the columns unpacked
  columns BLOB NOT NULL
) STRICT;

-- Covisibility (weight: map points that both see), spanning tree, loop and merge edges.
CREATE TABLE keyframe_link (
  keyframe INTEGER NOT NULL REFERENCES keyframe (row),
  kind TEXT NOT NULL CHECK (kind IN ('covisible', 'child', 'loop', 'merge')),
  position INTEGER NOT NULL,
  map INTEGER NOT NULL REFERENCES map (row),
  target INTEGER,                             -- keyframe id
  weight INTEGER,                             -- covisible only
  PRIMARY KEY (keyframe, kind, position),
  FOREIGN KEY (map, target) REFERENCES keyframe (map, unique_id)
) STRICT, WITHOUT ROWID;

CREATE TABLE map_point (
  row INTEGER PRIMARY KEY,
  map INTEGER NOT NULL REFERENCES map (row),
  id INTEGER NOT NULL,
  unique_id INTEGER,
  hash INTEGER NOT NULL,                      -- of this row
  observations_hash INTEGER NOT NULL,         -- of its rows of observation
  x REAL, y REAL, z REAL,                     -- world
  nx REAL, ny REAL, nz REAL,                  -- mean unit viewing direction, so at most 1 long
  min_distance REAL, max_distance REAL,       -- range from which it can be recognised
  reference INTEGER,                          -- reference keyframe
  replaced_by INTEGER,                        -- point that it was fused into
  first_keyframe INTEGER NOT NULL,            -- made by it; -1: by a frame
  first_frame INTEGER NOT NULL,
  observation_count INTEGER NOT NULL,         -- a stereo observation counts 2
  bad INTEGER NOT NULL,                       -- culled
  descriptor BLOB NOT NULL,                   -- 256 bits
  descriptor_form INTEGER NOT NULL,           -- 0 usual, 1 usual but "not continuous", 2 empty, 3 empty continuous
  exact BLOB,
  UNIQUE (map, unique_id),
  FOREIGN KEY (map, reference) REFERENCES keyframe (map, unique_id),
  FOREIGN KEY (map, replaced_by) REFERENCES map_point (map, unique_id)
) STRICT;

-- Boxes (here: positions) of the map points for look-up by place; points with a NaN coordinate are not in it.
CREATE VIRTUAL TABLE map_point_box USING rtree (row, min_x, max_x, min_y, max_y, min_z, max_z);

-- "This point is keypoint `left_keypoint` / `right_keypoint` of that keyframe", as the point records it.
CREATE TABLE observation (
  point INTEGER NOT NULL REFERENCES map_point (row),
  position INTEGER NOT NULL,
  map INTEGER NOT NULL REFERENCES map (row),
  keyframe INTEGER,                           -- keyframe id
  left_keypoint INTEGER,                      -- row of the keyframe's keypoints; -1: not seen; NULL: no such entry
  right_keypoint INTEGER,                     -- fisheye stereo: counted from left_features on
  PRIMARY KEY (point, position),
  FOREIGN KEY (map, keyframe) REFERENCES keyframe (map, unique_id)
) STRICT, WITHOUT ROWID;

-- What was done to the store. Stays when an atlas is removed.
CREATE TABLE history (
  row INTEGER PRIMARY KEY AUTOINCREMENT,
  at TEXT NOT NULL,                           -- UTC, ISO 8601
  tool TEXT NOT NULL,                         -- name and version of the program
  action TEXT NOT NULL,                       -- save, remove, migrate
  atlas TEXT,                                 -- name
  provenance TEXT NOT NULL,                   -- what made the atlas, as the caller says
  maps INTEGER, keyframes INTEGER, points INTEGER, observations INTEGER,
  inserted INTEGER, updated INTEGER, deleted INTEGER, unchanged INTEGER,  -- rows
  hash INTEGER                                -- of the atlas
) STRICT;

-- Who writes at the moment; a leftover of a killed program means nothing, since SQLite's own lock decides.
CREATE TABLE writer (
  row INTEGER PRIMARY KEY CHECK (row = 1),
  process INTEGER NOT NULL,
  host TEXT NOT NULL,
  tool TEXT NOT NULL,
  since TEXT NOT NULL
) STRICT;

CREATE VIEW v_atlas AS
SELECT name, maps, keyframes, points, observations, revision, saved_at, vocabulary_name, vocabulary_checksum,
       printf('%016x', hash) AS hash
FROM atlas ORDER BY name;

CREATE VIEW v_camera AS
SELECT atlas.name AS atlas, camera.id AS camera, CASE model WHEN 0 THEN 'pinhole' ELSE 'kannala-brandt' END AS model,
       json_extract(parameters, '$[0]') AS fx, json_extract(parameters, '$[1]') AS fy,  -- pixels
       json_extract(parameters, '$[2]') AS cx, json_extract(parameters, '$[3]') AS cy,
       json_extract(parameters, '$[4]') AS k0, json_extract(parameters, '$[5]') AS k1,
       json_extract(parameters, '$[6]') AS k2, json_extract(parameters, '$[7]') AS k3
FROM camera JOIN atlas ON atlas.row = camera.atlas;

CREATE VIEW v_map AS
SELECT atlas.name AS atlas, map.id AS map, map.inertial, map.imu_initialized, map.initial_keyframe, map.first_keyframe,
       (SELECT count(*) FROM keyframe WHERE keyframe.map = map.row) AS keyframes,
       (SELECT count(*) FROM map_point WHERE map_point.map = map.row) AS points
FROM map JOIN atlas ON atlas.row = map.atlas;

-- The camera's centre in the world (x y z) and world_from_camera as a quaternion, beside camera_from_world as recorded.
-- x_in_world = rotate(wc_q, x_in_camera) + centre.
CREATE VIEW v_keyframe_pose AS
SELECT atlas, map, keyframe, timestamp,
       -(tx + 2 * (qw * ux - qy * uz + qz * uy)) AS x,
       -(ty + 2 * (qw * uy - qz * ux + qx * uz)) AS y,
       -(tz + 2 * (qw * uz - qx * uy + qy * ux)) AS z,
       qw AS wc_qw, -qx AS wc_qx, -qy AS wc_qy, -qz AS wc_qz,
       qw AS cw_qw, qx AS cw_qx, qy AS cw_qy, qz AS cw_qz, tx AS cw_tx, ty AS cw_ty, tz AS cw_tz, bad
FROM (SELECT atlas.name AS atlas, map.id AS map, keyframe.id AS keyframe, timestamp, qw, qx, qy, qz, tx, ty, tz, bad,
             qz * ty - qy * tz AS ux, qx * tz - qz * tx AS uy, qy * tx - qx * ty AS uz
      FROM keyframe JOIN map ON map.row = keyframe.map JOIN atlas ON atlas.row = map.atlas);

CREATE VIEW v_keyframe AS
SELECT atlas.name AS atlas, map.id AS map, keyframe.id AS keyframe, keyframe.timestamp, keyframe.frame_id,
       keyframe.camera, keyframe.features, keyframe.parent, keyframe.previous, keyframe.next, keyframe.origin_map,
       keyframe.bad, keyframe.vx, keyframe.vy, keyframe.vz
FROM keyframe JOIN map ON map.row = keyframe.map JOIN atlas ON atlas.row = map.atlas;

CREATE VIEW v_keyframe_link AS
SELECT atlas.name AS atlas, map.id AS map, keyframe.id AS keyframe, kind, target, weight
FROM keyframe_link JOIN keyframe ON keyframe.row = keyframe_link.keyframe
     JOIN map ON map.row = keyframe.map JOIN atlas ON atlas.row = map.atlas;

CREATE VIEW v_map_point AS
SELECT atlas.name AS atlas, map.id AS map, map_point.id AS point, x, y, z, nx, ny, nz, min_distance, max_distance,
       (SELECT count(*) FROM observation WHERE observation.point = map_point.row) AS observations,
       reference, replaced_by, bad, hex(descriptor) AS descriptor
FROM map_point JOIN map ON map.row = map_point.map JOIN atlas ON atlas.row = map.atlas;

CREATE VIEW v_observation AS
SELECT atlas.name AS atlas, map.id AS map, map_point.id AS point, observation.keyframe, left_keypoint, right_keypoint
FROM observation JOIN map_point ON map_point.row = observation.point
     JOIN map ON map.row = map_point.map JOIN atlas ON atlas.row = map.atlas;
