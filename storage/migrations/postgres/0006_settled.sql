-- How far the robot's session was settled at the checkpoint, live messages included.
ALTER TABLE live ADD COLUMN session uuid, ADD COLUMN settled_seq bigint;
