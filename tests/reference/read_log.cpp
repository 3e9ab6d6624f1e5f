#include "tests/reference/read_log.h"

#include <fmt/format.h>
#include <matio.h>

#include <cstddef>
#include <memory>

namespace mbk::reference {

Result<Log> read_log(const std::string& path) {
  const std::unique_ptr<mat_t, decltype(&Mat_Close)> file(Mat_Open(path.c_str(), MAT_ACC_RDONLY), &Mat_Close);
  if (!file) return bad_data("cannot be read as a MAT file", "", path);
  const std::unique_ptr<matvar_t, decltype(&Mat_VarFree)> logs(Mat_VarRead(file.get(), "logs"), &Mat_VarFree);
  if (!logs) return bad_data("has no variable 'logs'", "", path);
  if (logs->rank != 2 || logs->dims[0] != 19 || logs->data_type != MAT_T_DOUBLE || logs->isComplex || !logs->data) {
    return bad_data("'logs' is not a real double matrix of 19 rows", "", path);
  }
  const auto* values = static_cast<const double*>(logs->data);
  const auto row = [&](std::size_t number) {
    std::vector<double> samples;
    for (std::size_t i = 0; i < logs->dims[1]; ++i) samples.push_back(values[19 * i + number - 1]);
    return samples;
  };
  return Log{row(2), row(3), row(10), row(11), row(12), row(13), row(18), row(19)};
}

}  // namespace mbk::reference
