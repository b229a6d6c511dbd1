-- SPDX-License-Identifier: BSD-3-Clause
-- From version 5 of the store back to version 4, which does not say what keyframes look like: nothing is lost, as that
-- follows from the rest.
DROP TABLE keyframe_words;
