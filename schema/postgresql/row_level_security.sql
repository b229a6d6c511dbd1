-- SPDX-License-Identifier: BSD-3-Clause
-- Who sees which atlases, by project, once for a database, by its owner: psql -d maps -f row_level_security.sql. Off
-- until then. May be run again, before roles.sql and after it, and does all or nothing; ALTER TABLE ... DISABLE ROW LEVEL SECURITY takes it back.
-- A project is a role: CREATE ROLE warehouse NOLOGIN; GRANT warehouse TO alice. Who is a member sees its atlases; those
-- of no project are everybody's. An atlas is made in the project that its writer's `slamdb.project` names, as with
-- PGOPTIONS='-c slamdb.project=warehouse' or ALTER ROLE alice SET slamdb.project = 'warehouse'; where none is named, a branch
-- in that of what it was branched off, and all else in none, so that everybody sees it.
-- The owner of the tables, superusers and roles with BYPASSRLS see all.
-- Names of atlases are one for all projects: that a name is taken is not hidden. Who saves needs the right to make
-- temporary tables (GRANT TEMPORARY ON DATABASE), which everybody has by default.
BEGIN;
SET LOCAL client_min_messages TO warning;
SET LOCAL search_path TO slamdb, pg_temp;

-- Names in full, as anybody can make temporary tables of any name.
CREATE OR REPLACE FUNCTION is_member(project text) RETURNS boolean LANGUAGE sql STABLE SET search_path = pg_catalog, pg_temp AS $$
  SELECT project = '' OR EXISTS (SELECT 1 FROM pg_catalog.pg_roles WHERE rolname = project AND pg_catalog.pg_has_role(current_user, oid, 'MEMBER'))
$$;

ALTER TABLE atlas ENABLE ROW LEVEL SECURITY;
DROP POLICY IF EXISTS by_project ON atlas;
CREATE POLICY by_project ON atlas USING (slamdb.is_member(project)) WITH CHECK (slamdb.is_member(project));

DO $$
DECLARE
  each text;
  role text;
BEGIN
  FOREACH each IN ARRAY ARRAY['revision', 'tag', 'camera', 'map', 'repeated_entry', 'keyframe', 'keyframe_features',
                              'picture', 'keyframe_words', 'place', 'map_point', 'landmark'] LOOP
    EXECUTE format('ALTER TABLE %I ENABLE ROW LEVEL SECURITY', each);
    EXECUTE format('DROP POLICY IF EXISTS by_project ON %I', each);
    EXECUTE format('CREATE POLICY by_project ON %I USING (atlas IN (SELECT row FROM slamdb.atlas))', each);
  END LOOP;
  -- Partitions are tables of their own, which nobody needs to name: rights are those of the table that they are of.
  FOR each IN SELECT inhrelid::regclass::text FROM pg_inherits JOIN pg_class ON pg_class.oid = inhrelid
              WHERE relnamespace = 'slamdb'::regnamespace AND relkind IN ('r', 'f') LOOP
    FOR role IN SELECT 'PUBLIC' UNION ALL SELECT rolname FROM pg_roles WHERE rolname IN ('slamdb_reader', 'slamdb_writer') LOOP
      EXECUTE format('REVOKE ALL ON %s FROM %s', each, role);
    END LOOP;
  END LOOP;
END $$;

ALTER TABLE history ENABLE ROW LEVEL SECURITY;
DROP POLICY IF EXISTS by_project ON history;
DROP POLICY IF EXISTS entered ON history;
CREATE POLICY by_project ON history FOR SELECT USING (slamdb.is_member(project));
CREATE POLICY entered ON history FOR INSERT WITH CHECK (true);

-- Views show what who looks may see, not what their owner may (PostgreSQL 15).
DO $$
DECLARE
  each text;
BEGIN
  FOR each IN SELECT viewname FROM pg_views WHERE schemaname = 'slamdb' LOOP
    EXECUTE format('ALTER VIEW %I SET (security_invoker = true)', each);
  END LOOP;
END $$;
COMMIT;
