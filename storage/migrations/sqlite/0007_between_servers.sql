-- As PostgreSQL has it: the robot's holder fell silent since its last OpenStream.
ALTER TABLE robots ADD COLUMN holder_silent INTEGER NOT NULL DEFAULT 0;

-- Under which hold a robot's state was written last.
ALTER TABLE live ADD COLUMN held_since INTEGER NOT NULL DEFAULT 0;
