-- Robots that an operator wants to be forgotten: the holder lets go of one and answers, and other
-- servers learn that it is gone. answer: 0 none, 1 let go, 2 has a stream, 3 records wait; epoch: that
-- of the robot when it was let go.
CREATE TABLE forget_requests (
  number bigint GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
  ruri text COLLATE "C" NOT NULL CHECK (octet_length(ruri) <= 1024),
  end_stream boolean NOT NULL,
  touched_at timestamptz NOT NULL DEFAULT now(),
  answer integer NOT NULL DEFAULT 0,
  epoch bigint NOT NULL DEFAULT 0,
  finished boolean NOT NULL DEFAULT false
);
