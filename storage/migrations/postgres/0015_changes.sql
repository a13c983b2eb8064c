-- Which shapes and objects of scope fleet (1) or world (2) changed, for servers that hand them on to
-- other robots: upserts, deletes, what is swept, what goes with its robot, and what is narrowed to
-- another scope. Triggers note it, whoever writes. A change names its item alone; what became of that is read
-- from the item's own table.
--
-- A writer is a session with the database, which draws its id with its first change. Its changes have
-- numbers from 1 without a hole, in the order of its commits: whoever remembers a number per writer
-- misses no transaction that commits late, while one of another writer passes it. No row of these
-- tables is ever changed, since a long transaction elsewhere would keep all the dead versions: the
-- last number of a writer is looked for in its changes, from the greatest down.
CREATE TABLE change_writers (
  writer uuid NOT NULL PRIMARY KEY
);

-- kind: 1 shape, 2 object. origin: the RURI of the robot whose item it is. The column is not called
-- ruri, as those of rows that go with their robot are: a change outlives it, so that others learn that
-- its items are gone. noted_at is by the database's clock.
CREATE TABLE changes (
  writer uuid NOT NULL,
  number bigint NOT NULL,
  noted_at timestamptz NOT NULL,
  kind smallint NOT NULL,
  origin text COLLATE "C" NOT NULL,
  id text COLLATE "C" NOT NULL,
  PRIMARY KEY (writer, number)
);

-- Of a trigger on shapes or objects; its argument is the kind. `removed` are the rows as they were,
-- `added` as they are. A statement that touches no such scope costs the look alone.
--
-- The row of the writer is locked: a sweep may take it away with its changes, and then, or where all
-- of its changes went, the session goes on as a new writer. An id and its numbers never come again.
-- A rollback takes the numbers back, and a drawn id with them.
CREATE FUNCTION note_changes() RETURNS trigger LANGUAGE plpgsql AS $$
DECLARE
  origins text[];
  ids text[];
  mine uuid;
  last_number bigint;
BEGIN
  IF TG_OP = 'INSERT' THEN
    SELECT array_agg(a.ruri), array_agg(a.id) INTO origins, ids
      FROM added AS a WHERE a.scope IN (1, 2);
  ELSIF TG_OP = 'DELETE' THEN
    SELECT array_agg(r.ruri), array_agg(r.id) INTO origins, ids
      FROM removed AS r WHERE r.scope IN (1, 2);
  ELSE
    SELECT array_agg(e.ruri), array_agg(e.id) INTO origins, ids
      FROM (SELECT r.ruri, r.id FROM removed AS r WHERE r.scope IN (1, 2)
            UNION SELECT a.ruri, a.id FROM added AS a WHERE a.scope IN (1, 2)) AS e;
  END IF;
  IF ids IS NULL THEN
    RETURN NULL;
  END IF;
  mine := nullif(current_setting('uplinkd.writer', true), '');
  IF mine IS NOT NULL THEN
    PERFORM FROM uplinkd.change_writers AS w WHERE w.writer = mine FOR NO KEY UPDATE;
    IF FOUND THEN
      SELECT c.number INTO last_number FROM uplinkd.changes AS c
        WHERE c.writer = mine ORDER BY c.number DESC LIMIT 1;
    END IF;
  END IF;
  IF last_number IS NULL THEN
    last_number := 0;
    mine := gen_random_uuid();
    PERFORM set_config('uplinkd.writer', mine::text, false);
    INSERT INTO uplinkd.change_writers (writer) VALUES (mine);
  END IF;
  INSERT INTO uplinkd.changes (writer, number, noted_at, kind, origin, id)
    SELECT mine, last_number + u.place, clock_timestamp(), TG_ARGV[0]::smallint, u.origin, u.id
    FROM unnest(origins, ids) WITH ORDINALITY AS u (origin, id, place);
  RETURN NULL;
END $$;

CREATE TRIGGER shapes_added AFTER INSERT ON shapes REFERENCING NEW TABLE AS added
  FOR EACH STATEMENT EXECUTE FUNCTION note_changes('1');
CREATE TRIGGER shapes_changed AFTER UPDATE ON shapes
  REFERENCING OLD TABLE AS removed NEW TABLE AS added
  FOR EACH STATEMENT EXECUTE FUNCTION note_changes('1');
CREATE TRIGGER shapes_removed AFTER DELETE ON shapes REFERENCING OLD TABLE AS removed
  FOR EACH STATEMENT EXECUTE FUNCTION note_changes('1');
CREATE TRIGGER objects_added AFTER INSERT ON objects REFERENCING NEW TABLE AS added
  FOR EACH STATEMENT EXECUTE FUNCTION note_changes('2');
CREATE TRIGGER objects_changed AFTER UPDATE ON objects
  REFERENCING OLD TABLE AS removed NEW TABLE AS added
  FOR EACH STATEMENT EXECUTE FUNCTION note_changes('2');
CREATE TRIGGER objects_removed AFTER DELETE ON objects REFERENCING OLD TABLE AS removed
  FOR EACH STATEMENT EXECUTE FUNCTION note_changes('2');

-- The items that are there, by their keys.
CREATE INDEX shapes_shared ON shapes (ruri, id) WHERE scope IN (1, 2);
CREATE INDEX objects_shared ON objects (ruri, id) WHERE scope IN (1, 2);

-- Deletes the oldest changes of each writer but `kept`, and writers that changed nothing for so many
-- hours, with all of theirs: at most `rows_max` rows per call. Returns how many went. One session at a
-- time does it; another finds nothing to do.
CREATE FUNCTION sweep_changes(kept bigint, idle_hours integer, rows_max bigint)
RETURNS bigint LANGUAGE plpgsql AS $$
DECLARE
  one record;
  newest bigint;
  deleted bigint;
  gone bigint := 0;
BEGIN
  IF NOT pg_try_advisory_xact_lock(hashtext('uplinkd.changes')) THEN
    RETURN 0;
  END IF;
  FOR one IN
    SELECT w.writer, l.number AS last, f.number AS first,
        coalesce(l.noted_at < clock_timestamp() - make_interval(hours => idle_hours), true) AS is_idle
      FROM uplinkd.change_writers AS w
      LEFT JOIN LATERAL (SELECT c.number, c.noted_at FROM uplinkd.changes AS c
        WHERE c.writer = w.writer ORDER BY c.number DESC LIMIT 1) AS l ON true
      LEFT JOIN LATERAL (SELECT c.number FROM uplinkd.changes AS c
        WHERE c.writer = w.writer ORDER BY c.number LIMIT 1) AS f ON true
  LOOP
    EXIT WHEN gone >= rows_max;
    IF one.is_idle THEN
      -- From here on it notes nothing: its session waits, and finds what is left, or begins anew.
      PERFORM FROM uplinkd.change_writers AS w WHERE w.writer = one.writer FOR UPDATE SKIP LOCKED;
      CONTINUE WHEN NOT FOUND;
      SELECT max(c.number) INTO newest FROM uplinkd.changes AS c WHERE c.writer = one.writer;
      CONTINUE WHEN newest IS DISTINCT FROM one.last;
      DELETE FROM uplinkd.changes AS c
        WHERE c.writer = one.writer AND c.number < one.first + rows_max - gone;
      GET DIAGNOSTICS deleted = ROW_COUNT;
      DELETE FROM uplinkd.change_writers AS w WHERE w.writer = one.writer
        AND NOT EXISTS (SELECT 1 FROM uplinkd.changes AS c WHERE c.writer = one.writer);
    ELSE
      DELETE FROM uplinkd.changes AS c WHERE c.writer = one.writer
        AND c.number <= one.last - kept AND c.number < one.first + rows_max - gone;
      GET DIAGNOSTICS deleted = ROW_COUNT;
    END IF;
    gone := gone + deleted;
  END LOOP;
  RETURN gone;
END $$;
