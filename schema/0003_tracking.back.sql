-- SPDX-License-Identifier: BSD-3-Clause
-- From version 3 of the store back to version 2, which has no origins and counters of points: refused while there are
-- any.
CREATE TEMP TABLE step_back (
  points INTEGER
    CONSTRAINT "the store holds origins or counters of map points, which version 2 cannot: remove the atlases that have some"
    CHECK (points = 0)
);
INSERT INTO step_back SELECT count(*) FROM map_point
WHERE coalesce(origin_map, visible_count, found_count) IS NOT NULL;
DROP TABLE step_back;

DROP VIEW v_map_point;
CREATE VIEW v_map_point AS
SELECT atlas.name AS atlas, map.id AS map, map_point.id AS point, x, y, z, nx, ny, nz, min_distance, max_distance,
       (SELECT count(*) FROM observation WHERE observation.point = map_point.row) AS observations,
       reference, replaced_by, bad, hex(descriptor) AS descriptor
FROM map_point JOIN map ON map.row = map_point.map JOIN atlas ON atlas.row = map.atlas;

ALTER TABLE map_point DROP COLUMN origin_map;
ALTER TABLE map_point DROP COLUMN visible_count;
ALTER TABLE map_point DROP COLUMN found_count;
