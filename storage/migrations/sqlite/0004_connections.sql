-- oldest: 1
-- Connections of robots, and why a robot went offline. Names, times and numbers as in 0001.

-- A connection of a robot: a stream, a twin's client at a broker, a drone's calls; at most 64 of a robot.
-- source: as in quarantine; process: the server that served it, and server where robots reached that one.
-- address: from where the robot connected. held_back_ms: for how long it was held back in all.
-- ended_*: NULL while it is open. ended_why: 0 orderly, 1 broken, 2 silent, 3 replaced, 4 drained,
-- 5 not read, 6 protocol error, 7 refused, 8 certificate expired, 9 the server ended.
CREATE TABLE connections (
  ruri TEXT NOT NULL,
  id BLOB NOT NULL,
  began_at INTEGER NOT NULL,
  entry INTEGER NOT NULL,
  fleet TEXT NOT NULL,
  source INTEGER NOT NULL,
  process BLOB NOT NULL,
  server TEXT NOT NULL,
  address TEXT NOT NULL,
  gateway TEXT NOT NULL,
  agent_version TEXT NOT NULL,
  certificate_serial TEXT NOT NULL,
  certificate_sha256 TEXT NOT NULL,
  certificate_key_sha256 TEXT NOT NULL,
  certificate_not_after INTEGER,
  messages INTEGER NOT NULL,
  bytes INTEGER NOT NULL,
  takeovers INTEGER NOT NULL,
  held_back_ms INTEGER NOT NULL,
  held_back_why TEXT NOT NULL,
  is_open INTEGER NOT NULL,
  ended_at INTEGER,
  ended_why INTEGER,
  ended_code TEXT,
  ended_detail TEXT,
  PRIMARY KEY (ruri, id)
) STRICT;
CREATE INDEX connections_by_robot ON connections (ruri, began_at, entry);
CREATE INDEX connections_by_fleet ON connections (fleet, began_at, entry);
CREATE INDEX connections_by_time ON connections (began_at, entry);
CREATE INDEX connections_open_by_robot ON connections (ruri, began_at, entry) WHERE is_open;
CREATE INDEX connections_open_by_fleet ON connections (fleet, began_at, entry) WHERE is_open;
CREATE INDEX connections_open_by_time ON connections (began_at, entry) WHERE is_open;
CREATE INDEX connections_by_why ON connections (ended_why, began_at, entry, fleet);
CREATE INDEX connections_by_source ON connections (source, began_at, entry, fleet);
CREATE INDEX connections_open_by_process ON connections (process) WHERE is_open;

-- Why the last connection of a robot that goes offline ended, as ended_why; NULL where that is unknown.
ALTER TABLE presence_changes ADD COLUMN why INTEGER;

-- Until when the robot is parked, as it said with its Goodbye; NULL if it is not.
ALTER TABLE presence_latest ADD COLUMN parked_until INTEGER;
