-- The last epoch that was given. Every epoch comes from here, whether a stream opens or a robot is
-- adopted: none is ever given twice, so that a robot whose row went and was made anew stands above
-- whoever held it before. It begins above all that rows name.
CREATE TABLE epochs (
  id INTEGER NOT NULL PRIMARY KEY CHECK (id = 0),
  last INTEGER NOT NULL
) STRICT;
INSERT INTO epochs (id, last) VALUES (0, max((SELECT coalesce(max(epoch), 0) FROM robots),
                                             (SELECT coalesce(max(held_since), 0) FROM live)));
