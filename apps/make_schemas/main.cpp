// Writes the JSON Schema of every document.   usage: make_schemas FOLDER
#include <filesystem>
#include <fstream>
#include <iostream>

#include "mbk/present/result/schemas.h"

int main(int count, char** words) {
  if (count != 2) {
    std::cerr << "usage: make_schemas FOLDER\n";
    return 2;
  }
  const std::filesystem::path folder = words[1];
  mbk::document::Schemas schemas;
  mbk::result::add_schemas(schemas);
  std::filesystem::create_directories(folder);
  for (const auto& [name, schema] : schemas) {
    std::ofstream file(folder / (name + ".schema.json"));
    file << schema.dump(2) << '\n';
    if (!file) {
      std::cerr << "make_schemas: cannot write " << name << " into " << folder << '\n';
      return 3;
    }
  }
  return 0;
}
