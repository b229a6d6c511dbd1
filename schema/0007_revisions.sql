-- SPDX-License-Identifier: BSD-3-Clause
-- The slamdb store, version 7: every save is a revision that can be read again, and pictures are stored once. Whoever
-- migrates a store splits keyframe_features behind this step.

-- Views come last in the schema, behind all tables: of a damaged file the end of the schema is what is lost first.
DROP VIEW v_atlas;
DROP VIEW v_camera;
DROP VIEW v_map;
DROP VIEW v_keyframe_pose;
DROP VIEW v_keyframe;
DROP VIEW v_keyframe_link;
DROP VIEW v_map_point;
DROP VIEW v_observation;
DROP VIEW v_landmark;

CREATE TABLE picture (
  -- What a keyframe's picture gave, packed: its features but for their links to points, which are in
  -- keyframe_features.points. A row is shared by all keyframes that have the same to the last bit: of one atlas or
  -- several, of the newest revision or of earlier ones.
  row INTEGER PRIMARY KEY,
  hash INTEGER NOT NULL,                      -- XXH3-64 of the bytes in `columns`, by which it is looked for
  columns BLOB NOT NULL                       -- keypoints, descriptors, grid, words: schema/store.md
) STRICT;
CREATE INDEX picture_by_hash ON picture (hash);

ALTER TABLE keyframe_features RENAME COLUMN columns TO points;
ALTER TABLE keyframe_features ADD COLUMN picture INTEGER REFERENCES picture (row)  /* never NULL */;
CREATE INDEX keyframe_features_by_picture ON keyframe_features (picture);

ALTER TABLE map ADD COLUMN keyframe_order BLOB  /* rows of its keyframes as they are in the list, packed; NULL: ascending */;
ALTER TABLE map ADD COLUMN point_order BLOB     /* likewise */;
ALTER TABLE map ADD COLUMN landmark_order BLOB  /* likewise */;

CREATE TABLE past (
  -- The other tables hold the newest revision of each atlas. Here stands what they held before: what each save changed,
  -- as it was until then. Revision r of an atlas is its rows with all that was changed since r put back: of each part
  -- that stands here with an `until` above r, what the lowest of those says; of all other parts, what the tables say.
  -- What can be read of them is what `slamdb convert STORE.db#NAME@3 map.osa` writes; in SQL they are bytes.
  atlas INTEGER NOT NULL REFERENCES atlas (row),
  until INTEGER NOT NULL,                     -- the revision whose save changed it
  -- Which rows of which table, as one: 0 atlas, 1 camera (all of the atlas), 2 repeated_entry (likewise), 3 map,
  -- 4 map_origin (all of the map), 5 keyframe, 6 keyframe_features, 7 keyframe_link (all of the keyframe), 8 map_point,
  -- 9 observation (all of the point), 10 landmark, 11 to 15 carried (of the atlas, its cameras, a map, a keyframe, a point).
  part INTEGER NOT NULL,
  row INTEGER NOT NULL,                       -- of the atlas, map, keyframe, point or landmark whose it is
  picture INTEGER REFERENCES picture (row),   -- that of the keyframe, where part is 6: it must not go
  rows BLOB NOT NULL,                         -- all their columns, packed: schema/store.md; empty: there were none
  PRIMARY KEY (atlas, until, part, row)
) STRICT, WITHOUT ROWID;
CREATE INDEX past_by_picture ON past (picture) WHERE picture IS NOT NULL;
CREATE INDEX past_maps ON past (row) WHERE part = 3;

CREATE TABLE revision (
  -- The revisions of an atlas that can be read: the newest, and those that `slamdb gc` has not given up. What made one,
  -- when, and who, is in `history`, where it stays when the revision goes.
  atlas INTEGER NOT NULL REFERENCES atlas (row),
  number INTEGER NOT NULL,                    -- counts the saves that changed the atlas, from 1
  history INTEGER NOT NULL REFERENCES history (row),
  -- What it was made of besides the revision before it: where it was branched off, or what was merged into it. NULL:
  -- nothing else. The name may be another atlas' by now; the hash says whether it is.
  from_atlas TEXT,                            -- name of the atlas
  from_number INTEGER,                        -- of the revision
  from_hash INTEGER,                          -- atlas.hash of that revision
  PRIMARY KEY (atlas, number)
) STRICT, WITHOUT ROWID;

CREATE TABLE tag (
  -- Names of revisions, by which STORE.db#NAME@TAG reads them. One that has a name stays when `slamdb gc` gives others up.
  atlas INTEGER NOT NULL REFERENCES atlas (row),
  name TEXT NOT NULL,                         -- without @, {, }, # and /, and no number
  number INTEGER NOT NULL,                    -- of the revision
  PRIMARY KEY (atlas, name),
  FOREIGN KEY (atlas, number) REFERENCES revision (atlas, number)
) STRICT, WITHOUT ROWID;

-- What a save changed in the map; NULL where nobody counted.
ALTER TABLE history ADD COLUMN who TEXT               /* user@host */;
ALTER TABLE history ADD COLUMN revision INTEGER       /* that it made */;
ALTER TABLE history ADD COLUMN keyframes_added INTEGER;
ALTER TABLE history ADD COLUMN keyframes_removed INTEGER;
ALTER TABLE history ADD COLUMN keyframes_moved INTEGER      /* that have another pose */;
ALTER TABLE history ADD COLUMN points_added INTEGER;
ALTER TABLE history ADD COLUMN points_removed INTEGER;
ALTER TABLE history ADD COLUMN points_moved INTEGER         /* that have another position */;
ALTER TABLE history ADD COLUMN observations_added INTEGER   /* a keypoint of a keyframe that is a point */;
ALTER TABLE history ADD COLUMN observations_removed INTEGER /* likewise */;

-- The newest revision of each atlas can be read, as far as it is known which save made it.
INSERT INTO revision (atlas, number, history)
SELECT atlas.row, atlas.revision, max(history.row) FROM atlas JOIN history ON history.atlas = atlas.name
WHERE history.action = 'save' GROUP BY atlas.row;
UPDATE history SET revision = (SELECT number FROM revision WHERE revision.history = history.row)
WHERE row IN (SELECT history FROM revision);

CREATE VIEW v_atlas AS
SELECT name, maps, keyframes, points, observations, revision, saved_at, vocabulary_name, vocabulary_checksum,
       printf('%016x', hash) AS hash, landmarks, trajectory_length, duration, begin_time, end_time, bytes
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
       reference, replaced_by, bad, hex(descriptor) AS descriptor, origin_map, visible_count, found_count
FROM map_point JOIN map ON map.row = map_point.map JOIN atlas ON atlas.row = map.atlas;

CREATE VIEW v_observation AS
SELECT atlas.name AS atlas, map.id AS map, map_point.id AS point, observation.keyframe, left_keypoint, right_keypoint
FROM observation JOIN map_point ON map_point.row = observation.point
     JOIN map ON map.row = map_point.map JOIN atlas ON atlas.row = map.atlas;

-- last_seen: seconds since 1970.
CREATE VIEW v_landmark AS
SELECT atlas.name AS atlas, map.id AS map, landmark.id AS landmark, x, y, z, nx, ny, nz,
       cov_11, cov_22, cov_33, cov_12, cov_13, cov_23,
       CASE last_seen WHEN 0 THEN NULL ELSE (last_seen - 116444736000000000) / 1e7 END AS last_seen, seen_count
FROM landmark JOIN map ON map.row = landmark.map JOIN atlas ON atlas.row = map.atlas;

CREATE VIEW v_revision AS
SELECT atlas.name AS atlas, revision.number AS revision, at, who, tool, provenance, history.maps, history.keyframes,
       history.points, history.observations, from_atlas, from_number,
       (SELECT group_concat(tag.name, ' ') FROM tag
        WHERE tag.atlas = revision.atlas AND tag.number = revision.number) AS tags,
       printf('%016x', history.hash) AS hash
FROM revision JOIN atlas ON atlas.row = revision.atlas JOIN history ON history.row = revision.history
ORDER BY atlas.name, revision.number;
