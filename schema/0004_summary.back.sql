-- SPDX-License-Identifier: BSD-3-Clause
-- From version 4 of the store back to version 3, which has no summaries: nothing is lost, as they follow from the rest.
DROP VIEW v_atlas;
CREATE VIEW v_atlas AS
SELECT name, maps, keyframes, points, observations, revision, saved_at, vocabulary_name, vocabulary_checksum,
       printf('%016x', hash) AS hash
FROM atlas ORDER BY name;

ALTER TABLE atlas DROP COLUMN sensors;
ALTER TABLE atlas DROP COLUMN has_imu;
ALTER TABLE atlas DROP COLUMN is_metric;
ALTER TABLE atlas DROP COLUMN landmarks;
ALTER TABLE atlas DROP COLUMN trajectory_length;
ALTER TABLE atlas DROP COLUMN duration;
ALTER TABLE atlas DROP COLUMN begin_time;
ALTER TABLE atlas DROP COLUMN end_time;
ALTER TABLE atlas DROP COLUMN bytes;
