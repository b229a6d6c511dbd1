-- SPDX-License-Identifier: BSD-3-Clause
-- The slamdb store, version 4: what tells atlases apart in a list, so that listing a thousand of them reads none. All of
-- it follows from their rows. Whoever migrates a store fills it in behind this step; NULL stays where an atlas is damaged.
ALTER TABLE atlas ADD COLUMN sensors INTEGER         /* of its maps: sum of 1 monocular, 2 stereo or RGB-D, 4 fisheye stereo */;
ALTER TABLE atlas ADD COLUMN has_imu INTEGER         /* 1: some map has */;
ALTER TABLE atlas ADD COLUMN is_metric INTEGER       /* 0: some map has no known scale */;
ALTER TABLE atlas ADD COLUMN landmarks INTEGER       /* how many */;
ALTER TABLE atlas ADD COLUMN trajectory_length REAL  /* metres, or map units; summed over the maps */;
ALTER TABLE atlas ADD COLUMN duration REAL           /* seconds from first to last keyframe, summed over the maps */;
ALTER TABLE atlas ADD COLUMN begin_time REAL         /* seconds; of the first keyframe, NULL: none has a time */;
ALTER TABLE atlas ADD COLUMN end_time REAL           /* of the last one */;
ALTER TABLE atlas ADD COLUMN bytes INTEGER           /* about what its rows take in the file */;

DROP VIEW v_atlas;
CREATE VIEW v_atlas AS
SELECT name, maps, keyframes, points, observations, revision, saved_at, vocabulary_name, vocabulary_checksum,
       printf('%016x', hash) AS hash, landmarks, trajectory_length, duration, begin_time, end_time, bytes
FROM atlas ORDER BY name;
