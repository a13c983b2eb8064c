-- What a checkpoint keeps of each robot's live state; each part is written only when it changed. The
-- parts' bytes are messages of the robot, each behind its length.
CREATE TABLE live (
  ruri TEXT NOT NULL PRIMARY KEY,
  last_sign_ms INTEGER,
  clock_skew_ms INTEGER,
  motion BLOB,
  status BLOB,
  extras BLOB,
  health BLOB,
  usage BLOB,
  consumables BLOB,
  directives BLOB
) STRICT;
