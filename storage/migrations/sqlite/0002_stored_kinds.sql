-- The durable kinds beside faults. Columns as in 0001: received_ms is the arrival, sampled_ms the
-- robot's clock (0 if unknown), fleet the robot's when the row was written. Enumerations are the
-- numbers of the wire, those included that nobody knows yet. Texts of JSON hold an object by the
-- specification's names.

CREATE TABLE events (
  ruri TEXT NOT NULL,
  received_ms INTEGER NOT NULL,
  entry INTEGER NOT NULL,
  fleet TEXT NOT NULL,
  session BLOB NOT NULL,
  seq INTEGER NOT NULL,
  sampled_ms INTEGER NOT NULL,
  kind TEXT NOT NULL,
  detail TEXT NOT NULL,
  PRIMARY KEY (ruri, received_ms, entry)
) STRICT;
CREATE INDEX events_by_fleet ON events (fleet, received_ms, entry);
CREATE INDEX events_by_time ON events (received_ms, entry);

CREATE TABLE messages (
  ruri TEXT NOT NULL,
  received_ms INTEGER NOT NULL,
  entry INTEGER NOT NULL,
  fleet TEXT NOT NULL,
  session BLOB NOT NULL,
  seq INTEGER NOT NULL,
  sampled_ms INTEGER NOT NULL,
  level INTEGER NOT NULL,
  message TEXT NOT NULL,
  PRIMARY KEY (ruri, received_ms, entry)
) STRICT;
CREATE INDEX messages_by_fleet ON messages (fleet, received_ms, entry);
CREATE INDEX messages_by_time ON messages (received_ms, entry);

CREATE TABLE mission_reports (
  ruri TEXT NOT NULL,
  received_ms INTEGER NOT NULL,
  entry INTEGER NOT NULL,
  fleet TEXT NOT NULL,
  session BLOB NOT NULL,
  seq INTEGER NOT NULL,
  mission_id TEXT NOT NULL,
  run_id TEXT NOT NULL,
  status INTEGER NOT NULL,
  report TEXT NOT NULL,
  PRIMARY KEY (ruri, received_ms, entry)
) STRICT;
CREATE INDEX mission_reports_by_fleet ON mission_reports (fleet, received_ms, entry);
CREATE INDEX mission_reports_by_time ON mission_reports (received_ms, entry);
CREATE INDEX mission_reports_by_run ON mission_reports (run_id, received_ms, entry);
CREATE INDEX mission_reports_by_mission ON mission_reports (mission_id, received_ms, entry);

-- first_ms and entry are those of a run's first report, so that a page token stays true while later
-- reports change the rest. Statuses 6, 7 and 8 are terminal: aborted, complete, error.
CREATE TABLE mission_runs (
  ruri TEXT NOT NULL,
  mission_id TEXT NOT NULL,
  run_id TEXT NOT NULL,
  fleet TEXT NOT NULL,
  first_ms INTEGER NOT NULL,
  entry INTEGER NOT NULL,
  last_ms INTEGER NOT NULL,
  name TEXT NOT NULL,
  status INTEGER NOT NULL,
  updates INTEGER NOT NULL,
  latest TEXT NOT NULL,
  PRIMARY KEY (ruri, mission_id, run_id)
) STRICT;
CREATE INDEX mission_runs_by_robot ON mission_runs (ruri, first_ms, entry);
CREATE INDEX mission_runs_by_fleet ON mission_runs (fleet, first_ms, entry);
CREATE INDEX mission_runs_by_time ON mission_runs (first_ms, entry);
CREATE INDEX mission_runs_by_run ON mission_runs (run_id, first_ms, entry);
CREATE INDEX mission_runs_by_mission ON mission_runs (mission_id, first_ms, entry);
CREATE INDEX mission_runs_open_by_robot ON mission_runs (ruri, first_ms, entry)
  WHERE status NOT IN (6, 7, 8);
CREATE INDEX mission_runs_open_by_fleet ON mission_runs (fleet, first_ms, entry)
  WHERE status NOT IN (6, 7, 8);
CREATE INDEX mission_runs_open_by_time ON mission_runs (first_ms, entry)
  WHERE status NOT IN (6, 7, 8);

-- first_ms and entry are those of the upsert that made the id present; received_ms is that of the
-- latest. expires_ms: 0 is never. geometry: GeoJSON.
CREATE TABLE shapes (
  ruri TEXT NOT NULL,
  id TEXT NOT NULL,
  fleet TEXT NOT NULL,
  first_ms INTEGER NOT NULL,
  entry INTEGER NOT NULL,
  received_ms INTEGER NOT NULL,
  expires_ms INTEGER NOT NULL,
  name TEXT NOT NULL,
  rev INTEGER NOT NULL,
  hash TEXT NOT NULL,
  area_type INTEGER NOT NULL,
  scope INTEGER NOT NULL,
  min_z_m REAL NOT NULL,
  max_z_m REAL NOT NULL,
  level_id INTEGER NOT NULL,
  geometry TEXT NOT NULL,
  PRIMARY KEY (ruri, id)
) STRICT;
CREATE INDEX shapes_by_robot ON shapes (ruri, first_ms, entry);
CREATE INDEX shapes_by_fleet ON shapes (fleet, first_ms, entry);
CREATE INDEX shapes_by_time ON shapes (first_ms, entry);
CREATE INDEX shapes_by_expiry ON shapes (expires_ms) WHERE expires_ms != 0;
CREATE INDEX shapes_by_robot_and_expiry ON shapes (ruri, expires_ms) WHERE expires_ms != 0;

-- As shapes. trajectory: NULL if there is none.
CREATE TABLE objects (
  ruri TEXT NOT NULL,
  id TEXT NOT NULL,
  fleet TEXT NOT NULL,
  first_ms INTEGER NOT NULL,
  entry INTEGER NOT NULL,
  received_ms INTEGER NOT NULL,
  expires_ms INTEGER NOT NULL,
  name TEXT NOT NULL,
  sampled_ms INTEGER NOT NULL,
  object_type INTEGER NOT NULL,
  scope INTEGER NOT NULL,
  radius_m REAL NOT NULL,
  location TEXT NOT NULL,
  trajectory TEXT,
  PRIMARY KEY (ruri, id)
) STRICT;
CREATE INDEX objects_by_robot ON objects (ruri, first_ms, entry);
CREATE INDEX objects_by_fleet ON objects (fleet, first_ms, entry);
CREATE INDEX objects_by_time ON objects (first_ms, entry);
CREATE INDEX objects_by_expiry ON objects (expires_ms) WHERE expires_ms != 0;
CREATE INDEX objects_by_robot_and_expiry ON objects (ruri, expires_ms) WHERE expires_ms != 0;

-- kind: 0 agent info, 1 settings, 2 UI capabilities.
CREATE TABLE latest (
  ruri TEXT NOT NULL,
  kind INTEGER NOT NULL,
  fleet TEXT NOT NULL,
  received_ms INTEGER NOT NULL,
  body TEXT NOT NULL,
  PRIMARY KEY (ruri, kind)
) STRICT;

-- presence: 0 unknown, 1 online, 2 offline.
CREATE TABLE presence_changes (
  ruri TEXT NOT NULL,
  at_ms INTEGER NOT NULL,
  entry INTEGER NOT NULL,
  fleet TEXT NOT NULL,
  presence INTEGER NOT NULL,
  PRIMARY KEY (ruri, at_ms, entry)
) STRICT;
CREATE INDEX presence_changes_by_fleet ON presence_changes (fleet, at_ms, entry);
CREATE INDEX presence_changes_by_time ON presence_changes (at_ms, entry);
