#include "fuzz/fuzz.h"
#include "mbk/present/result/json.h"

namespace mbk::fuzz {
namespace {

Measurement measured(int axes) {
  Identification id;
  id.axes = axes;
  const Matrix one = Matrix::Identity(axes, axes);
  id.model = {2.0 * one, 8.0 * one, 150.0 * one, Vector::Constant(axes, 0.1)};
  id.standard_error = {0.1 * one, 0.2 * one, 3.0 * one, Vector::Constant(axes, 0.01)};
  const Index parameters = 3 * axes * axes + axes;
  id.covariance = Matrix::Identity(parameters, parameters);
  id.fit = {Vector::Constant(axes, 98.0), Vector::Constant(axes, 0.5), Vector::Constant(axes, 99.0), true};
  id.parameters.assign(static_cast<std::size_t>(parameters), "p");
  id.parameters_from = ParametersFrom::identification;
  id.preparations.emplace_back();
  id.sources = {{"log.mat", "MAT v7", "abc"}};
  id.durations = {62.0};
  id.rates = {1000.0};
  id.notes = {"a note"};
  id.usable = true;
  id.warnings.push_back({WarningCode::fit_poor, "a message", "a remedy"});
  return {id, std::nullopt};
}

}  // namespace

std::vector<std::string> seeds() {
  return {result::to_json(measured(1)), result::to_json(measured(2)),
          result::to_json(std::vector{measured(1), measured(2)}, SeveralTrials{}),
          R"({"schema": "mbk.result/1", "axes": 1, "model": {"M": [[1]], "B": [[2]], "K": [[3]], "x0": [0]}})",
          R"({"schema": "mbk.result/2", "model": {"M": [[1]], "B": [[2]], "K": [[3]]}, "alternatives": [{"method": "iv",
          "model": {"M": [[1]], "B": [[2]], "K": [[3]]}, "warnings": []}], "passivity": {"prediction": {}, "band_hz":
          [0.1, 3], "models": [{"method": "iv"}], "trial": {"lines": [{"frequency_hz": 1, "duration_s": 9, "absorbed_J": 1, "interval95":
          [0, 2]}]}, "energy": {"absorbed_J": 1, "interval95": [0.5, 2], "mean_power_interval95": [0, 1], "shortage":
          {"at_end_interval95": [0, 1], "largest_interval95": [null, 1]}, "blocks": 8}}})"};
}

}  // namespace mbk::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace mbk;
  const auto read = result::identifications_from_json(fuzz::text_of(data, size));
  if (!read) {
    fuzz::require_error(read.error());
    return 0;
  }
  fuzz::require(!read->empty(), "a file contains a result");
  const auto stored = result::results_from_json(fuzz::text_of(data, size));  // may state that there is no passivity
  if (!stored) fuzz::require_error(stored.error());
  if (stored) fuzz::require(stored->size() == read->size(), "both readers find the same results");
  for (const Identification& one : *read) {
    fuzz::require(one.axes == 1 || one.axes == 2, "a result has one or two axes");
    fuzz::require(one.model.M.rows() == one.axes && one.model.K.cols() == one.axes, "matrices fit the axes");
    const auto again = result::identifications_from_json(result::to_json(Measurement{one, std::nullopt}));
    fuzz::require(again.has_value(),
                  again ? "" : "what was read can be written and read again: " + again.error().line());
  }
  return 0;
}
