-- SPDX-License-Identifier: BSD-3-Clause
-- From version 6 of the store back to version 5, which has nothing of forks: refused while there is any.
CREATE TEMP TABLE step_back (
  forks INTEGER
    CONSTRAINT "the store holds atlases of forks of ORB-SLAM3, which version 5 cannot: remove those atlases"
    CHECK (forks = 0)
);
INSERT INTO step_back SELECT (SELECT count(*) FROM carried) + (SELECT count(*) FROM atlas WHERE layout IS NOT NULL);
DROP TABLE step_back;

DROP TABLE carried;
ALTER TABLE atlas DROP COLUMN layout;
