-- A robot that a certificate moves to another fleet takes its shapes and objects with it: they belong
-- to the fleet of their robot, for those who list them and for the robots that they are handed on to.
CREATE TRIGGER robots_moved AFTER UPDATE OF fleet ON robots WHEN OLD.fleet <> NEW.fleet
BEGIN
  UPDATE shapes SET fleet = NEW.fleet WHERE ruri = NEW.ruri AND fleet <> NEW.fleet;
  UPDATE objects SET fleet = NEW.fleet WHERE ruri = NEW.ruri AND fleet <> NEW.fleet;
END;

-- Those of robots that moved before.
UPDATE shapes SET fleet = r.fleet FROM robots AS r WHERE r.ruri = shapes.ruri AND shapes.fleet <> r.fleet;
UPDATE objects SET fleet = r.fleet FROM robots AS r WHERE r.ruri = objects.ruri AND objects.fleet <> r.fleet;

-- A row that an operator gives another key has ended under the old one.
CREATE TRIGGER shapes_renamed AFTER UPDATE OF ruri, id ON shapes
  WHEN OLD.scope IN (1, 2) AND (OLD.ruri <> NEW.ruri OR OLD.id <> NEW.id)
BEGIN
  INSERT INTO changes (kind, origin, id) VALUES (1, OLD.ruri, OLD.id);
END;
CREATE TRIGGER objects_renamed AFTER UPDATE OF ruri, id ON objects
  WHEN OLD.scope IN (1, 2) AND (OLD.ruri <> NEW.ruri OR OLD.id <> NEW.id)
BEGIN
  INSERT INTO changes (kind, origin, id) VALUES (2, OLD.ruri, OLD.id);
END;
