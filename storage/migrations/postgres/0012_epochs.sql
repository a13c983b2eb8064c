-- Every epoch comes from here, whether a stream opens or a robot is adopted: none is ever given twice,
-- so that a robot whose row went and was made anew stands above whoever held it before. It begins above
-- all that rows name.
LOCK TABLE robots IN SHARE ROW EXCLUSIVE MODE;
CREATE SEQUENCE epochs;
SELECT setval('epochs', 1 + greatest((SELECT coalesce(max(epoch), 0) FROM robots),
                                     (SELECT coalesce(max(held_since), 0) FROM live)), false);
