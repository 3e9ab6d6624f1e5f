// TypeScript types of the documents, from their JSON Schemas.   usage: node types.mjs FOLDER OUT.ts
// Every schema becomes a type named by its title, every definition one named as it is.
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { basename, join } from "node:path";
import { isDeepStrictEqual } from "node:util";
import { compile } from "json-schema-to-typescript";

const [folder, out] = process.argv.slice(2);
const definitions = {};
const define = (name, schema) => {
  if (name in definitions && !isDeepStrictEqual(definitions[name], schema)) throw new Error(`two schemas define ${name}`);
  definitions[name] = schema;
};

const documents = new Map(readdirSync(folder).filter((file) => file.endsWith(".schema.json")).sort()
  .map((file) => [file, JSON.parse(readFileSync(join(folder, file), "utf8"))]));
const typeName = (title) => title.replace(/(?:^| )(\w)/g, (_, first) => first.toUpperCase());

/** The schema with each reference into this one collection. What stands beside a reference is for readers only. */
function gathered(schema, file) {
  if (Array.isArray(schema)) return schema.map((one) => gathered(one, file));
  if (schema === null || typeof schema !== "object") return schema;
  if (typeof schema.$ref !== "string") return Object.fromEntries(Object.entries(schema).map(([key, value]) => [key, gathered(value, file)]));
  const [other, pointer = ""] = schema.$ref.split("#");
  const name = pointer.replace("/definitions/", "") || typeName(documents.get(basename(other || file)).title);
  return { $ref: `#/definitions/${name}` };
}

for (const [file, { $schema: _, title, definitions: own = {}, ...document }] of documents) {
  for (const [name, schema] of Object.entries(own)) define(name, gathered(schema, file));
  if (title) define(typeName(title), gathered(document, file));
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
