-- What of a robot has expired, for a batch that meets the robot's bound: without a look at all that is there
-- of it.
CREATE INDEX shapes_by_robot_and_expiry ON shapes (ruri, expires_ms) WHERE expires_ms <> 0;
CREATE INDEX objects_by_robot_and_expiry ON objects (ruri, expires_ms) WHERE expires_ms <> 0;
