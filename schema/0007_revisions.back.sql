-- SPDX-License-Identifier: BSD-3-Clause
-- From version 7 of the store back to version 6, which has the newest revisions alone: refused while there are others,
-- or names or branches of them. Whoever goes
-- back brings lists into the order of their rows, and joins keyframe_features with its pictures, before this step. Of the
-- log, who did what and what changed in the maps goes.
CREATE TEMP TABLE step_back (
  earlier INTEGER
    CONSTRAINT "the store holds earlier revisions, which version 6 cannot: 'slamdb gc --keep 1' gives up those that no tag, branch or restored one keeps; 'slamdb convert STORE#NAME NEW.db#NAME' of each atlas makes a store that can go back"
    CHECK (earlier = 0),
  tags INTEGER
    CONSTRAINT "revisions have tags, which version 6 cannot keep: remove them first, or 'slamdb convert STORE#NAME NEW.db#NAME' of each atlas makes a store that can go back"
    CHECK (tags = 0),
  branches INTEGER
    CONSTRAINT "atlases were branched or merged, of which version 6 cannot know: 'slamdb convert STORE#NAME NEW.db#NAME' of each atlas makes a store that can go back"
    CHECK (branches = 0)
);
INSERT INTO step_back
SELECT (SELECT count(*) FROM revision JOIN atlas ON atlas.row = revision.atlas WHERE number < atlas.revision) +
         (SELECT count(*) FROM past),
       (SELECT count(*) FROM tag),
       (SELECT count(*) FROM revision WHERE from_hash IS NOT NULL);
DROP TABLE step_back;

ALTER TABLE map DROP COLUMN keyframe_order;
ALTER TABLE map DROP COLUMN point_order;
ALTER TABLE map DROP COLUMN landmark_order;

DROP VIEW v_revision;
DROP TABLE tag;
DROP TABLE revision;
DROP TABLE past;
DROP INDEX keyframe_features_by_picture;
DROP TABLE picture;
ALTER TABLE keyframe_features DROP COLUMN picture;
ALTER TABLE keyframe_features RENAME COLUMN points TO columns;
ALTER TABLE history DROP COLUMN who;
ALTER TABLE history DROP COLUMN revision;
ALTER TABLE history DROP COLUMN keyframes_added;
ALTER TABLE history DROP COLUMN keyframes_removed;
ALTER TABLE history DROP COLUMN keyframes_moved;
ALTER TABLE history DROP COLUMN points_added;
ALTER TABLE history DROP COLUMN points_removed;
ALTER TABLE history DROP COLUMN points_moved;
ALTER TABLE history DROP COLUMN observations_added;
ALTER TABLE history DROP COLUMN observations_removed;
