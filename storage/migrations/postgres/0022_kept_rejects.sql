-- Rejects that are kept for their robot alone, until a Hello confirms them: ranges of numbers that were
-- over their rate, and what retention takes out of quarantine before that. entry: as of quarantine.
CREATE TABLE kept_rejects (
  ruri text COLLATE "C" NOT NULL,
  session uuid NOT NULL,
  last bigint NOT NULL,
  first bigint NOT NULL,
  entry bigint NOT NULL,
  reason integer NOT NULL,
  field text NOT NULL,
  detail text NOT NULL,
  PRIMARY KEY (ruri, session, last)
);

-- The function of 0009, which now keeps the Rejects of the days that go. Who may run it stays as it is.

-- Drops the partitions of one history that end at or before `before`, the oldest first, at most ten a
-- call; returns how many. Runs as the owner. Yesterday and what comes after it is never dropped: no
-- history is kept for less than a day. Clocks may differ by ten minutes: shortly before midnight, a
-- server's day is the next one already. Of quarantine, Rejects that a Hello may still ask for (at most
-- 10,000 per session) move to kept_rejects.
CREATE OR REPLACE FUNCTION drop_partitions(history_name text, before date)
RETURNS integer LANGUAGE plpgsql SECURITY DEFINER
SET search_path = uplinkd, pg_temp SET lock_timeout = '1500ms' SET timezone = 'UTC' AS $$
DECLARE
  part record;
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
      EXECUTE format(
        'INSERT INTO kept_rejects (ruri, session, last, first, entry, reason, field, detail)'
        ' SELECT q.ruri, q.session, q.seq, q.seq, q.entry, q.reason, q.field, q.detail FROM %I AS q'
        ' CROSS JOIN LATERAL (SELECT l.first_entry, l.settled_seq FROM sessions AS l'
        ' WHERE l.ruri = q.ruri AND l.session = q.session ORDER BY l.part DESC LIMIT 1) AS s'
        ' WHERE q.source = 0 AND q.entry >= s.first_entry AND q.seq > s.settled_seq'
        ' ON CONFLICT DO NOTHING', part.relname);
    END IF;
    EXECUTE format('DROP TABLE %I', part.relname);
    dropped := dropped + 1;
  END LOOP;
  RETURN dropped;
END $$;
