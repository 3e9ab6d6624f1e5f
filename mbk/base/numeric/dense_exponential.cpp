#include <unsupported/Eigen/MatrixFunctions>

#include "mbk/base/numeric/dense.h"

namespace mbk::numeric {

Matrix matrix_exponential(const Matrix& A) {
  return A.exp();
}

}  // namespace mbk::numeric
