#include <Eigen/SVD>

#include "mbk/base/numeric/dense.h"

namespace mbk::numeric {

Vector singular_values(const Matrix& A) {
  return Eigen::JacobiSVD<Matrix>(A).singularValues();
}

}  // namespace mbk::numeric
