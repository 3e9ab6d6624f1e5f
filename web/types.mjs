// TypeScript types of the documents, from their JSON Schemas.   usage: node types.mjs FOLDER OUT.ts
// Every schema becomes a type named by its title, every definition one named as it is.
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { isDeepStrictEqual } from "node:util";
import { compile } from "json-schema-to-typescript";

const [folder, out] = process.argv.slice(2);
const definitions = {};
const define = (name, schema) => {
  if (name in definitions && !isDeepStrictEqual(definitions[name], schema)) throw new Error(`two schemas define ${name}`);
  definitions[name] = schema;
};

// What stands beside a reference is for readers only.
const withoutMore = (_, value) => (typeof value?.$ref === "string" ? { $ref: value.$ref } : value);
for (const file of readdirSync(folder).sort()) {
  const { $schema: _, title, definitions, ...document } = JSON.parse(readFileSync(join(folder, file), "utf8"), withoutMore);
  for (const [name, schema] of Object.entries({ ...definitions, [title]: document })) define(name, schema);
}

const types = await compile({ definitions }, "Documents", {
  bannerComment: "// Written by types.mjs from the JSON Schemas of the documents.",
  additionalProperties: false,
  unreachableDefinitions: true,
  format: false,
});
const ofTheCollection = /^export interface Documents \{[^}]*\}\n/m;
const whereItStands = /^ \*( \n \*)? This interface was referenced by .*\n \* via the `definition` .*\n/gm;
writeFileSync(out, types.replace(ofTheCollection, "").replace(whereItStands, "").replace(/^\/\*\*\n \*\/\n/gm, ""));
