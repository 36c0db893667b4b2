-- SPDX-License-Identifier: MIT
-- Recordings go by age and space, marked ones never; the row stays.  One whole row for each file.
ALTER TABLE fetches ADD COLUMN marked boolean NOT NULL DEFAULT false, ADD COLUMN ended timestamptz;
ALTER TABLE fetches DROP CONSTRAINT fetches_state_check;
ALTER TABLE fetches ADD CONSTRAINT fetches_state_check CHECK (state IN ('asked', 'coming', 'whole', 'refused', 'removed'));
UPDATE fetches SET ended = asked WHERE state IN ('whole', 'refused');
UPDATE fetches f SET state = 'removed', words = 'fetched anew' WHERE state = 'whole' AND EXISTS
  (SELECT 1 FROM fetches n WHERE n.cell = f.cell AND n.book = f.book AND n.scan = f.scan AND n.state = 'whole' AND n.number > f.number);
CREATE UNIQUE INDEX one_whole_fetch ON fetches (cell, book, scan) WHERE state = 'whole';
