// SPDX-License-Identifier: MIT
// lint_documents.mjs WEB DOCUMENT...: each OpenAPI document by @redocly/openapi-core, with nothing but errors.  Of Redocly's
// packages it is the linter alone: openapi-typescript needs it anyway, and their command line would bring 244 packages, 205 MB.
// Then each fault of `spoiled` is put into the first document, and must be found there.
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { resolve } from 'node:path';

const [web, ...documents] = process.argv.slice(2);
const from_page = createRequire(resolve(web, 'package.json'));
let linter;
try {
  linter = from_page('@redocly/openapi-core');
} catch {
  console.log('skipped: no packages; run npm ci in host/web');
  process.exit(77);
}
const { createConfig, lintFromString } = linter;

const config = await createConfig({
  extends: ['recommended-strict'],
  rules: {
    'no-invalid-parameter-examples': 'error',
    'no-invalid-schema-examples': 'error',
    'no-required-schema-properties-undefined': 'error',
    'no-schema-type-mismatch': 'error',
    'operation-description': 'off',
    'operation-parameters-unique': 'error',
    'operation-tag-defined': 'error',
    'path-params-defined': 'error',
  },
});

async function faults_of(source, name) {
  const problems = await lintFromString({ source, absoluteRef: name, config });
  return problems.map(({ ruleId, message, location }) => `${name}: ${location[0].pointer ?? location[0].start?.line}: ${ruleId}: ${message}`);
}

/// What stands there, what it becomes, and the rule that sees it.
const spoiled = [
  ['description: What the cell does now}', 'description: What the cell does now, and next}', 'struct'],
  ['operationId: read_me\n', 'operationId: read_state\n', 'operation-operationId-unique'],
  ["'#/components/schemas/Me'", "'#/components/schemas/You'", 'no-unresolved-refs'],
  ['required: [name, role]\n', 'required: [nome, role]\n', 'no-required-schema-properties-undefined'],
  ['\n  schemas:\n', '\n  schemas:\n    Unused: {type: string}\n', 'no-unused-components'],
  ['- {name: people,', '- {name: persons,', 'operation-tag-defined'],
];

let bad = 0;
for (const document of documents) {
  for (const fault of await faults_of(readFileSync(document, 'utf8'), document)) {
    console.log(fault);
    ++bad;
  }
}
const text = readFileSync(documents[0], 'utf8');
for (const [whole, spoilt, rule] of spoiled) {
  const there = text.split(whole).length > 1;
  const found = there && (await faults_of(text.replace(whole, spoilt), documents[0])).some((fault) => fault.includes(`: ${rule}:`));
  if (!found) {
    console.log(there ? `${rule} does not see '${spoilt.trim()}'` : `no '${whole.trim()}' in ${documents[0]}: mend the list in lint_documents.mjs`);
    ++bad;
  }
}
console.log(`${documents.length} documents, ${spoiled.length} faults put in, ${bad} complaints`);
process.exit(bad > 0 ? 1 : 0);
