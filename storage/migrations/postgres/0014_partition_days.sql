-- The function of 0009, with a bound on days long ago. Who may run it stays as it is.

-- Makes the partitions of the days from `first_day` on that are not there; returns how many. Rows of
-- such a day that lie in the default partition move into it, unless they are so many that moving them
-- would hold up the server: then the day stays there. Runs as the owner, since the server's role may
-- not create tables. Waits for a lock longer than deadlock_timeout, so that autovacuum makes way. A
-- day more than 31 days after today, or more than 10,000 before it, is refused: a clock that is wrong, or
-- whoever got hold of the server's role, would fill the catalogue with tables that nothing drops.
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
  IF days IS NULL OR days NOT BETWEEN 1 AND 31 THEN
    RAISE EXCEPTION 'days is %, outside 1 to 31', days USING ERRCODE = '22023';
  END IF;
  IF first_day + days - 1 > (now() AT TIME ZONE 'UTC')::date + 31 THEN
    RAISE EXCEPTION 'the days from % to % go further than 31 days ahead', first_day, first_day + days - 1
      USING ERRCODE = '22023';
  END IF;
  IF first_day IS NULL OR first_day < (now() AT TIME ZONE 'UTC')::date - 10000 THEN
    RAISE EXCEPTION 'the days from % on begin more than 10000 days ago', first_day USING ERRCODE = '22023';
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
