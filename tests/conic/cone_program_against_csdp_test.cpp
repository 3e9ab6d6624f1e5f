// solve_cone_program against CSDP (Borchers 1999), which is given the same program as
//   minimise t  over [I, R x; (R x)ᵀ, t − qᵀx] ⪰ 0  and every cone,   P/2 = RᵀR.
#include <csdp/declarations.h>
#include <gtest/gtest.h>
#include <omp.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <new>
#include <span>
#include <string>

#include "mbk/base/numeric/cone_program.h"
#include "mbk/base/numeric/test_cones.h"

namespace mbk::numeric {
namespace {

/// CSDP frees what it is given with free().
template <class Type>
Type* allocated(std::size_t count) {
  auto* memory = static_cast<Type*>(std::calloc(count, sizeof(Type)));
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

/// A linear matrix inequality parts[0] + Σ y_i parts[i] ⪰ 0.
using Inequality = std::vector<Matrix>;

/// minimise the last variable: CSDP's dual problem, min aᵀy over Σ y_i A_i − C ⪰ 0.
struct Csdp {
  int order = 0, variables = 0;
  blockmatrix C{}, X{}, Z{};
  double* a = nullptr;
  double* y = nullptr;
  constraintmatrix* constraints = nullptr;
  double primal = 0, dual = 0;
  int outcome = -1;

  Csdp(const std::vector<Inequality>& inequalities, int number_of_variables) : variables(number_of_variables) {
    const std::size_t blocks = inequalities.size();
    C.nblocks = static_cast<int>(blocks);
    C.blocks = allocated<blockrec>(blocks + 1);
    a = allocated<double>(static_cast<std::size_t>(variables) + 1);
    a[variables] = 1.0;
    constraints = allocated<constraintmatrix>(static_cast<std::size_t>(variables) + 1);
    for (std::size_t k = 0; k < blocks; ++k) {
      const Matrix& constant = inequalities[k][0];
      order += static_cast<int>(constant.rows());
      blockrec& block = C.blocks[k + 1];
      block.blockcategory = MATRIX;
      block.blocksize = static_cast<int>(constant.rows());
      block.data.mat = allocated<double>(static_cast<std::size_t>(constant.size()));
      Matrix::Map(block.data.mat, constant.rows(), constant.cols()) = -constant;
    }
    for (int i = variables; i >= 1; --i) {
      for (std::size_t k = blocks; k-- > 0;)
        add(i, static_cast<int>(k) + 1, inequalities[k][static_cast<std::size_t>(i)]);
    }
    initsoln(order, variables, C, a, constraints, &X, &y, &Z);
    outcome = easy_sdp(order, variables, C, a, constraints, 0.0, &X, &y, &Z, &primal, &dual);
  }
  Csdp(const Csdp&) = delete;
  Csdp& operator=(const Csdp&) = delete;
  ~Csdp() { free_prob(order, variables, C, a, constraints, X, y, Z); }

 private:
  void add(int variable, int block, const Matrix& part) {
    const auto n = static_cast<int>(part.rows());
    const auto room = static_cast<std::size_t>(n * (n + 1) / 2 + 1);
    auto* sparse = allocated<sparseblock>(1);
    sparse->entries = allocated<double>(room);
    sparse->iindices = allocated<int>(room);
    sparse->jindices = allocated<int>(room);
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i <= j; ++i) {
        if (part(i, j) == 0.0) continue;
        const int entry = ++sparse->numentries;
        sparse->entries[entry] = part(i, j);
        sparse->iindices[entry] = i + 1;
        sparse->jindices[entry] = j + 1;
      }
    }
    sparse->blocknum = block;
    sparse->blocksize = n;
    sparse->constraintnum = variable;
    sparse->next = constraints[variable].blocks;
    constraints[variable].blocks = sparse;
  }
};

std::vector<Inequality> inequalities_of(const ConeProgram& program) {
  const Index v = program.q.size();
  std::vector<Inequality> all;
  for (const SemidefiniteCone& cone : program.cones) {
    Inequality inequality = {testing_support::symmetric_matrix(cone, Vector::Zero(v))};
    for (Index i = 0; i < v; ++i) {
      inequality.push_back(testing_support::symmetric_matrix({cone.A, 0.0 * cone.b}, Vector::Unit(v, i)));
    }
    inequality.push_back(0.0 * inequality.front());
    all.push_back(inequality);
  }
  const Matrix R = Eigen::LLT<Matrix>(0.5 * program.P).matrixU();
  Matrix constant = Matrix::Identity(v + 1, v + 1);
  constant(v, v) = 0.0;
  Inequality epigraph = {constant};
  for (Index i = 0; i < v; ++i) {
    Matrix part = Matrix::Zero(v + 1, v + 1);
    part.topRightCorner(v, 1) = R.col(i);
    part.bottomLeftCorner(1, v) = R.col(i).transpose();
    part(v, v) = -program.q[i];
    epigraph.push_back(part);
  }
  Matrix part = Matrix::Zero(v + 1, v + 1);
  part(v, v) = 1.0;
  epigraph.push_back(part);
  all.push_back(epigraph);
  return all;
}

/// CSDP reads its tolerances from a file of a fixed name in the folder in which it runs.
struct InAFolderWithTightTolerances {
  std::filesystem::path before = std::filesystem::current_path(), folder;
  InAFolderWithTightTolerances() {
    std::string name = (std::filesystem::temp_directory_path() / "mbk_csdp_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::bad_alloc();
    folder = name;
    std::ofstream(folder / "param.csdp")
        << "axtol=1.0e-10\natytol=1.0e-10\nobjtol=1.0e-11\npinftol=1.0e8\ndinftol=1.0e8\nmaxiter=200\n"
           "minstepfrac=0.90\nmaxstepfrac=0.97\nminstepp=1.0e-10\nminstepd=1.0e-10\nusexzgap=1\ntweakgap=0\n"
           "affine=0\nprintlevel=0\nperturbobj=0\nfastmode=0\n";
    std::filesystem::current_path(folder);
  }
  ~InAFolderWithTightTolerances() {
    std::error_code ignored;
    std::filesystem::current_path(before, ignored);
    std::filesystem::remove_all(folder, ignored);
  }
};

TEST(ConeProgram, HasTheMinimumThatCsdpFinds) {
  omp_set_num_threads(1);
  const InAFolderWithTightTolerances here;
  constexpr double kValue = 1e-8;     // CSDP's relative gap is asked to be 1e-11; it gives up at about 1e-9
  constexpr double kArgument = 1e-4;  // and √1e-8 is what a value to 1e-8 says of the argument
  Random random(1);
  int solved = 0;
  constexpr int kPrograms = 200;
  for (int trial = 0; trial < kPrograms; ++trial) {
    const ConeProgram program = testing_support::random_cone_program(random, 8, {2, 2, 3, 1});
    const auto found = solve_cone_program(program);
    ASSERT_TRUE(found) << trial;
    const Csdp other(inequalities_of(program), 9);
    constexpr int kSolved = 0, kSolvedToLessThanAsked = 3;
    if (other.outcome != kSolved && other.outcome != kSolvedToLessThanAsked) continue;
    ++solved;
    const double size = 1.0 + std::abs(found->value);
    EXPECT_NEAR(found->value, other.dual, kValue * size) << trial;
    const std::span<const double> y(other.y + 1, 8);
    for (Index i = 0; i < 8; ++i) EXPECT_NEAR(found->x[i], y[static_cast<std::size_t>(i)], kArgument * size) << trial;
  }
  EXPECT_EQ(solved, kPrograms);
}

}  // namespace
}  // namespace mbk::numeric
