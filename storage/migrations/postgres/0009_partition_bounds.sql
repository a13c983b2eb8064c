-- The functions of 0002, with bounds on the days. Who may run them stays as it is.

-- Makes the partitions of the days from `first_day` on that are not there; returns how many. Rows of
-- such a day that lie in the default partition move into it, unless they are so many that moving them
-- would hold up the server: then the day stays there. Runs as the owner, since the server's role may
-- not create tables. Waits for a lock longer than deadlock_timeout, so that autovacuum makes way. A
-- day more than 31 days after today is refused: a clock that is wrong, or whoever got hold of the server's
-- role, would fill the catalogue with tables that nothing drops.
CREATE OR REPLACE FUNCTION make_partitions(first_day date, days integer)
RETURNS integer LANGUAGE plpgsql SECURITY DEFINER
SET search_path = uplinkd, pg_temp SET lock_timeout = '1500ms' SET timezone = 'UTC' AS $$
DECLARE
  history record;
  day date;
  part text;
  held bigint;
  made integer := 0;
BEGIN
  IF days NOT BETWEEN 1 AND 31 THEN
    RAISE EXCEPTION 'days is %, outside 1 to 31', days USING ERRCODE = '22023';
  END IF;
  IF first_day + days - 1 > (now() AT TIME ZONE 'UTC')::date + 31 THEN
    RAISE EXCEPTION 'the days from % to % go further than 31 days ahead', first_day, first_day + days - 1
      USING ERRCODE = '22023';
  END IF;
  -- Two servers that do this at once would trip over each other's tables.
  PERFORM pg_advisory_xact_lock(hashtext('uplinkd.partitions'));
  FOR history IN SELECT * FROM histories() LOOP
    FOR i IN 0 .. days - 1 LOOP
      day := first_day + i;
      part := format('%s_%s', history.parent, to_char(day, 'YYYYMMDD'));
      CONTINUE WHEN to_regclass(format('uplinkd.%I', part)) IS NOT NULL;
      EXECUTE format('SELECT count(*) FROM (SELECT FROM %I WHERE %I >= %L AND %I < %L LIMIT 10001) AS h',
                     history.parent || '_default', history.arrival, day, history.arrival, day + 1)
        INTO held;
      CONTINUE WHEN held > 10000;
      EXECUTE format('CREATE TABLE %I (LIKE %I INCLUDING ALL)', part, history.parent);
      IF held > 0 THEN
        EXECUTE format('LOCK TABLE %I IN ACCESS EXCLUSIVE MODE', history.parent || '_default');
        EXECUTE format('WITH moved AS (DELETE FROM %I WHERE %I >= %L AND %I < %L RETURNING *)'
                       ' INSERT INTO %I SELECT * FROM moved',
                       history.parent || '_default', history.arrival, day, history.arrival, day + 1,
                       part);
      END IF;
      EXECUTE format('ALTER TABLE %I ATTACH PARTITION %I FOR VALUES FROM (%L) TO (%L)',
                     history.parent, part, day, day + 1);
      made := made + 1;
    END LOOP;
  END LOOP;
  RETURN made;
END $$;

-- Drops the partitions of one history that end at or before `before`, the oldest first, at most ten a
-- call; returns how many. Runs as the owner. Yesterday and what comes after it is never dropped: no
-- history is kept for less than a day. Clocks may differ by ten minutes: shortly before midnight, a
-- server's day is the next one already.
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
    EXECUTE format('DROP TABLE %I', part.relname);
    dropped := dropped + 1;
  END LOOP;
  RETURN dropped;
END $$;
