-- What a robot may leave behind is bounded: its open mission runs, and its quarantine.

-- closed_why: 0 the server did not close the run, 1 the robot had too many open, 2 it was not reported
-- for too long; closed_ms: when; the next report undoes it. last_entry: that of the latest report, so
-- that runs stand in the order of their commits whatever the clock did; 0 for reports from before this
-- step.
ALTER TABLE mission_runs ADD COLUMN last_entry INTEGER NOT NULL DEFAULT 0;
ALTER TABLE mission_runs ADD COLUMN closed_why INTEGER NOT NULL DEFAULT 0;
ALTER TABLE mission_runs ADD COLUMN closed_ms INTEGER NOT NULL DEFAULT 0;
DROP INDEX mission_runs_open_by_robot;
DROP INDEX mission_runs_open_by_fleet;
DROP INDEX mission_runs_open_by_time;
CREATE INDEX mission_runs_open_by_robot ON mission_runs (ruri, first_ms, entry)
  WHERE status NOT IN (6, 7, 8) AND closed_why = 0;
CREATE INDEX mission_runs_open_by_fleet ON mission_runs (fleet, first_ms, entry)
  WHERE status NOT IN (6, 7, 8) AND closed_why = 0;
CREATE INDEX mission_runs_open_by_time ON mission_runs (first_ms, entry)
  WHERE status NOT IN (6, 7, 8) AND closed_why = 0;

-- The highest Hello.settled_seq of the session: nobody asks for quarantine rows at or below it.
ALTER TABLE sessions ADD COLUMN settled_seq INTEGER NOT NULL DEFAULT 0;

-- How many rows of a robot's quarantine went for its bound.
CREATE TABLE quarantine_dropped (
  ruri TEXT NOT NULL,
  reason INTEGER NOT NULL,
  count INTEGER NOT NULL,
  PRIMARY KEY (ruri, reason)
) STRICT, WITHOUT ROWID;
