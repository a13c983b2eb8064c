-- A day of quarantine is emptied in slices, between which others commit, before it is dropped.

-- Deletes the oldest rows of the oldest day of quarantine that ends at or before `before`, at most
-- `rows_max`, and keeps the Rejects among them that a Hello may still ask for (at most 10,000 per session)
-- in kept_rejects, in the same transaction. Looks at no row that arrived before `since`: those that earlier
-- calls deleted are passed over. The day is null where there is none. first_at: the arrival of the first row
-- that went. Runs as the owner. The days are those of drop_partitions.
CREATE FUNCTION take_quarantine(before date, since timestamptz, rows_max integer,
  OUT day date, OUT first_at timestamptz, OUT taken integer, OUT kept integer)
LANGUAGE plpgsql SECURITY DEFINER
SET search_path = uplinkd, pg_temp SET lock_timeout = '1500ms' SET timezone = 'UTC' AS $$
DECLARE
  part name;
BEGIN
  IF before > ((now() + interval '10 minutes') AT TIME ZONE 'UTC')::date - 1 THEN
    RAISE EXCEPTION 'days before % are not all older than a day', before USING ERRCODE = '22023';
  END IF;
  IF rows_max IS NULL OR rows_max NOT BETWEEN 1 AND 10000 THEN
    RAISE EXCEPTION 'rows_max is %, outside 1 to 10000', rows_max USING ERRCODE = '22023';
  END IF;
  PERFORM pg_advisory_xact_lock(hashtext('uplinkd.partitions'));
  SELECT c.relname INTO part FROM pg_inherits AS i JOIN pg_class AS c ON c.oid = i.inhrelid
    WHERE i.inhparent = 'uplinkd.quarantine'::regclass AND c.relname ~ '^quarantine_[0-9]{8}$'
      AND to_date(right(c.relname, 8), 'YYYYMMDD') < before
    ORDER BY c.relname LIMIT 1;
  IF part IS NULL THEN
    RETURN;
  END IF;
  day := to_date(right(part, 8), 'YYYYMMDD');
  EXECUTE format(
    'WITH went AS (DELETE FROM %1$I WHERE ctid = ANY (ARRAY('
    ' SELECT ctid FROM %1$I WHERE received_at >= $1 ORDER BY received_at, entry LIMIT $2))'
    ' RETURNING ruri, session, seq, entry, received_at, source, reason, field, detail),'
    ' kept AS (INSERT INTO kept_rejects (ruri, session, last, first, entry, reason, field, detail)'
    ' SELECT q.ruri, q.session, q.seq, q.seq, q.entry, q.reason, q.field, q.detail FROM went AS q'
    ' CROSS JOIN LATERAL (SELECT l.first_entry, l.settled_seq FROM sessions AS l'
    ' WHERE l.ruri = q.ruri AND l.session = q.session ORDER BY l.part DESC LIMIT 1) AS s'
    ' WHERE q.source = 0 AND q.entry >= s.first_entry AND q.seq > s.settled_seq'
    ' ON CONFLICT DO NOTHING RETURNING 1)'
    ' SELECT (SELECT min(received_at) FROM went), (SELECT count(*) FROM went),'
    ' (SELECT count(*) FROM kept)', part)
    INTO first_at, taken, kept USING since, rows_max;
END $$;
REVOKE EXECUTE ON FUNCTION take_quarantine FROM PUBLIC;

-- As in 0022, but that a day of quarantine is dropped only if it is empty: take_quarantine empties it. What
-- commits a row of that day meanwhile is waited for, and then the day stays.
CREATE OR REPLACE FUNCTION drop_partitions(history_name text, before date)
RETURNS integer LANGUAGE plpgsql SECURITY DEFINER
SET search_path = uplinkd, pg_temp SET lock_timeout = '1500ms' SET timezone = 'UTC' AS $$
DECLARE
  part record;
  filled bigint;
  dropped integer := 0;
BEGIN
  IF NOT EXISTS (SELECT FROM histories() AS h WHERE h.parent = history_name) THEN
    RAISE EXCEPTION '% is no history', history_name USING ERRCODE = '22023';
  END IF;
  IF before > ((now() + interval '10 minutes') AT TIME ZONE 'UTC')::date - 1 THEN
    RAISE EXCEPTION 'days before % are not all older than a day', before USING ERRCODE = '22023';
  END IF;
  PERFORM pg_advisory_xact_lock(hashtext('uplinkd.partitions'));
  FOR part IN
    SELECT c.relname FROM pg_inherits AS i JOIN pg_class AS c ON c.oid = i.inhrelid
      WHERE i.inhparent = format('uplinkd.%I', history_name)::regclass
        AND c.relname ~ ('^' || history_name || '_[0-9]{8}$')
        AND to_date(right(c.relname, 8), 'YYYYMMDD') < before
      ORDER BY c.relname LIMIT 10
  LOOP
    IF history_name = 'quarantine' THEN
      -- Before the lock, so that a day that has rows holds up no commit. By the index in which
      -- take_quarantine looked.
      EXECUTE format('SELECT entry FROM %I ORDER BY received_at, entry LIMIT 1', part.relname) INTO filled;
      EXIT WHEN filled IS NOT NULL;
      -- Writers lock the table before its day, as DROP does.
      LOCK TABLE ONLY quarantine IN ACCESS EXCLUSIVE MODE;
      EXECUTE format('SELECT entry FROM %I ORDER BY received_at, entry LIMIT 1', part.relname) INTO filled;
      EXIT WHEN filled IS NOT NULL;
    END IF;
    EXECUTE format('DROP TABLE %I', part.relname);
    dropped := dropped + 1;
  END LOOP;
  RETURN dropped;
END $$;

-- raise_sequences asks for the greatest at each connect.
CREATE INDEX kept_rejects_by_entry ON kept_rejects (entry);
