-- The robot's holder fell silent since its last OpenStream, and may live with a stream of it: whoever
-- adopts it next gives it as long as the first adopter did.
ALTER TABLE robots ADD COLUMN holder_silent boolean NOT NULL DEFAULT false;

-- Under which hold, and by which store call of its writer, a robot's state was written last: a statement
-- that its server gave up, and that runs later all the same, puts nothing older over it.
ALTER TABLE live
  ADD COLUMN held_since bigint NOT NULL DEFAULT 0,
  ADD COLUMN store_call bigint NOT NULL DEFAULT 0;
