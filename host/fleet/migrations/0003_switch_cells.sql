-- SPDX-License-Identifier: MIT
-- The cells of a switch, as they were when it was planned: a later offer is to others, and takes nothing back.
CREATE TABLE switch_cells (
  switch integer NOT NULL REFERENCES switches (number) ON DELETE CASCADE,
  cell text NOT NULL,
  PRIMARY KEY (switch, cell)
);
INSERT INTO switch_cells (switch, cell)
  SELECT s.number, rc.cell FROM switches s JOIN release_cells rc ON rc.release = s.release;
