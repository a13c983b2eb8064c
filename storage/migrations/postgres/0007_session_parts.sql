-- A cursor's row is found in as many steps as ever while a long transaction elsewhere keeps all its
-- dead versions: it moves to a new key every 64 numbers, and is looked for from the greatest key down,
-- where the version that counts is. At most 64 numbers' dead versions stand before it. Within 64
-- numbers it is changed in place, as before.
--
-- A session has one row, as before: whoever adds one has locked the robot's row.
ALTER TABLE sessions ADD COLUMN part bigint NOT NULL GENERATED ALWAYS AS (cursor_seq >> 6) STORED;
ALTER TABLE sessions DROP CONSTRAINT sessions_pkey, ADD PRIMARY KEY (ruri, session, part);

-- As in 0002, but for where the sessions are looked for.
CREATE OR REPLACE FUNCTION begin_batch(
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
    CROSS JOIN LATERAL (SELECT p.cursor_seq FROM uplinkd.sessions AS p
      WHERE p.ruri = u.ruri AND p.session = u.session ORDER BY p.part DESC LIMIT 1) AS s
    WHERE s.cursor_seq < u.first;
  IF found_rows <> cardinality(session_robots) THEN
    RAISE EXCEPTION 'a number is at or below its cursor' USING ERRCODE = 'UL001';
  END IF;
  IF process_session IS NOT NULL AND NOT EXISTS (
    SELECT 1 FROM (SELECT p.cursor_seq FROM uplinkd.sessions AS p
        WHERE p.ruri = 'server' AND p.session = process_session
        ORDER BY p.part DESC LIMIT 1 FOR NO KEY UPDATE) AS s
      WHERE s.cursor_seq < process_first) THEN
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
