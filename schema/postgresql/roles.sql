-- SPDX-License-Identifier: BSD-3-Clause
-- Roles of a store, once for a database, by its owner: psql -d maps -f roles.sql. Then GRANT slamdb_reader TO alice.
-- May be run again, and does all or nothing.
--   owner           who made the store: migrates it, and gives it up
--   slamdb_writer   saves, tags, gives revisions up, removes
--   slamdb_reader   reads
BEGIN;
SET LOCAL client_min_messages TO warning;
DO $$
BEGIN
  CREATE ROLE slamdb_reader NOLOGIN;
EXCEPTION WHEN duplicate_object OR unique_violation THEN NULL;
END $$;
DO $$
BEGIN
  CREATE ROLE slamdb_writer NOLOGIN;
EXCEPTION WHEN duplicate_object OR unique_violation THEN NULL;
END $$;
GRANT slamdb_reader TO slamdb_writer;
GRANT USAGE ON SCHEMA slamdb TO slamdb_reader;

-- Partitions are met through the tables that they are of. Their own rights matter to who names them: where rows are
-- shown by project (row_level_security.sql), nobody may.
DO $$
DECLARE
  each regclass;
  by_project boolean := (SELECT relrowsecurity FROM pg_class WHERE oid = 'slamdb.atlas'::regclass);
BEGIN
  FOR each IN SELECT oid FROM pg_class
              WHERE relnamespace = 'slamdb'::regnamespace AND relkind IN ('r', 'p', 'v', 'f') AND NOT (relispartition AND by_project) LOOP
    EXECUTE format('GRANT SELECT ON %s TO slamdb_reader', each);
    EXECUTE format('GRANT INSERT, UPDATE, DELETE ON %s TO slamdb_writer', each);
  END LOOP;
END $$;
REVOKE INSERT, UPDATE, DELETE ON slamdb.store FROM slamdb_writer;
REVOKE UPDATE, DELETE ON slamdb.history FROM slamdb_writer;  -- what was done is not undone
COMMIT;
