-- SPDX-License-Identifier: BSD-3-Clause
-- From version 2 of the store back to version 1, which has no landmarks: refused while there are any.
CREATE TEMP TABLE step_back (landmarks INTEGER);
CREATE TEMP TRIGGER step_back_refused BEFORE INSERT ON step_back WHEN NEW.landmarks > 0 BEGIN
  SELECT RAISE(ABORT, 'the store holds landmarks, which version 1 cannot: remove the atlases that have some');
END;
INSERT INTO step_back SELECT count(*) FROM landmark;
DROP TABLE step_back;

DROP VIEW v_landmark;
DROP TABLE landmark;
