-- Which shapes and objects of scope fleet (1) or world (2) changed, for the server, which hands them on
-- to other robots: upserts, deletes, what is swept, what goes with its robot, and what is narrowed to
-- another scope. Triggers note it, whoever writes. A change names its item alone; what became of that is read
-- from the item's own table.
--
-- The numbers are those of the commits, without a hole: one transaction writes at a time, and a
-- rollback takes them back. kind: 1 shape, 2 object. origin: the RURI of the robot whose item it is.
-- The column is not called ruri, as those of rows that go with their robot are: a change outlives it,
-- so that others learn that its items are gone.
CREATE TABLE changes (
  number INTEGER NOT NULL PRIMARY KEY AUTOINCREMENT,
  kind INTEGER NOT NULL,
  origin TEXT NOT NULL,
  id TEXT NOT NULL
) STRICT;

CREATE TRIGGER shapes_added AFTER INSERT ON shapes WHEN NEW.scope IN (1, 2)
BEGIN
  INSERT INTO changes (kind, origin, id) VALUES (1, NEW.ruri, NEW.id);
END;
CREATE TRIGGER shapes_changed AFTER UPDATE ON shapes WHEN OLD.scope IN (1, 2) OR NEW.scope IN (1, 2)
BEGIN
  INSERT INTO changes (kind, origin, id) VALUES (1, NEW.ruri, NEW.id);
END;
CREATE TRIGGER shapes_removed AFTER DELETE ON shapes WHEN OLD.scope IN (1, 2)
BEGIN
  INSERT INTO changes (kind, origin, id) VALUES (1, OLD.ruri, OLD.id);
END;
CREATE TRIGGER objects_added AFTER INSERT ON objects WHEN NEW.scope IN (1, 2)
BEGIN
  INSERT INTO changes (kind, origin, id) VALUES (2, NEW.ruri, NEW.id);
END;
CREATE TRIGGER objects_changed AFTER UPDATE ON objects WHEN OLD.scope IN (1, 2) OR NEW.scope IN (1, 2)
BEGIN
  INSERT INTO changes (kind, origin, id) VALUES (2, NEW.ruri, NEW.id);
END;
CREATE TRIGGER objects_removed AFTER DELETE ON objects WHEN OLD.scope IN (1, 2)
BEGIN
  INSERT INTO changes (kind, origin, id) VALUES (2, OLD.ruri, OLD.id);
END;

-- The items that are there, by their keys.
CREATE INDEX shapes_shared ON shapes (ruri, id) WHERE scope IN (1, 2);
CREATE INDEX objects_shared ON objects (ruri, id) WHERE scope IN (1, 2);
