-- The last row of presence_changes of each robot, which outlives it: histories are kept to their age.

CREATE TABLE presence_latest (
  ruri TEXT NOT NULL PRIMARY KEY,
  presence INTEGER NOT NULL,
  at_ms INTEGER NOT NULL
) STRICT, WITHOUT ROWID;

INSERT INTO presence_latest (ruri, presence, at_ms)
  SELECT ruri, presence, at_ms FROM presence_changes AS p
  WHERE NOT EXISTS (SELECT 1 FROM presence_changes AS n
                    WHERE n.ruri = p.ruri AND (n.at_ms, n.entry) > (p.at_ms, p.entry));
