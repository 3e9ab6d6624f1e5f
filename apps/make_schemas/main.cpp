// Writes the JSON Schema of every document.   usage: make_schemas FOLDER
#include <filesystem>
#include <fstream>
#include <iostream>

#include "apps/mbk/commands/commands_json.h"
#include "mbk/batch/job_status.h"
#include "mbk/experiment/console/messages.h"
#include "mbk/experiment/session/robot_check_report.h"
#include "mbk/present/result/schemas.h"
#include "mbk/study/longitudinal/report_schemas.h"
#include "mbk/study/statistics/summary_document.h"
#include "mbk/study/store/study_documents.h"
#include "mbk/validate/robot_event.h"

int main(int count, char** words) {
  if (count != 2) {
    std::cerr << "usage: make_schemas FOLDER\n";
    return 2;
  }
  const std::filesystem::path folder = words[1];
  mbk::document::Schemas schemas;
  mbk::result::add_schemas(schemas);
  mbk::store::add_schemas(schemas);
  mbk::statistics::add_schemas(schemas);
  mbk::longitudinal::add_schemas(schemas);
  mbk::batch::add_schemas(schemas);
  mbk::console::add_schemas(schemas);
  mbk::app::add_commands_schema(schemas);
  mbk::validation::add_robot_event_schema(schemas);
  mbk::session::add_robot_check_schema(schemas);
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
