#include "mbk/study/workflow/bootstrap_units.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "mbk/base/numeric/parallel.h"
#include "mbk/batch/value_bytes.h"

namespace mbk::workflow {
namespace {

using Json = nlohmann::json;

Json rows_json(const Matrix& matrix) {
  Json rows = Json::array();
  for (Index i = 0; i < matrix.rows(); ++i) {
    Json row = Json::array();
    for (Index j = 0; j < matrix.cols(); ++j) row.push_back(matrix(i, j));
    rows.push_back(std::move(row));
  }
  return rows;
}

Matrix matrix_from(const Json& rows) {
  Matrix matrix(static_cast<Index>(rows.size()), rows.empty() ? 0 : static_cast<Index>(rows.front().size()));
  for (Index i = 0; i < matrix.rows(); ++i) {
    const Json& row = rows.at(static_cast<std::size_t>(i));
    for (Index j = 0; j < matrix.cols(); ++j) matrix(i, j) = row.at(static_cast<std::size_t>(j)).get<double>();
  }
  return matrix;
}

Json specification_of(const Bootstrap& bootstrap) {
  Json tables = Json::array();
  for (const statistics::PeopleTable& table : bootstrap.tables) {
    Json one = {{"first", rows_json(table.first)}, {"second", rows_json(table.second)}};
    if (table.pairing) one["pairing"] = word_of(*table.pairing);
    tables.push_back(std::move(one));
  }
  return {{"seed", bootstrap.seed}, {"draws", bootstrap.draws}, {"tables", std::move(tables)}};
}

batch::UnitFunction units_of(std::vector<statistics::PeopleTable> tables, std::uint64_t seed) {
  return [tables = std::move(tables), seed](std::int64_t number, const std::string& /*key*/) -> Result<std::string> {
    return batch::to_bytes(statistics::bootstrap_draw(tables, seed, static_cast<int>(number)));
  };
}

}  // namespace

Result<Draws> draws_here(const Bootstrap& bootstrap, const std::function<void(int, int)>& progress) {
  Draws draws(static_cast<std::size_t>(bootstrap.draws));
  int done = 0;
  MBK_TRY(numeric::parallel_for(
      bootstrap.draws, 0,
      [&](int k) -> Result<void> {
        draws[static_cast<std::size_t>(k)] = statistics::bootstrap_draw(bootstrap.tables, bootstrap.seed, k);
        return {};
      },
      [&](int /*k*/) { progress(++done, bootstrap.draws); }));
  return draws;
}

batch::JobRequest draws_request(const Bootstrap& bootstrap, const std::filesystem::path& study) {
  batch::JobRequest request;
  request.kind = kBootstrapKind;
  request.specification = specification_of(bootstrap).dump();
  request.title = fmt::format("mbk study summary --bootstrap {} --seed {}", bootstrap.draws, bootstrap.seed);
  for (int k = 0; k < bootstrap.draws; ++k) request.keys.push_back(std::to_string(k));
  request.weights.assign(request.keys.size(), 1.0);
  request.compute = units_of(bootstrap.tables, bootstrap.seed);
  request.folder = study / "jobs" / batch::job_name(request.kind, request.specification);
  return request;
}

Result<Draws> draws_of(const batch::JobFolder& job) {
  const auto results = MBK_TRY(batch::results_of(job));
  Draws draws(results.size());
  for (std::size_t k = 0; k < draws.size(); ++k) {
    if (!batch::from_bytes(results[k], draws[k])) {
      return bad_data("a draw in a shard cannot be read", "start the job again");
    }
  }
  return draws;
}

Result<batch::UnitFunction> bootstrap_units(const Json& specification) {
  std::vector<statistics::PeopleTable> tables;
  for (const Json& one : specification.at("tables")) {
    statistics::PeopleTable table{std::nullopt, matrix_from(one.at("first")), matrix_from(one.at("second"))};
    if (one.contains("pairing")) {
      table.pairing = value_of<reliability::Pairing>(one.at("pairing").get<std::string>());
      if (!table.pairing) return bad_data("the job's specification cannot be read", "start the job again");
    }
    tables.push_back(std::move(table));
  }
  return units_of(std::move(tables), specification.at("seed").get<std::uint64_t>());
}

}  // namespace mbk::workflow
