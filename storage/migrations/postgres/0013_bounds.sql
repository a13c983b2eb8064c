-- What a robot may leave behind is bounded: its open mission runs, and its quarantine.

-- closed_why: 0 the server did not close the run, 1 the robot had too many open, 2 it was not reported
-- for too long; closed_at: when; the next report undoes it. is_open is false then. last_entry: that of
-- the latest report, so that runs stand in the order of their commits whatever the clock did; 0 for
-- reports from before this step.
ALTER TABLE mission_runs
  ADD COLUMN last_entry bigint NOT NULL DEFAULT 0,
  ADD COLUMN closed_why integer NOT NULL DEFAULT 0,
  ADD COLUMN closed_at timestamptz NOT NULL DEFAULT 'epoch';

-- The highest Hello.settled_seq of the session: nobody asks for quarantine rows at or below it.
ALTER TABLE sessions ADD COLUMN settled_seq bigint NOT NULL DEFAULT 0;

-- How many rows of a robot's quarantine went for its bound.
CREATE TABLE quarantine_dropped (
  ruri text COLLATE "C" NOT NULL,
  reason integer NOT NULL,
  count bigint NOT NULL,
  PRIMARY KEY (ruri, reason)
) WITH (fillfactor = 75);
