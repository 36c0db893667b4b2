-- SPDX-License-Identifier: MIT
-- A row that cannot be read whole stands among the shoes without what was wrong, so that those behind it follow;
-- why, stands here.
CREATE TABLE dead_letters (
  id bigint GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
  cell text NOT NULL,
  book text NOT NULL,
  seq bigint NOT NULL,
  scan text NOT NULL,
  why text NOT NULL,
  time timestamptz NOT NULL DEFAULT now(),
  UNIQUE (cell, book, seq)
);
ALTER TABLE shoes ADD COLUMN stub boolean NOT NULL DEFAULT false;
-- A cell begins few memories a day; those of before this count for none.
ALTER TABLE books ADD COLUMN begun timestamptz NOT NULL DEFAULT '-infinity';
ALTER TABLE books ALTER COLUMN begun SET DEFAULT now();
