-- What a batch needs decided before its first write, in one call: locks the robots' rows in order of
-- their keys, and draws the transaction's number. Raises UL001 where the batch cannot be written as
-- it stands, and the server then reads what is there first: a hold is older than the robot's, a
-- session is unknown, a number is at or below its cursor, or a bound may be met.
--
-- robots, holds: the robots and the oldest hold of each in the batch. session_*: the sessions and the
-- first number of each. bound_*: robots with raises and upserts, and how many. process_*: the session
-- of the server's own records and their first number.
CREATE FUNCTION begin_batch(
  robots text[], holds bigint[],
  session_robots text[], session_ids uuid[], session_firsts bigint[],
  bound_robots text[], bound_faults integer[], bound_shapes integer[], bound_objects integer[],
  faults_max bigint, shapes_max bigint, objects_max bigint,
  process_session uuid, process_first bigint)
RETURNS bigint LANGUAGE plpgsql VOLATILE AS $$
DECLARE
  found_rows bigint;
BEGIN
  SELECT count(*) INTO found_rows FROM (
    SELECT 1 FROM unnest(robots, holds) AS u (ruri, held)
      JOIN uplinkd.robots AS r ON r.ruri = u.ruri
      WHERE r.held_since <= u.held
      ORDER BY r.ruri FOR NO KEY UPDATE OF r) AS locked;
  IF found_rows <> cardinality(robots) THEN
    RAISE EXCEPTION 'another process holds a robot, or it is unknown' USING ERRCODE = 'UL001';
  END IF;
  -- Read after the locks: a statement of its own sees what was committed until then.
  SELECT count(*) INTO found_rows
    FROM unnest(session_robots, session_ids, session_firsts) AS u (ruri, session, first)
    JOIN uplinkd.sessions AS s ON s.ruri = u.ruri AND s.session = u.session
    WHERE s.cursor_seq < u.first;
  IF found_rows <> cardinality(session_robots) THEN
    RAISE EXCEPTION 'a number is at or below its cursor' USING ERRCODE = 'UL001';
  END IF;
  IF process_session IS NOT NULL AND NOT EXISTS (
    SELECT 1 FROM uplinkd.sessions AS s WHERE s.ruri = 'server' AND s.session = process_session
      AND s.cursor_seq < process_first FOR NO KEY UPDATE) THEN
    RAISE EXCEPTION 'the session of the process is unknown' USING ERRCODE = 'UL001';
  END IF;
  IF cardinality(bound_robots) > 0 AND EXISTS (
    SELECT 1 FROM unnest(bound_robots, bound_faults, bound_shapes, bound_objects)
        AS u (ruri, faults, shapes, objects)
      WHERE (u.faults > 0 AND u.faults + (SELECT count(*) FROM uplinkd.faults_active AS f
               WHERE f.ruri = u.ruri) > faults_max)
         OR (u.shapes > 0 AND u.shapes + (SELECT count(*) FROM uplinkd.shapes AS f
               WHERE f.ruri = u.ruri) > shapes_max)
         OR (u.objects > 0 AND u.objects + (SELECT count(*) FROM uplinkd.objects AS f
               WHERE f.ruri = u.ruri) > objects_max)) THEN
    RAISE EXCEPTION 'a bound may be met' USING ERRCODE = 'UL001';
  END IF;
  RETURN nextval('uplinkd.batches');
END $$;

-- The histories and the column of each by which it is partitioned.
CREATE FUNCTION histories(OUT parent text, OUT arrival text)
RETURNS SETOF record LANGUAGE sql IMMUTABLE AS $$
  VALUES ('faults_history', 'received_at'), ('events', 'received_at'), ('messages', 'received_at'),
    ('mission_reports', 'received_at'), ('quarantine', 'received_at'),
    ('presence_changes', 'changed_at')
$$;

-- Makes the partitions of the days from `first_day` on that are not there; returns how many. Rows of
-- such a day that lie in the default partition move into it, unless they are so many that moving them
-- would hold up the server: then the day stays there. Runs as the owner, since the server's role may
-- not create tables. Waits for a lock longer than deadlock_timeout, so that autovacuum makes way.
CREATE FUNCTION make_partitions(first_day date, days integer)
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
-- call; returns how many. Runs as the owner.
CREATE FUNCTION drop_partitions(history_name text, before date)
RETURNS integer LANGUAGE plpgsql SECURITY DEFINER
SET search_path = uplinkd, pg_temp SET lock_timeout = '1500ms' SET timezone = 'UTC' AS $$
DECLARE
  part record;
  dropped integer := 0;
BEGIN
  IF NOT EXISTS (SELECT FROM histories() AS h WHERE h.parent = history_name) THEN
    RAISE EXCEPTION '% is no history', history_name USING ERRCODE = '22023';
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

-- Whoever may run them is granted so by name.
REVOKE EXECUTE ON ALL FUNCTIONS IN SCHEMA uplinkd FROM PUBLIC;
