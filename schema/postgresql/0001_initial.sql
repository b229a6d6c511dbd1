-- SPDX-License-Identifier: BSD-3-Clause
-- The slamdb store in PostgreSQL, version 1. schema/postgresql.md explains it; the views at the end are the place to
-- start reading. The words are those of the store in SQLite (schema/*.sql), and so are units, ids and hashes.
--
-- Every save of an atlas that changes it makes a revision. Rows say which revisions have them: `since` is the first,
-- `until` the first that has them no more, 2147483647 while the newest has. Revision r is the rows of its atlas with
-- since <= r AND until > r.
-- Keys begin with the atlas, by which tables are partitioned: all of an atlas is on one partition. Those of the large
-- tables go on with `until`: no two rows of an entity end together, and one index has what the newest revision has in
-- one place and in order.
-- `row` numbers of keyframes, points and landmarks are map * 2^32 + place, as in SQLite; maps are numbered within their
-- atlas. Ids are 64 bits as two's complement; NULL in a column that names another entity means none, -1 in an array.
-- Flags are the byte as recorded. NULL in a REAL column is NaN; where a number is NaN or -0.0, `exact` has all of a row.
-- Entities are not bound by foreign keys, because damaged atlases are to be kept as well: v_dangling shows what dangles.

CREATE TABLE store (
  row integer PRIMARY KEY DEFAULT 1 CHECK (row = 1),
  version integer NOT NULL,                   -- of this schema
  partitions integer NOT NULL
);
COMMENT ON TABLE store IS 'The store itself: one row.';

-- Differences tell an index only which ranges lie close to each other. Where a number would not hold them, as of what
-- uninitialised memory left, PostgreSQL has errors.
CREATE FUNCTION bounded_difference(a double precision, b double precision) RETURNS double precision
  LANGUAGE sql IMMUTABLE STRICT AS $$ SELECT greatest(least(a, 1e300), -1e300) - greatest(least(b, 1e300), -1e300) $$;
CREATE TYPE span AS RANGE (SUBTYPE = double precision, SUBTYPE_DIFF = bounded_difference);

CREATE TABLE atlas (
  row bigint GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
  name text COLLATE "C" NOT NULL UNIQUE,      -- in the order of its bytes
  project text NOT NULL DEFAULT coalesce(current_setting('slamdb.project', true), ''),  -- for row_level_security.sql
  revision integer NOT NULL,                  -- the newest
  hash bigint NOT NULL,                       -- of everything in it
  saved_at timestamptz NOT NULL,
  maps bigint NOT NULL,
  keyframes bigint NOT NULL,
  points bigint NOT NULL,
  observations bigint NOT NULL,
  landmarks bigint NOT NULL,
  sensors integer NOT NULL,                   -- of its maps: sum of 1 monocular, 2 stereo or RGB-D, 4 fisheye stereo
  has_imu integer NOT NULL,                   -- 1: some map has
  is_metric integer NOT NULL,                 -- 0: some map has no known scale
  trajectory_length double precision NOT NULL,  -- metres, or map units; summed over the maps
  duration double precision NOT NULL,         -- seconds from first to last keyframe, summed over the maps
  begin_time double precision,                -- seconds; of the first keyframe, NULL: none has a time
  end_time double precision,
  bytes bigint NOT NULL                       -- about what its newest revision takes
);
COMMENT ON TABLE atlas IS 'An atlas, and what a list tells of its newest revision.';

CREATE TABLE history (
  row bigint GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
  at timestamptz NOT NULL,
  tool text NOT NULL,                         -- name and version of the program
  action text NOT NULL,                       -- save, remove, migrate
  atlas text,                                 -- name
  provenance text NOT NULL,                   -- what made the atlas, as the caller says
  maps bigint, keyframes bigint, points bigint, observations bigint,
  inserted bigint, updated bigint, deleted bigint, unchanged bigint,  -- rows
  hash bigint,                                -- of the atlas
  who text NOT NULL,                          -- user@host
  project text NOT NULL DEFAULT '',           -- of the atlas
  revision integer,                           -- that it made
  xid bigint NOT NULL DEFAULT (pg_current_xact_id()::text::numeric % 4294967296)::bigint,  -- of the transaction: rows with another xmin were edited
  keyframes_added bigint, keyframes_removed bigint, keyframes_moved bigint,
  points_added bigint, points_removed bigint, points_moved bigint,
  observations_added bigint, observations_removed bigint
);
CREATE INDEX history_by_atlas ON history (atlas, row);
COMMENT ON TABLE history IS 'What was done to the store. Stays when an atlas is removed.';

CREATE TABLE revision (
  atlas bigint NOT NULL REFERENCES atlas (row) ON DELETE CASCADE,
  number integer NOT NULL,                    -- counts the saves that changed the atlas, from 1
  history bigint NOT NULL REFERENCES history (row),
  hash bigint NOT NULL,                       -- of everything in it
  from_atlas text, from_number integer, from_hash bigint,  -- what it was made of besides the one before it; NULL: nothing
  vocabulary_name bytea NOT NULL,             -- file name of the vocabulary that bags of words refer to, as recorded
  vocabulary_checksum bytea NOT NULL,         -- MD5 of that file, likewise
  next_map bigint NOT NULL,                   -- the ids that ORB-SLAM3 hands out next
  next_frame bigint NOT NULL,
  next_keyframe bigint NOT NULL,
  next_map_point bigint NOT NULL,
  next_camera bigint NOT NULL,
  next_initial_keyframe bigint NOT NULL,
  archive_text integer NOT NULL,              -- how the .osa file was written: 1 text, 0 binary
  archive_boost_version bigint NOT NULL,
  archive_long_bytes integer NOT NULL,
  archive_size_bytes integer NOT NULL,
  layout bytea,                               -- of a fork's file: what `carried` of its entities means
  carried bytea,                              -- what the fork's file has of the atlas
  PRIMARY KEY (atlas, number)
);
CREATE INDEX revision_by_history ON revision (history);
CREATE INDEX revision_by_source ON revision (from_atlas, from_number);
COMMENT ON TABLE revision IS 'The revisions that can be read, each with what of an atlas is no list.';

CREATE TABLE tag (
  atlas bigint NOT NULL,
  name text NOT NULL,                         -- without @, {, }, # and /, and no number
  number integer NOT NULL,
  PRIMARY KEY (atlas, name),
  FOREIGN KEY (atlas, number) REFERENCES revision (atlas, number) ON DELETE CASCADE
);
COMMENT ON TABLE tag IS 'Names of revisions. One that has a name stays when gc gives others up.';

CREATE TABLE camera (
  atlas bigint NOT NULL,
  position integer NOT NULL,                  -- in the atlas' list
  id bigint NOT NULL,
  unique_id bigint,                           -- NULL where an earlier one has that id
  model integer NOT NULL,                     -- 0 pinhole, 1 Kannala-Brandt fisheye, 2 equirectangular
  recorded_type bigint NOT NULL,              -- should agree with model
  parameters text NOT NULL,                   -- JSON: fx, fy, cx, cy [pixels], fisheye: k0, k1, k2, k3
  precision real,                             -- fisheye: where unprojection stops iterating
  exact bytea,                                -- precision, then the parameters
  hash bigint NOT NULL,
  carried bytea,
  since integer NOT NULL,
  until integer NOT NULL DEFAULT 2147483647,
  PRIMARY KEY (atlas, position, since)
) PARTITION BY HASH (atlas);

CREATE TABLE map (
  row bigint NOT NULL,                        -- from 1 on within the atlas
  atlas bigint NOT NULL,
  position integer NOT NULL,                  -- in the atlas' list
  id bigint NOT NULL,
  initial_keyframe bigint,                    -- fixed in bundle adjustment; may be of another map
  first_keyframe bigint,                      -- root of the spanning tree
  lowest_keyframe bigint,                     -- smallest id
  max_keyframe_id bigint NOT NULL,            -- largest keyframe id ever added
  big_change_index integer NOT NULL,          -- loop closures and the like
  imu_initialized smallint NOT NULL,
  inertial smallint NOT NULL,
  imu_ba1 smallint NOT NULL,                  -- the first and second inertial bundle adjustment are done
  imu_ba2 smallint NOT NULL,
  hash bigint NOT NULL,
  keyframe_order bytea,                       -- places of its keyframes as they are in the list, packed; NULL: ascending
  point_order bytea,
  landmark_order bytea,
  origins bigint[] NOT NULL,                  -- keyframes: roots for global bundle adjustment
  carried bytea,
  times span,                                 -- of its good keyframes; what a search looks at first
  x span, y span, z span,                     -- of its good points and landmarks
  since integer NOT NULL,
  until integer NOT NULL DEFAULT 2147483647,
  PRIMARY KEY (atlas, row, since)
) PARTITION BY HASH (atlas);
CREATE INDEX map_by_time ON map USING gist (times) WHERE until = 2147483647;
CREATE INDEX map_by_place ON map USING gist (x, y, z) WHERE until = 2147483647;

CREATE TABLE repeated_entry (
  atlas bigint NOT NULL,
  list text NOT NULL CHECK (list IN ('maps', 'cameras', 'keyframes', 'points')),
  map bigint NOT NULL,                        -- map.row whose list it is; 0: a list of the atlas
  sequence integer NOT NULL,
  position bigint NOT NULL,                   -- in the list of the .osa file
  owner_map bigint,                           -- place of the map in the atlas that owns the repeated object
  entry bigint NOT NULL,                      -- place of the object in its list there
  since integer NOT NULL,
  until integer NOT NULL DEFAULT 2147483647,
  PRIMARY KEY (atlas, list, map, sequence, since)
) PARTITION BY HASH (atlas);

CREATE TABLE keyframe (
  row bigint NOT NULL,
  map bigint NOT NULL,
  atlas bigint NOT NULL,
  id bigint NOT NULL,
  unique_id bigint,                           -- NULL where an earlier one of the list has that id
  hash bigint NOT NULL,                       -- of this row
  links_hash bigint NOT NULL,                 -- of its links
  frame_id bigint NOT NULL,                   -- the frame that became this keyframe
  timestamp double precision,
  qw real, qx real, qy real, qz real,         -- camera_from_world, left camera
  tx real, ty real, tz real,
  vx real, vy real, vz real,                  -- velocity in the world, m/s
  bias_ax real, bias_ay real, bias_az real,   -- IMU bias: accelerometer, m/s^2
  bias_wx real, bias_wy real, bias_wz real,   -- gyroscope, rad/s
  camera bigint,
  right_camera bigint,                        -- fisheye stereo only
  parent bigint,                              -- spanning tree; NULL for its root
  previous bigint,                            -- in time
  next bigint,
  origin_map bigint NOT NULL,                 -- id of the map it was made in; that map may be gone
  features integer NOT NULL,                  -- number of keypoints
  left_features integer NOT NULL,             -- -1 unless fisheye stereo
  right_features integer NOT NULL,
  first_connection smallint NOT NULL,         -- true until a parent is found
  not_erase smallint NOT NULL,                -- must not be culled
  to_be_erased smallint NOT NULL,             -- culled as soon as it may be
  bad smallint NOT NULL,                      -- culled
  imu_initialized smallint NOT NULL,
  has_velocity smallint NOT NULL,
  details bytea NOT NULL,                     -- packed: intrinsics, image bounds, pyramid, IMU preintegration: schema/store.md
  exact bytea,
  children bigint[] NOT NULL,                 -- its links: ids of keyframes
  connections bigint[] NOT NULL,              -- covisibility graph
  weights integer[] NOT NULL,                 -- of each: map points that both see
  loop_edges bigint[] NOT NULL,
  merge_edges bigint[] NOT NULL,
  carried bytea,
  since integer NOT NULL,
  until integer NOT NULL DEFAULT 2147483647,
  PRIMARY KEY (atlas, until, row)
) PARTITION BY HASH (atlas);
ALTER TABLE keyframe ALTER COLUMN details SET STORAGE EXTERNAL;

CREATE TABLE keyframe_features (
  atlas bigint NOT NULL,
  keyframe bigint NOT NULL,                   -- keyframe.row
  hash bigint NOT NULL,                       -- of the columns unpacked
  source_hash bigint NOT NULL,                -- of what the packed columns follow from besides: image bounds, kind of camera
  points bytea NOT NULL,                      -- links to map points, packed: schema/store.md
  picture uuid NOT NULL,                      -- picture.hash
  since integer NOT NULL,
  until integer NOT NULL DEFAULT 2147483647,
  PRIMARY KEY (atlas, until, keyframe)
) PARTITION BY HASH (atlas);
ALTER TABLE keyframe_features ALTER COLUMN points SET STORAGE EXTERNAL;

CREATE TABLE picture (
  atlas bigint NOT NULL,
  hash uuid NOT NULL,                         -- XXH3-128 of the bytes in `columns`: what is the same is there once
  columns bytea NOT NULL,                     -- keypoints, descriptors, grid, words: schema/store.md
  PRIMARY KEY (atlas, hash)
) PARTITION BY HASH (atlas);
ALTER TABLE picture ALTER COLUMN columns SET STORAGE EXTERNAL;

CREATE TABLE keyframe_words (
  atlas bigint NOT NULL,
  keyframe bigint NOT NULL,                   -- keyframe.row, of the newest revision
  hash bigint NOT NULL,                       -- keyframe_features.hash of what they were found in
  words bytea NOT NULL,                       -- which of 4,096 words its picture shows: 512 bytes, schema/store.md
  PRIMARY KEY (atlas, keyframe)
) PARTITION BY HASH (atlas);
ALTER TABLE keyframe_words ALTER COLUMN words SET STORAGE PLAIN;

-- A picture is held against these first: an eighth of the rows of keyframe_words.
CREATE TABLE place (
  atlas bigint NOT NULL,
  map bigint NOT NULL,                        -- map.row
  number integer NOT NULL,                    -- of eight keyframes that follow each other by their ids, from 0
  shown integer NOT NULL,                     -- how many of `words` are set
  words bit(4096) NOT NULL,                   -- that two of these keyframes show at least
  PRIMARY KEY (atlas, map, number)
) PARTITION BY HASH (atlas);
ALTER TABLE place ALTER COLUMN words SET STORAGE PLAIN;

CREATE TABLE map_point (
  row bigint NOT NULL,
  map bigint NOT NULL,
  id bigint NOT NULL,
  unique_id bigint,
  hash bigint NOT NULL,                       -- of this row
  observations_hash bigint NOT NULL,
  x real, y real, z real,                     -- world
  nx real, ny real, nz real,                  -- mean unit viewing direction, so at most 1 long
  min_distance real, max_distance real,       -- range from which it can be recognised
  reference bigint,                           -- reference keyframe
  replaced_by bigint,                         -- point that it was fused into
  first_keyframe bigint NOT NULL,             -- made by it; -1: by a frame
  first_frame bigint NOT NULL,
  observation_count integer NOT NULL,         -- a stereo observation counts 2
  bad smallint NOT NULL,                      -- culled
  descriptor bytea NOT NULL,                  -- 256 bits
  descriptor_form smallint NOT NULL,          -- 0 usual, 1 usual but "not continuous", 2 empty, 3 empty continuous
  exact bytea,
  origin_map bigint,                          -- NULL: not recorded, as in .osa files
  visible_count bigint,
  found_count bigint,
  seen_by bigint[] NOT NULL,                  -- its observations: ids of keyframes
  left_keypoints integer[] NOT NULL,          -- of each: row of the keyframe's keypoints, -1 not seen, -2147483648 no such entry
  right_keypoints integer[] NOT NULL,         -- fisheye stereo: counted from left_features on
  carried bytea,
  atlas bigint NOT NULL,
  since integer NOT NULL,
  until integer NOT NULL DEFAULT 2147483647,
  PRIMARY KEY (atlas, until, row)
) PARTITION BY HASH (atlas);


CREATE TABLE landmark (
  row bigint NOT NULL,
  map bigint NOT NULL,
  id bigint NOT NULL,
  unique_id bigint,
  hash bigint NOT NULL,
  x double precision, y double precision, z double precision,  -- world
  nx double precision, ny double precision, nz double precision,  -- from the landmark to the sensors
  cov_11 double precision, cov_22 double precision, cov_33 double precision,
  cov_12 double precision, cov_13 double precision, cov_23 double precision,
  last_seen bigint NOT NULL,                  -- MRPT's time: 100 ns since 1601; 0 unknown
  seen_count bigint NOT NULL,
  features bytea NOT NULL,                    -- schema/store.md
  exact bytea,
  atlas bigint NOT NULL,
  since integer NOT NULL,
  until integer NOT NULL DEFAULT 2147483647,
  PRIMARY KEY (atlas, until, row)
) PARTITION BY HASH (atlas);

COMMENT ON TABLE camera IS 'A camera model.';
COMMENT ON TABLE map IS 'A map, and where and when it lies.';
COMMENT ON TABLE repeated_entry IS 'Irregular entries of an .osa file''s lists: a null pointer (owner_map NULL), or an object stored once more.';
COMMENT ON TABLE keyframe IS 'A keyframe with its links, without its features.';
COMMENT ON TABLE keyframe_features IS 'The features of a keyframe: its links to points, and the picture that has the rest.';
COMMENT ON TABLE picture IS 'What a picture gave, packed: shared by all keyframes of the atlas that have the same to the last bit.';
COMMENT ON TABLE keyframe_words IS 'What a keyframe looks like, so that a picture is looked for without reading atlases.';
COMMENT ON TABLE place IS 'What eight neighbouring keyframes look like: which atlases know a picture is asked of these.';
COMMENT ON TABLE map_point IS 'A map point with its observations.';
COMMENT ON TABLE landmark IS 'An MRPT landmark of a map.';

-- ---- to read in SQL: the newest revision of each atlas

CREATE VIEW v_atlas AS
SELECT name, maps, keyframes, points, observations, atlas.revision, saved_at, encode(vocabulary_name, 'escape') AS vocabulary_name,
       encode(vocabulary_checksum, 'escape') AS vocabulary_checksum, lpad(to_hex(atlas.hash), 16, '0') AS hash, landmarks,
       trajectory_length, duration, begin_time, end_time, bytes
FROM atlas LEFT JOIN revision ON revision.atlas = atlas.row AND revision.number = atlas.revision;

CREATE VIEW v_camera AS
SELECT name AS atlas, id AS camera, CASE model WHEN 0 THEN 'pinhole' WHEN 1 THEN 'kannala-brandt' ELSE 'equirectangular' END AS model,
       (parameters::jsonb ->> 0)::double precision AS fx, (parameters::jsonb ->> 1)::double precision AS fy,
       (parameters::jsonb ->> 2)::double precision AS cx, (parameters::jsonb ->> 3)::double precision AS cy,
       (parameters::jsonb ->> 4)::double precision AS k0, (parameters::jsonb ->> 5)::double precision AS k1,
       (parameters::jsonb ->> 6)::double precision AS k2, (parameters::jsonb ->> 7)::double precision AS k3
FROM camera JOIN atlas ON atlas.row = camera.atlas WHERE until = 2147483647;

CREATE VIEW v_map AS
SELECT atlas.name AS atlas, map.id AS map, map.inertial, map.imu_initialized, map.initial_keyframe, map.first_keyframe,
       (SELECT count(*) FROM keyframe WHERE keyframe.atlas = map.atlas AND keyframe.row BETWEEN map.row << 32 AND (map.row << 32) + 4294967295 AND keyframe.until = 2147483647) AS keyframes,
       (SELECT count(*) FROM map_point WHERE map_point.atlas = map.atlas AND map_point.row BETWEEN map.row << 32 AND (map.row << 32) + 4294967295 AND map_point.until = 2147483647) AS points,
       map.times, map.x, map.y, map.z
FROM map JOIN atlas ON atlas.row = map.atlas WHERE map.until = 2147483647;

-- The camera's centre in the world (x y z) and world_from_camera as a quaternion, beside camera_from_world as recorded.
CREATE VIEW v_keyframe_pose AS
SELECT atlas, map, keyframe, timestamp,
       -(tx + 2 * (qw * ux - qy * uz + qz * uy)) AS x,
       -(ty + 2 * (qw * uy - qz * ux + qx * uz)) AS y,
       -(tz + 2 * (qw * uz - qx * uy + qy * ux)) AS z,
       qw AS wc_qw, -qx AS wc_qx, -qy AS wc_qy, -qz AS wc_qz,
       qw AS cw_qw, qx AS cw_qx, qy AS cw_qy, qz AS cw_qz, tx AS cw_tx, ty AS cw_ty, tz AS cw_tz, bad
FROM (SELECT atlas.name AS atlas, map.id AS map, keyframe.id AS keyframe, timestamp, qw::double precision AS qw,
             qx::double precision AS qx, qy::double precision AS qy, qz::double precision AS qz, tx, ty, tz, bad,
             qz::double precision * ty - qy::double precision * tz AS ux,
             qx::double precision * tz - qz::double precision * tx AS uy,
             qy::double precision * tx - qx::double precision * ty AS uz
      FROM keyframe JOIN map ON map.atlas = keyframe.atlas AND map.row = keyframe.map AND map.until = 2147483647
           JOIN atlas ON atlas.row = keyframe.atlas WHERE keyframe.until = 2147483647) AS poses;

CREATE VIEW v_keyframe AS
SELECT atlas.name AS atlas, map.id AS map, keyframe.id AS keyframe, keyframe.timestamp, keyframe.frame_id,
       keyframe.camera, keyframe.features, keyframe.parent, keyframe.previous, keyframe.next, keyframe.origin_map,
       keyframe.bad, keyframe.vx, keyframe.vy, keyframe.vz
FROM keyframe JOIN map ON map.atlas = keyframe.atlas AND map.row = keyframe.map AND map.until = 2147483647
     JOIN atlas ON atlas.row = keyframe.atlas WHERE keyframe.until = 2147483647;

CREATE VIEW v_keyframe_link AS
SELECT atlas.name AS atlas, map.id AS map, keyframe.id AS keyframe, kind, nullif(target, -1) AS target, weight
FROM keyframe JOIN map ON map.atlas = keyframe.atlas AND map.row = keyframe.map AND map.until = 2147483647
     JOIN atlas ON atlas.row = keyframe.atlas
     CROSS JOIN LATERAL (
       SELECT 'child' AS kind, target, NULL::integer AS weight FROM unnest(children) AS target
       UNION ALL SELECT 'covisible', target, weight FROM unnest(connections, weights) AS link (target, weight)
       UNION ALL SELECT 'loop', target, NULL FROM unnest(loop_edges) AS target
       UNION ALL SELECT 'merge', target, NULL FROM unnest(merge_edges) AS target) AS links
WHERE keyframe.until = 2147483647;

CREATE VIEW v_map_point AS
SELECT atlas.name AS atlas, map.id AS map, map_point.id AS point, map_point.x, map_point.y, map_point.z, nx, ny, nz,
       min_distance, max_distance, cardinality(seen_by) AS observations, reference, replaced_by, bad,
       upper(encode(descriptor, 'hex')) AS descriptor, origin_map, visible_count, found_count
FROM map_point JOIN map ON map.atlas = map_point.atlas AND map.row = map_point.map AND map.until = 2147483647
     JOIN atlas ON atlas.row = map_point.atlas WHERE map_point.until = 2147483647;

CREATE VIEW v_observation AS
SELECT atlas.name AS atlas, map.id AS map, map_point.id AS point, nullif(seen.keyframe, -1) AS keyframe,
       nullif(seen.left_keypoint, -2147483648) AS left_keypoint, nullif(seen.right_keypoint, -2147483648) AS right_keypoint
FROM map_point JOIN map ON map.atlas = map_point.atlas AND map.row = map_point.map AND map.until = 2147483647
     JOIN atlas ON atlas.row = map_point.atlas
     CROSS JOIN LATERAL unnest(seen_by, left_keypoints, right_keypoints) AS seen (keyframe, left_keypoint, right_keypoint)
WHERE map_point.until = 2147483647;

CREATE VIEW v_landmark AS
SELECT atlas.name AS atlas, map.id AS map, landmark.id AS landmark, landmark.x, landmark.y, landmark.z, nx, ny, nz,
       cov_11, cov_22, cov_33, cov_12, cov_13, cov_23,
       CASE last_seen WHEN 0 THEN NULL ELSE (last_seen - 116444736000000000) / 1e7 END AS last_seen, seen_count
FROM landmark JOIN map ON map.atlas = landmark.atlas AND map.row = landmark.map AND map.until = 2147483647
     JOIN atlas ON atlas.row = landmark.atlas WHERE landmark.until = 2147483647;

CREATE VIEW v_revision AS
SELECT atlas.name AS atlas, revision.number AS revision, history.at, who, tool, provenance, history.maps, history.keyframes,
       history.points, history.observations, from_atlas, from_number,
       (SELECT string_agg(tag.name, ' ' ORDER BY tag.name) FROM tag
        WHERE tag.atlas = revision.atlas AND tag.number = revision.number) AS tags,
       lpad(to_hex(revision.hash), 16, '0') AS hash, encode(vocabulary_name, 'escape') AS vocabulary_name
FROM revision JOIN atlas ON atlas.row = revision.atlas JOIN history ON history.row = revision.history;

-- What points and keyframes name that is not there.
CREATE VIEW v_dangling AS
SELECT 'point' AS entity, atlas, map, point AS id, 'observation' AS reference, keyframe AS missing
FROM v_observation WHERE keyframe IS NOT NULL AND NOT EXISTS (
  SELECT 1 FROM v_keyframe WHERE v_keyframe.atlas = v_observation.atlas AND v_keyframe.map = v_observation.map AND v_keyframe.keyframe = v_observation.keyframe)
UNION ALL
SELECT 'keyframe', atlas, map, keyframe, kind, target
FROM v_keyframe_link WHERE target IS NOT NULL AND NOT EXISTS (
  SELECT 1 FROM v_keyframe WHERE v_keyframe.atlas = v_keyframe_link.atlas AND v_keyframe.map = v_keyframe_link.map AND v_keyframe.keyframe = v_keyframe_link.target);
