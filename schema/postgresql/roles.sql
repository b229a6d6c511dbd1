-- SPDX-License-Identifier: BSD-3-Clause
-- Roles of a store, once for a database, by its owner: psql -d maps -f roles.sql. Then GRANT slamdb_reader TO alice.
-- May be run again.
--   owner           who made the store: migrates it, and gives it up
--   slamdb_writer   saves, tags, gives revisions up, removes
--   slamdb_reader   reads
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
GRANT SELECT ON ALL TABLES IN SCHEMA slamdb TO slamdb_reader;
GRANT INSERT, UPDATE, DELETE ON ALL TABLES IN SCHEMA slamdb TO slamdb_writer;
REVOKE INSERT, UPDATE, DELETE ON slamdb.store FROM slamdb_writer;
REVOKE UPDATE, DELETE ON slamdb.history FROM slamdb_writer;  -- what was done is not undone
ALTER DEFAULT PRIVILEGES IN SCHEMA slamdb GRANT SELECT ON TABLES TO slamdb_reader;
ALTER DEFAULT PRIVILEGES IN SCHEMA slamdb GRANT INSERT, UPDATE, DELETE ON TABLES TO slamdb_writer;
