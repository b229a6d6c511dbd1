-- SPDX-License-Identifier: BSD-3-Clause
-- The slamdb store, version 3: what ORB-SLAM3 knows of a map point while it runs, and no .osa file holds. NULL: not
-- recorded.
ALTER TABLE map_point ADD COLUMN origin_map INTEGER     /* id of the map that the point was made in */;
ALTER TABLE map_point ADD COLUMN visible_count INTEGER  /* frames in which it should have been seen, from 1 on */;
ALTER TABLE map_point ADD COLUMN found_count INTEGER    /* frames in which it was found there, from 1 on */;

DROP VIEW v_map_point;
CREATE VIEW v_map_point AS
SELECT atlas.name AS atlas, map.id AS map, map_point.id AS point, x, y, z, nx, ny, nz, min_distance, max_distance,
       (SELECT count(*) FROM observation WHERE observation.point = map_point.row) AS observations,
       reference, replaced_by, bad, hex(descriptor) AS descriptor, origin_map, visible_count, found_count
FROM map_point JOIN map ON map.row = map_point.map JOIN atlas ON atlas.row = map.atlas;
