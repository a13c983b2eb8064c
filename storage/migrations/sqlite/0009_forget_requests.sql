-- As PostgreSQL has it: robots that an operator wants to be forgotten, and what the server answers.
CREATE TABLE forget_requests (
  number INTEGER NOT NULL PRIMARY KEY AUTOINCREMENT,
  ruri TEXT NOT NULL CHECK (length(CAST(ruri AS BLOB)) <= 1024),
  end_stream INTEGER NOT NULL,
  touched_s INTEGER NOT NULL,
  answer INTEGER NOT NULL DEFAULT 0,
  epoch INTEGER NOT NULL DEFAULT 0,
  finished INTEGER NOT NULL DEFAULT 0
) STRICT;
