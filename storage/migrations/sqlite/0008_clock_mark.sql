-- A civil time at which the server's clock was vouched for: one that stands much later is not trusted
-- with deleting anything. No row until there was one.
CREATE TABLE clock_mark (
  id INTEGER NOT NULL PRIMARY KEY CHECK (id = 0),
  at_ms INTEGER NOT NULL
) STRICT;
