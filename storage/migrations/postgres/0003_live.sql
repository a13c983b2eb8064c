-- What a checkpoint keeps of each robot's live state: a row a robot, changed in place (no index but
-- the key's, and room on the page), each part only when it changed. The parts' bytes are messages of
-- the robot, each behind its length.
CREATE TABLE live (
  ruri text COLLATE "C" NOT NULL PRIMARY KEY,
  last_sign_at timestamptz,
  clock_skew_ms bigint,
  motion bytea,
  status bytea,
  extras bytea,
  health bytea,
  usage bytea,
  consumables bytea,
  directives bytea
) WITH (fillfactor = 50);
