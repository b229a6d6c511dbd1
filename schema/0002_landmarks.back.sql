-- SPDX-License-Identifier: BSD-3-Clause
-- From version 2 of the store back to version 1, which has no landmarks: refused while there are any.
CREATE TEMP TABLE step_back (
  landmarks INTEGER
    CONSTRAINT "the store holds landmarks, which version 1 cannot: remove the atlases that have some"
    CHECK (landmarks = 0)
);
INSERT INTO step_back SELECT count(*) FROM landmark;
DROP TABLE step_back;

DROP VIEW v_landmark;
DROP TABLE landmark;
