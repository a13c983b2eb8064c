-- A civil time at which the clock of a server was vouched for, one for all that share the database: a
-- clock that stands much later is not trusted with deleting anything. No row until there was one.
CREATE TABLE clock_mark (
  id integer NOT NULL PRIMARY KEY CHECK (id = 0),
  at timestamptz NOT NULL
) WITH (fillfactor = 50);
