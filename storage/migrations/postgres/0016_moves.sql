-- A robot that a certificate moves to another fleet takes its shapes and objects with it: they belong
-- to the fleet of their robot, for those who list them and for the robots that they are handed on to.
CREATE FUNCTION move_items() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
  UPDATE uplinkd.shapes AS s SET fleet = NEW.fleet
    WHERE s.ruri = NEW.ruri AND s.fleet <> NEW.fleet;
  UPDATE uplinkd.objects AS o SET fleet = NEW.fleet
    WHERE o.ruri = NEW.ruri AND o.fleet <> NEW.fleet;
  RETURN NULL;
END $$;
CREATE TRIGGER robots_moved AFTER UPDATE OF fleet ON robots
  FOR EACH ROW WHEN (OLD.fleet <> NEW.fleet) EXECUTE FUNCTION move_items();

-- Those of robots that moved before.
UPDATE shapes AS s SET fleet = r.fleet FROM robots AS r WHERE r.ruri = s.ruri AND s.fleet <> r.fleet;
UPDATE objects AS o SET fleet = r.fleet FROM robots AS r WHERE r.ruri = o.ruri AND o.fleet <> r.fleet;

-- TRUNCATE passes over the triggers of rows: what went is not known. A writer whose first change has
-- number 2 has a hole, and whoever finds a hole reads all items anew.
CREATE FUNCTION note_truncation() RETURNS trigger LANGUAGE plpgsql AS $$
DECLARE
  mine uuid := gen_random_uuid();
BEGIN
  INSERT INTO uplinkd.change_writers (writer) VALUES (mine);
  INSERT INTO uplinkd.changes (writer, number, noted_at, kind, origin, id)
    VALUES (mine, 2, clock_timestamp(), TG_ARGV[0]::smallint, '', '');
  RETURN NULL;
END $$;
CREATE TRIGGER shapes_truncated AFTER TRUNCATE ON shapes
  FOR EACH STATEMENT EXECUTE FUNCTION note_truncation('1');
CREATE TRIGGER objects_truncated AFTER TRUNCATE ON objects
  FOR EACH STATEMENT EXECUTE FUNCTION note_truncation('2');
