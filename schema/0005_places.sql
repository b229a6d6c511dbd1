-- SPDX-License-Identifier: BSD-3-Clause
-- The slamdb store, version 5: what keyframes look like, so that a picture is looked for in a thousand atlases without
-- reading them. It follows from keyframe_features, and is in no hash. Whoever migrates a store fills it in behind this
-- step; of rows that were deleted here, those of an atlas come back when it is saved.

-- Which of 4,096 words a keyframe's (left) picture shows. The words are those of 0005_places.words: a tree of ORB
-- descriptors, the same for all stores. No row where the features are damaged.
CREATE TABLE keyframe_words (
  keyframe INTEGER PRIMARY KEY REFERENCES keyframe (row),
  hash INTEGER NOT NULL,                      -- keyframe_features.hash of what they were found in
  words BLOB NOT NULL                         -- 512 bytes, little endian: bit w % 8 of byte w / 8 is word w
) STRICT;
