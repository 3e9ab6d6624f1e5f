#include "mbk/base/core/matrix_products.h"

#ifdef MBK_MATRIX_PRODUCTS
namespace Eigen::internal {
MBK_MATRIX_PRODUCTS(template)
}  // namespace Eigen::internal
#endif
