-- SPDX-License-Identifier: MIT
-- The newest link of each cell's log, as it was told: who cuts the end of the log in the cell cannot cut it here.
-- A row of which two links were told stands twice.
CREATE TABLE log_links (
  id bigint GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
  cell text NOT NULL,
  book text NOT NULL,
  log_row bigint NOT NULL,
  link text NOT NULL,
  told timestamptz NOT NULL DEFAULT now(),
  UNIQUE (cell, book, log_row, link)
);
