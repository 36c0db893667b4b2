// SPDX-License-Identifier: MIT
// viewer.js in a result folder: shows view_data.js and files.js, which were loaded before it.
import { render } from 'preact';
import colours from '../colours.css';
import style from './viewer.css';
import type { ResultFile, ViewData } from './view_data';
import { Viewer } from './viewer';

declare global {
  interface Window {
    biteline_view?: ViewData;
    biteline_files?: ResultFile[];
  }
}

const place = document.getElementById('viewer');
if (place && window.biteline_view) {
  // The page around it is in English, and so are its words.
  const sheet = document.createElement('style');
  sheet.textContent = colours + style;
  document.head.append(sheet);
  place.textContent = '';
  // The page lists what stood there when it was written; the viewer also what came later.
  const shown = new Set([...document.querySelectorAll('a')].map((link) => link.getAttribute('href')));
  const files = (window.biteline_files ?? []).filter((file) => !shown.has(file.file));
  render(<Viewer data={window.biteline_view} files={files} told />, place);
}
